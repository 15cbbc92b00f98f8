#!/usr/bin/env python3
"""attack.py: what files, peers, pages and kills do to snug, as often as is asked for.

  attack.py readers N    N mutated inputs in all to the readers of tests/fuzz, which are built (make fuzz looks for new code instead)
  attack.py servers N    N connections to each server: CLICK, a UR with its five ports, view and ui; requests of browsers, handshakes of TLS and
                         STUN with commands behind, noise, and mutated words of the protocols
  attack.py kills N      N kills over all verbs that write: each file is the old one, or a whole new one, or one up to the kill
  attack.py losses N     N kills of a simulation: what the recording misses is at most 1 s old
  attack.py studies N    N kills of a study, which then goes on to the table that it has without them
  attack.py all N        N to each, kills and studies a tenth of it, losses a hundredth

Each prints what it counted; exit code 1: something was found, which the last lines name."""
import argparse
import collections
import os
import random
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CELL = ROOT / "scenarios" / "init" / "cell.yaml"
DEMONSTRATOR = ROOT / "scenarios" / "box-demonstrator.yaml"
DROP = ROOT / "scenarios" / "drop.yaml"
EXAMPLES = ROOT / "scenarios" / "examples"
LOST_AT_MOST = 1.0  # s of a recording, by a kill


class Found(Exception):
    """What was not as it has to be."""


# ---- readers

COSTLY = {"recording": 0.1, "measured": 0.3, "imports": 0.5, "shapes": 0.3, "http": 0.001}  # fraction of the others' number


def attack_readers(words):
    folder = words.build / "tests" / "fuzz"
    readers = sorted(path.name for path in (ROOT / "tests" / "fuzz" / "seeds").iterdir())
    total = sum(COSTLY.get(reader, 1.0) for reader in readers)
    done = 0
    for reader in readers:
        count = max(1, round(words.count * COSTLY.get(reader, 1.0) / total))
        run = subprocess.run([folder / f"fuzz_{reader}", ROOT / "tests" / "fuzz" / "seeds" / reader, str(count)], capture_output=True, text=True, check=False)
        if run.returncode != 0:
            raise Found(f"{reader}: exit code {run.returncode}, the input is in the file 'finding': {run.stderr[-500:]}")
        print(f"{reader}: {count} mutated inputs", flush=True)
        done += count
    print(f"{done} mutated inputs to {len(readers)} readers, nothing found")


# ---- servers

def served(field, payload):
    return bytes([field << 3 | 2, len(payload)]) + payload


STEP = bytes([8, 2]) + served(2, served(1, b"ur10") + served(2, served(5, struct.pack("<6d", 0.2, 0, 0, 0, 0, 0))))  # a Control of CLICK
GREETING = b"\xff\0\0\0\0\0\0\0\1\x7f\3\0NULL" + b"\0" * 48  # of ZMTP 3.0
READY = b"\4\x26\5READY\x0bSocket-Type\0\0\0\6DEALER\x08Identity\0\0\0\0"
LINES = b"power off\nbrake release\nshutdown\nstop program\nunlock protective stop\nset robotmode run\n" \
        b"def p():\n  set_standard_digital_out(0, True)\n  movej([0, -1, 1, 0, 0, 0])\nend\n"
FRAMES = b"\0\5V\0\2\0\x2bIstandard_digital_output_mask,speed_slider_mask\0\3S\0\6U\1\1\1"


def strangers(draw):
    """What pages in a browser can make it send to a port: none of these may move anything."""
    method = draw.choice(["GET", "POST", "OPTIONS", "PUT", "HEAD"])
    orders = draw.choice([LINES, FRAMES, bytes([len(STEP) + 1, 0]) + STEP, b"\0" * draw.randrange(9) + LINES])
    request = f"{method} /{'x' * draw.randrange(300)} HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: http://page.example\r\nContent-Length: {len(orders)}\r\n\r\n"
    hello = b"\x16\x03\x01\x02\0\1\0\1\xfc\x03\x03" + draw.randbytes(32) + b" " + b"\n" + orders
    stun = b"\0\3\0\x40\x21\x12\xa4\x42" + draw.randbytes(12) + b"\0\6\0\x20\n" + orders
    return draw.choice([request.encode() + orders, hello, stun])


def mutated(text, draw):
    data = bytearray(text)
    for _ in range(draw.randrange(1, 5)):
        at = draw.randrange(len(data) + 1)
        how = draw.randrange(5)
        if how == 0 and at < len(data):
            data[at] ^= 1 << draw.randrange(8)
        elif how == 1:
            data[at:at] = draw.randbytes(draw.randrange(9))
        elif how == 2:
            del data[at:at + draw.randrange(9)]
        elif how == 3:
            data[at:at] = data[:draw.randrange(len(data) + 1)][:64]
        else:
            del data[max(1, at):]
    return bytes(data)


def say(port, data, number):
    """One connection; from addresses in turn, so that no pair of ports has to be used again within a minute."""
    with socket.socket() as peer:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        peer.bind((f"127.0.{1 + number // 20000 % 250}.1", 0))
        peer.settimeout(5)
        peer.connect(("127.0.0.1", port))
        try:
            peer.sendall(data)
            peer.shutdown(socket.SHUT_WR)
            peer.settimeout(0.05)
            while peer.recv(65536):
                pass
        except OSError:
            pass


class Server:
    """A verb that serves, until it is left: then it has to end cleanly."""

    def __init__(self, program, words, until, folder):
        self.said = open(folder / "said.txt", "w+", encoding="utf-8", errors="replace")  # noqa: SIM115
        self.process = subprocess.Popen([program, *map(str, words)], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=self.said)
        self.match = None
        end = time.monotonic() + 60
        while not self.match and time.monotonic() < end and self.process.poll() is None:
            time.sleep(0.05)
            self.match = re.search(until, self.text())
        if not self.match:
            self.process.kill()
            raise Found(f"{' '.join(map(str, words))} did not begin: {self.text()[-300:]}")

    def text(self):
        self.said.seek(0)
        return self.said.read()

    def memory(self):
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", status)[1]) / 1024  # MB

    def end(self, how=signal.SIGINT):
        if self.process.poll() is not None:
            raise Found(f"the server ended with {self.process.returncode}: {self.text()[-500:]}")
        self.process.send_signal(how)
        code = self.process.wait(60)
        if code != 0:
            raise Found(f"exit code {code} after {how.name}: {self.text()[-500:]}")
        if re.search(r"[\x00-\x08\x0b-\x1f\x7f]", self.text()):
            raise Found(f"control characters of a peer were printed: {ascii(self.text()[-300:])}")
        return self.text()


def ask_dashboard(port, line):
    with socket.create_connection(("127.0.0.1", port), timeout=20) as peer, peer.makefile("rw", newline="\n") as file:
        file.readline()
        file.write(line + "\n")
        file.flush()
        return file.readline().strip()


def joints(port):
    """The targets of the six joints, from a packet of the real-time port."""
    with socket.create_connection(("127.0.0.1", port), timeout=20) as peer, peer.makefile("rb") as file:
        return struct.unpack(">6d", file.read(1140)[12:60])


def attack_port(name, server, port, count, seeds, draw, numbers):
    """Half of it what pages can send; the rest words of the protocol with mistakes. `seeds` empty: strangers alone."""
    before = None
    for i in range(count):
        if i == min(1000, count // 4):
            before = server.memory()
        kind = draw.random()
        data = strangers(draw) if kind < 0.5 or not seeds else mutated(draw.choice(seeds), draw) if kind < 0.9 else draw.randbytes(draw.randrange(1, 2000))
        try:
            say(port, data, next(numbers))
        except ConnectionRefusedError:
            server.process.wait(60)
        if server.process.poll() is not None:
            raise Found(f"{name}: the server ended with {server.process.returncode} after {data!r}")
    if server.memory() > before + 100:
        raise Found(f"{name}: from {before:.0f} to {server.memory():.0f} MB")
    print(f"{name}: {count} connections, {server.memory() - before:+.1f} MB", flush=True)


def attack_click(words, folder, draw, numbers):
    server = Server(words.snug, ("serve", DEMONSTRATOR, "--click", "tcp://127.0.0.1:*"), r"serving .*127\.0\.0\.1:(\d+)", folder)
    seeds = [GREETING, GREETING + READY, GREETING + READY + b"\0" + bytes([len(STEP)]) + STEP, bytes([len(STEP) + 1, 0]) + STEP]
    attack_port("CLICK", server, int(server.match[1]), words.count, seeds, draw, numbers)
    said = server.end()
    if "snug: 0 steps" not in said:
        raise Found(f"CLICK: strangers moved the cell: {said[-300:]}")


def attack_ur(words, folder, draw, numbers):
    offset = 2000 + os.getpid() % 200 * 100
    server = Server(words.snug, ("serve", DEMONSTRATOR, "--sequence", "1", "--ur", "127.0.0.1", "--ur-port-offset", offset), "serving", folder)
    at = joints(30003 + offset)
    for name, port in (("UR dashboard", 29999), ("UR primary", 30001), ("UR secondary", 30002), ("UR real time", 30003), ("UR RTDE", 30004)):
        attack_port(name, server, port + offset, -(-words.count // 8), [], draw, numbers)
    if (mode := ask_dashboard(29999 + offset, "robotmode")) != "Robotmode: RUNNING" or joints(30003 + offset) != at:
        raise Found(f"UR: strangers moved the robot or switched it ({mode})")
    server.end(signal.SIGTERM)
    # The same ports by the protocol's own words with mistakes: these may move it, and may not end or grow it.
    server = Server(words.snug, ("serve", DEMONSTRATOR, "--sequence", "1", "--ur", "127.0.0.1", "--ur-port-offset", offset), "serving", folder)
    lines = [line + b"\n" for line in LINES.split(b"\n")[1:4] if line != b"shutdown"]
    scripts = [path.read_bytes() + b"\n" for path in (ROOT / "tests" / "fuzz" / "seeds" / "urscript").iterdir()]
    frames = [path.read_bytes()[1:] for path in (ROOT / "tests" / "fuzz" / "seeds" / "peers").glob("rtde*")]
    for name, port, seeds in (("UR dashboard, its words", 29999, lines), ("UR primary, scripts", 30001, scripts), ("UR RTDE, frames", 30004, frames)):
        attack_port(name, server, port + offset, -(-words.count // 8), seeds, draw, numbers)
    ask_dashboard(29999 + offset, "robotmode")
    server.end(signal.SIGHUP)


def attack_pages(words, folder, draw, numbers):
    subprocess.run([words.snug, "simulate", DROP, "--until", "0.05", "-o", "run.h5"], cwd=folder, check=True, capture_output=True)
    seeds = [f"{head} HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Snug: 1\r\nContent-Length: 2\r\nContent-Type: application/json\r\n\r\n{{}}".encode()
             for head in ("GET /", "GET /recordings.json", "GET /../../etc/passwd", "PUT /api/1/files/a.yaml", "POST /api/1/runs", "DELETE /api/1/runs/a")]
    for name, verb in (("view", ("view", "run.h5", "--no-open")), ("ui", ("ui", ".", "--no-open"))):
        server = Server(words.snug, verb, r"http://127\.0\.0\.1:(\d+)", folder)
        attack_port(name, server, int(server.match[1]), words.count, seeds, draw, numbers)
        server.end(signal.SIGHUP)


def attack_servers(words):
    draw, numbers = random.Random(words.seed), iter(range(10**9))
    for attack in (attack_click, attack_ur, attack_pages):
        with tempfile.TemporaryDirectory() as folder:
            attack(words, Path(folder), draw, numbers)
    print("0 motions by strangers")


# ---- kills

OLD = b"the old file\n"  # a recording is only written over a recording
# Verb: words; files that it writes, and those among them that grow while it runs and are read by `report`.
SMALL = (DEMONSTRATOR, "--container", "400x300x200", "--sequence", "1")
QUICK = ("--samples", "0", "--agent", "margin", "--decision-time", "0.01")
VERBS = {
    "simulate": (("simulate", DROP, "--until", "4", "-o", "new.h5", "--csv", "new.csv"), ("new.h5", "new.csv")),
    "pack": (("pack", CELL, "--sequence", "first", *QUICK, "-o", "new.h5", "--program", "new.csv", "--plan", "new.json", "--log", "new.jsonl"),
             ("new.h5", "new.csv", "new.json", "new.jsonl")),
    "run": (("run", "program.script", *SMALL, "-o", "new.h5"), ("new.h5",)),
    "program": (("program", DEMONSTRATOR, ROOT / "scenarios" / "demo-placements.yaml", "--sequence", "1", "-o", "new.csv"), ("new.csv",)),
    "report": (("report", "run.h5", "-o", "new.html"), ("new.html",)),
    "plot": (("plot", "run.h5", "--what", "tool", "-o", "new.svg"), ("new.svg",)),
    "export mcap": (("export", "run.h5", "--format", "mcap", "-o", "new.mcap"), ("new.mcap",)),
    "export urscript": (("export", "program.csv", "--scenario", *SMALL, "--format", "urscript", "-o", "new.script"), ("new.script",)),
    "items reduce": (("items", "reduce", ROOT / "scenarios" / "orders-example.csv", "--count", "4", "-o", "new.yaml"), ("new.yaml",)),
    "load": (("load", ROOT / "scenarios" / "orders-example.csv", "--container", "600x400x300", "--time", "0.3", "-o", "new.csv"), ("new.csv",)),
    "camera": (("camera", "box.h5", "-o", "new.png"), ("new.png",)),
    "measure": (("measure", "box.h5", "--sensors", ROOT / "scenarios" / "sensors" / "demonstrator.yaml", "-o", "new.h5", "--truth", "new.json"), ("new.h5", "new.json")),
    "shake": (("shake", ROOT / "scenarios" / "demo-placements.yaml", "--scenario", DEMONSTRATOR, "--profile", "conveyor", "--page", "new.html"), ("new.html",)),
    "calibrate": (("calibrate", "tool", EXAMPLES / "touches.csv", "-o", "new.urdf"), ("new.urdf",)),
    "cup estimate": (("cup", "estimate", "--diameter", "40", "--bellows", "1.5", "--material", "silicone", "--lip", "foam", "--vacuum", "-60kPa", "--mass-max", "5",
                      "-o", "new.yaml"), ("new.yaml",)),
    "items sequence": (("items", "sequence", DEMONSTRATOR, "--fill", "90", "--sequences", "5", "--seed", "7", "-o", "new.yaml"), ("new.yaml",)),
    "archive merge": (("archive", "merge", "first.h5", "second.h5", "-o", "new.h5"), ("new.h5",)),
    "validate": (("validate", "--simulated", "box.h5", "--measured", "first.h5", "-o", "new.html", "--csv", "new.csv"), ("new.html", "new.csv")),
    "perceive": (("perceive", "frame.png", "--scenario", DEMONSTRATOR, "--expect", "plan.json", "-o", "new.json"), ("new.json",)),
    "study merge, CSV": (("study", "merge", "study.yaml", "--dir", "rows", "-o", "new.csv"), ("new.csv",)),
    "study merge, HDF5": (("study", "merge", "study.yaml", "--dir", "rows", "-o", "new.h5"), ("new.h5",)),
    "study report": (("study", "report", "study.yaml", "--dir", "rows", "-o", "new.html"), ("new.html",)),
    "identify stiffness": (("identify", "stiffness", EXAMPLES / "poses.json", "-o", "new.yaml"), ("new.yaml",)),
    "identify poses": (("identify", "poses", EXAMPLES / "cup-poses.csv", "-o", "new.yaml"), ("new.yaml",)),
    "identify scene": (("identify", "scene", ROOT / "scenarios" / "tosses" / "task.yaml", "--recordings", ROOT / "scenarios" / "tosses" / "example.csv", "--local", "1",
                        "-o", "new.yaml", "--scenario", "new.scene.yaml", "--page", "new.html"), ("new.yaml", "new.scene.yaml", "new.html")),
    "export csv": (("export", "run.h5", "--format", "csv", "-o", "new.csv"), ("new.csv",)),
    "archive convert": (("archive", "convert", "log.csv", "--sequence", "1", "-o", "new.h5"), ("new.h5",)),
    "picture": (("picture", "run.h5", "--camera", "top", "--size", "320x200", "-o", "new.png"), ("new.png",)),
    "compare": (("compare", CELL, "--sequences", "first", "--agents", "margin", "--plants", "1", *QUICK[:2], "-o", "new.html"), ("new.html",)),
}
CLOCKED = {"compare"}  # their pages have times of a clock: a whole one is known by its end
GROWING = {("simulate", "new.h5"), ("pack", "new.h5"), ("pack", "new.csv"), ("pack", "new.json"), ("pack", "new.jsonl"), ("run", "new.h5")}


STUDY = """name: drops
verb: simulate
scenario: SCENARIO
options: {--until: 0.05}
factors:
  - {set: gravity, values: [[0, 0, -9.81], [0, 0, -1.62]]}
  - {set: seed, values: [1, 2, 3]}
repeat: REPEAT
chunk: 7
"""


def prepare(words, folder, verbs):
    """What the verbs read: a session, and for those that need it a longer recording with its measurements."""
    def snug(*more):
        done = subprocess.run([words.snug, *map(str, more)], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Found(f"{' '.join(map(str, more))}: {done.stderr}")

    def are_read(*names):
        return any(word in names for verb in verbs for word in VERBS[verb][0])

    snug("pack", *SMALL, *QUICK, "-o", "run.h5", "--program", "program.csv", "--plan", "plan.json")
    snug("export", "program.csv", "--scenario", *SMALL, "--format", "urscript", "-o", "program.script")
    snug("export", "run.h5", "--format", "csv", "-o", "log.csv")
    snug("simulate", DROP, "--until", "0.05", "-o", "old.h5")
    if are_read("study.yaml"):
        (folder / "study.yaml").write_text(STUDY.replace("SCENARIO", str(DROP)).replace("REPEAT", "4"))
        snug("study", "study.yaml", "--dir", "rows")
    if are_read("box.h5", "first.h5", "frame.png"):
        snug("program", DEMONSTRATOR, ROOT / "scenarios" / "demo-placements.yaml", "--sequence", "1", "-o", "box.csv")
        snug("simulate", DEMONSTRATOR, "--sequence", "1", "--program", "box.csv", "--until", "30", "-o", "box.h5")
        sensors = ROOT / "scenarios" / "sensors" / "demonstrator.yaml"
        snug("measure", "box.h5", "--sensors", sensors, "-o", "first.h5")
        snug("measure", "box.h5", "--sensors", sensors, "--date", "20000102T000000Z", "-o", "second.h5")
        snug("camera", "run.h5", "-o", "frame.png")


def check_growing(words, folder, verb, name, whole, is_in_order):
    """It is begun and can be read: a recording by `report`, lines as the beginning of those of the whole run. A session that ends in order
    takes the robot home: then its program goes on otherwise."""
    data = (folder / name).read_bytes()
    if name.endswith(".h5"):
        done = subprocess.run([words.snug, "report", name, "-o", "read.html"], cwd=folder, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise Found(f"{verb}: {name} cannot be read: {done.stderr}")
        return
    lines = data.splitlines(keepends=True)
    if name.endswith(".csv") and lines and lines[0].startswith(b"# incomplete"):
        lines = lines[1:]
    if name.endswith(".json") or not b"".join(lines):
        return
    # A log has times of a clock: its lines are whole, but for the last one.
    if name.endswith(".jsonl") and not all(line.startswith(b"{") and line.endswith(b"}\n") for line in lines[:-1]):
        raise Found(f"{verb}: {name} has a broken line within it")
    if name.endswith(".csv") and not is_in_order and not whole.startswith(b"".join(lines)):
        raise Found(f"{verb}: {name} is no beginning of the whole one")


def kill_once(words, folder, verb, wholes, took, draw):
    """Returns what became of each file, and how old the last change of a growing recording of a simulation was."""
    command, names = VERBS[verb]
    olds = {name: (folder / "old.h5").read_bytes() if name.endswith(".h5") else OLD for name in names if draw.random() < 0.5}
    for path in folder.glob("new.*"):
        path.unlink()
    for name, old in olds.items():
        (folder / name).write_bytes(old)
    process = subprocess.Popen([words.snug, *map(str, command)], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    time.sleep(draw.random() * 1.05 * took)
    sent = draw.choice([signal.SIGKILL] * 3 + [signal.SIGHUP, signal.SIGTERM])
    process.send_signal(sent)
    process.wait(60)
    became = collections.Counter()
    for name in names:
        path = folder / name
        if not path.exists():
            if name in olds:
                raise Found(f"{verb}: the old {name} is gone")
            became["none yet"] += 1
        elif path.read_bytes() == olds.get(name):
            became["old"] += 1
        elif path.read_bytes() == wholes[name] or (verb in CLOCKED and path.read_bytes().rstrip().endswith(b"</html>")):
            became["whole new"] += 1
        elif (verb, name) in GROWING:
            check_growing(words, folder, verb, name, wholes[name], sent != signal.SIGKILL)
            became["new up to the kill"] += 1
        else:
            raise Found(f"{verb}: {name} is neither the old nor the whole new one, {path.stat().st_size} of {len(wholes[name])} bytes")
    return became


def attack_kills(words):
    draw, became = random.Random(words.seed), collections.Counter()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        verbs = list(VERBS)[:words.count]
        prepare(words, folder, verbs)
        for i, verb in enumerate(verbs):
            count = words.count // len(verbs) + (i < words.count % len(verbs))
            if count == 0:
                continue
            command, names = VERBS[verb]
            began = time.monotonic()
            done = subprocess.run([words.snug, *map(str, command)], cwd=folder, capture_output=True, text=True, check=False)
            took = time.monotonic() - began
            if done.returncode not in (0, 1):  # 1: it was done, and the robot could not do all
                raise Found(f"{verb}: {done.stderr}")
            wholes = {name: (folder / name).read_bytes() for name in names}
            here = collections.Counter()
            for _ in range(count):
                here += kill_once(words, folder, verb, wholes, took, draw)
            print(f"{verb}: {count} kills: {', '.join(f'{n} {what}' for what, n in sorted(here.items()))}", flush=True)
            became += here
    print(f"{words.count} kills over {len(verbs)} verbs: {', '.join(f'{n} {what}' for what, n in sorted(became.items()))}")


def attack_losses(words):
    """How long before the kill a simulation that computes without a pause had written its recording last."""
    draw, worst = random.Random(words.seed), 0.0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for _ in range(words.count):
            process = subprocess.Popen([words.snug, "simulate", DROP, "--until", "100000", "-o", "new.h5"], cwd=folder, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            path = folder / "new.h5"
            end = time.monotonic() + 60
            while not path.exists() and time.monotonic() < end:
                time.sleep(0.01)
            time.sleep(1.2 + draw.random())
            if not path.exists():
                process.kill()
                raise Found("no recording within a minute")
            worst = max(worst, time.time() - path.stat().st_mtime)
            process.kill()
            process.wait()
            for path in folder.glob("new.h5*"):
                path.unlink()
    print(f"{words.count} kills of a simulation: the recording was written at most {worst:.2f} s before")
    if worst > LOST_AT_MOST:
        raise Found(f"a killed recording misses {worst:.2f} s")


# ---- studies

def attack_studies(words):
    draw = random.Random(words.seed)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "study.yaml").write_text(STUDY.replace("SCENARIO", str(DROP)).replace("REPEAT", str(max(4, words.count // 3))))

        def snug(*more):
            done = subprocess.run([words.snug, *more], cwd=folder, capture_output=True, text=True, check=False)
            if done.returncode != 0:
                raise Found(f"{' '.join(more)}: {done.stderr}")
            return done.stdout

        snug("study", "study.yaml", "--dir", "whole")
        for _ in range(words.count):
            process = subprocess.Popen([words.snug, "study", "study.yaml", "--dir", "killed", "--threads", "2"], cwd=folder, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL, start_new_session=True)
            time.sleep(0.05 + 0.25 * draw.random())
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        snug("study", "study.yaml", "--dir", "killed")
        tables = []
        for directory in ("whole", "killed"):
            snug("study", "merge", "study.yaml", "--dir", directory, "-o", f"{directory}.csv")
            tables.append((folder / f"{directory}.csv").read_bytes())
        if tables[0] != tables[1]:
            shutil.copytree(folder, "study-that-differs", dirs_exist_ok=True)
            raise Found("the merged tables differ: the folder study-that-differs has both")
    print(f"{words.count} kills of a study, {tables[0].count(10) - 1} rows: the merged tables are equal")


ATTACKS = {"readers": attack_readers, "servers": attack_servers, "kills": attack_kills, "losses": attack_losses, "studies": attack_studies}


PARTS = {"kills": 10, "studies": 10, "losses": 100}  # of `all`


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("attack", choices=[*ATTACKS, "all"])
    parser.add_argument("count", type=int)
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="the build folder (default: build)")
    parser.add_argument("--snug", default=None, help="the program (default: that of the build folder)")
    parser.add_argument("--seed", type=int, default=1)
    words = parser.parse_args()
    words.snug = words.snug or str(words.build / "snug")
    if words.count < 1:
        parser.error("COUNT: expected 1 or more")
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # under nohup all that is started here would ignore it, too
    attacks = ((words.attack, words.count),)
    if words.attack == "all":
        attacks = tuple((name, -(-words.count // PARTS.get(name, 1))) for name in ATTACKS)
    try:
        for name, words.count in attacks:
            ATTACKS[name](words)
    except Found as found:
        print(f"FOUND: {found}")
        sys.exit(1)


if __name__ == "__main__":
    main()
