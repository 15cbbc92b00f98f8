#!/usr/bin/env python3
"""cut_robot.py: what becomes of a served UR whose client is killed, frozen, or cut off from it, at instants drawn while it packs.

  cut_robot.py N            N of each: the robot has to stand within 0.2 s of the last command that reached it, by its own clock, its outputs as they
                            were, and the session has to go on (a frozen client by itself, the others by --resume); in the end no box is lost
  cut_robot.py N --how cut  of one kind: killed, frozen, cut
  cut_robot.py N --within S an instant within S s after the robot began to move (5): the longer, the more boxes between two of them
  cut_robot.py N --fresh    each instant in a session of its own, which does not go on

The client reaches the robot through a relay of this program, which stops to forward in both directions where it is cut: nobody is told. Boxes are
told over a socket of its own (--observe), which is not cut. Beside that time the longest one from the strike is told: it is too long by as much as
this program lags behind the robot. Exit code 1: something was not as it has to be."""
import argparse
import collections
import json
import os
import random
import select
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DEMONSTRATOR = ROOT / "scenarios" / "box-demonstrator.yaml"
PORTS = (29999, 30001, 30004)  # those that `pack` uses
STANDS_WITHIN = 0.2  # s, of the robot's time, from the last command
STILL = 0.005  # rad/s
PROTECTIVE_STOP = 3
HOWS = ("killed", "frozen", "cut")
PATIENCE = "1.5"  # s, of a client without answers


class Found(Exception):
    """What was not as it has to be."""


class Relay:
    """Hands on what comes at ports of its own, until it is cut: then connections stay, and no byte passes."""

    def __init__(self, to):
        self.to = to
        self.passes, self.ends = True, False
        self.pairs = {}
        for self.offset in range(to + 10, to + 2000, 10):
            try:
                self.listeners = {}
                for port in PORTS:
                    self.listeners[self.listen(port + self.offset)] = port
                break
            except OSError:
                for one in self.listeners:
                    one.close()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    @staticmethod
    def listen(port):
        listener = socket.socket()
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            listener.bind(("127.0.0.1", port))
        except OSError:
            listener.close()
            raise
        listener.listen()
        return listener

    def run(self):
        while not self.ends:
            sources = [*self.listeners, *self.pairs] if self.passes else []
            ready = select.select(sources, [], [], 0.02)[0]
            for one in ready if self.passes else []:
                if one in self.listeners:
                    here, _ = one.accept()
                    there = socket.create_connection(("127.0.0.1", self.listeners[one] + self.to))
                    for end in (here, there):
                        end.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    self.pairs[here], self.pairs[there] = there, here
                elif one in self.pairs:
                    self.hand_on(one)
        for one in [*self.listeners, *self.pairs]:
            one.close()

    def hand_on(self, one):
        other = self.pairs[one]
        try:
            data = one.recv(65536)
            if data:
                other.sendall(data)
                return
        except OSError:
            pass
        for end in (one, other):
            self.pairs.pop(end, None)
            end.close()

    def cut(self):
        self.passes = False

    def mend(self):
        """The connections that were cut are gone; new ones pass."""
        time.sleep(0.05)
        for one in list(self.pairs):
            self.pairs.pop(one)
            one.close()
        self.passes = True

    def end(self):
        self.ends = True
        self.thread.join()


class Watch:
    """What RTDE says of the robot each period, to somebody who is not cut off."""
    NAMES = b"timestamp,actual_qd,actual_digital_output_bits,runtime_state,input_int_register_24,safety_mode"

    def __init__(self, offset):
        self.socket = socket.create_connection(("127.0.0.1", 30004 + offset))
        self.samples = collections.deque(maxlen=4000)  # (timestamp, fastest joint, outputs, runtime state, commands, safety mode)
        for kind, payload in ((b"V", b"\0\2"), (b"O", struct.pack(">d", 0.0) + self.NAMES), (b"S", b"")):
            self.socket.sendall(struct.pack(">H", len(payload) + 3) + kind + payload)
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        data = b""
        try:
            while more := self.socket.recv(65536):
                data += more
                while len(data) >= 3 and len(data) >= (size := struct.unpack(">H", data[:2])[0]):
                    if data[2:3] == b"U":
                        stamp, *qd, outputs, state, commands, safety = struct.unpack(">7dQIii", data[4:size])
                        self.samples.append((stamp, max(map(abs, qd)), outputs, state, commands, safety))
                    data = data[size:]
        except OSError:
            pass

    def now(self):
        while not self.samples:
            time.sleep(0.01)
        return self.samples[-1]

    def since(self, stamp):
        return [one for one in list(self.samples) if one[0] > stamp]

    def wait(self, is_so, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if is_so(self.now()):
                return True
            time.sleep(0.005)
        return False

    def close(self):
        self.socket.close()


class Cell:
    """A served UR with a relay before it, and the clients that pack it one after the other."""

    def __init__(self, snug, words, folder, say=print):
        self.snug, self.words, self.folder, self.say = snug, words, folder, say
        self.clients = 0
        self.log = None
        self.client = None
        self.boxes = f"ipc://{folder}/boxes"
        for offset in range(3000 + os.getpid() % 100 * 100, 30000, 100):
            self.served = subprocess.Popen([snug, "serve", *words, "--plant-seed", "1", "--ur", "127.0.0.1", "--ur-port-offset", str(offset), "--observers",
                                            self.boxes, "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            if "serving" in (said := self.served.stderr.readline()):
                break
            self.served.communicate()
        else:
            raise Found(f"no served UR: {said}")
        self.reader = threading.Thread(target=self.served.stderr.read, daemon=True)
        self.reader.start()
        self.relay, self.watch = Relay(offset), Watch(offset)

    def start(self):
        """The session, or the rest of it."""
        resume = ["--resume", self.log] if self.log else []
        self.log = self.folder / f"session-{self.clients}.jsonl"
        self.said = open(self.folder / f"client-{self.clients}", "w+", encoding="utf-8")  # noqa: SIM115
        self.clients += 1
        self.client = subprocess.Popen([self.snug, "pack", *self.words, "--samples", "0", "--decision-time", "0.02", "--plant", f"ur://127.0.0.1:{self.relay.offset}",
                                        "--plant-timeout", PATIENCE, "--observe", self.boxes, "--log", self.log, *resume], stdout=self.said, stderr=self.said)

    def release(self):
        """Who stands at the robot looks why it stopped and releases it: a session that comes to a stopped robot refuses it."""
        stamp = self.watch.now()[0]
        if self.watch.now()[5] != PROTECTIVE_STOP:
            return
        self.say("a protective stop was released by hand")
        if not self.watch.wait(lambda now: now[0] > stamp + 5.1, 60):
            raise Found("the robot's clock stands")
        with socket.create_connection(("127.0.0.1", 29999 + self.relay.to)) as dashboard, dashboard.makefile("rw") as lines:
            lines.readline()
            lines.write("unlock protective stop\n")
            lines.flush()
            lines.readline()
        if not self.watch.wait(lambda now: now[5] != PROTECTIVE_STOP, 30):
            raise Found("the robot's stop is not released")

    def has_ended(self):
        return self.client is not None and self.client.poll() is not None

    def why(self):
        self.said.seek(0)
        return self.said.read()[-600:]

    def end(self):
        """What became of each box."""
        if self.client and self.client.poll() is None:
            self.client.kill()
            self.client.wait()
        self.relay.end()
        self.watch.close()
        self.served.send_signal(signal.SIGINT)
        out = self.served.stdout.read()
        self.served.wait()
        self.reader.join()
        self.served.stdout.close()
        self.served.stderr.close()
        return collections.Counter(box["state"] for box in json.loads(out.splitlines()[-1])["boxes"]) if out.strip() else collections.Counter()


def strike(cell, how, draw, within):
    """One instant. Returns how long the robot went on (s of its time) after the last command, and after the strike; whether its vacuum was on."""
    if cell.client is None or cell.has_ended():
        cell.start()
    if not cell.watch.wait(lambda now: now[1] > 0.05 or cell.has_ended(), 60):
        raise Found(f"{how}: the robot does not move: {cell.why()}")
    end = time.monotonic() + draw.uniform(0.0, within)
    while time.monotonic() < end and not cell.has_ended():
        time.sleep(0.005)
    if cell.has_ended():
        return None
    if how == "cut":
        cell.relay.cut()
    else:
        cell.client.send_signal(signal.SIGKILL if how == "killed" else signal.SIGSTOP)
    stamp, _, outputs, *_ = cell.watch.now()
    if not cell.watch.wait(lambda now: now[0] > stamp + 1.0, 30):
        raise Found(f"{how}: the robot's clock stands")
    after = cell.watch.since(stamp)
    known = cell.watch.since(stamp - 2.0)
    period = known[-1][0] - known[-2][0]
    last_command = next((one[0] for one, before in zip(known[:0:-1], known[-2::-1]) if one[4] != before[4]), stamp)
    stood = max((one[0] + period for one in known if one[1] > STILL), default=0.0)
    if len({one[2] & 1 for one in after[3:]}) != 1:
        raise Found(f"{how}: the vacuum was switched")
    if after[-1][3] == 2:
        raise Found(f"{how}: the program on the robot still runs")
    return max(0.0, stood - last_command), max(0.0, stood - stamp), bool(outputs & 1)


def go_on(cell, how):
    """The client comes back, or another one does."""
    if how == "frozen":
        cell.client.send_signal(signal.SIGCONT)
    else:
        try:
            cell.client.wait(30)
        except subprocess.TimeoutExpired:
            raise Found(f"{how}: the client does not end: {cell.why()}") from None
        cell.relay.mend()
        cell.release()
        cell.start()
    if not cell.watch.wait(lambda now: now[3] == 2 or cell.has_ended(), 60):
        raise Found(f"{how}: the session does not go on: {cell.why()}")
    if cell.has_ended() and cell.client.returncode == 2:
        raise Found(f"{how}: the session does not go on: {cell.why()}")


def cut_robot(snug, words, count, hows=HOWS, seed=1, say=print, goes_on=True, within=5.0):
    """`words`: scenario and sequence. Raises Found."""
    draw, held, sessions, became = random.Random(seed), collections.Counter(), 0, collections.Counter()
    cell = None
    with tempfile.TemporaryDirectory() as name:
        def fresh():
            nonlocal sessions
            sessions += 1
            folder = Path(name) / str(sessions)
            folder.mkdir()
            return Cell(snug, [*map(str, words)], folder, say)
        try:
            for how in hows:
                done, times, from_strike, moving = 0, [], 0.0, 0
                while done < count:
                    cell = cell or fresh()
                    struck = strike(cell, how, draw, within)
                    if struck is None:  # the session came to its end
                        if cell.client.returncode != 0:
                            raise Found(f"{how}: the session ended with {cell.client.returncode}: {cell.why()}")
                        became += cell.end()
                        cell = None
                        continue
                    took, after_strike, is_on = struck
                    if took > STANDS_WITHIN:
                        raise Found(f"{how}: the robot stood {took:.3f} s after its last command")
                    times.append(took)
                    moving += after_strike > 0.0
                    from_strike = max(from_strike, after_strike)
                    held[how] += is_on
                    done += 1
                    if goes_on:
                        go_on(cell, how)
                    else:
                        became += cell.end()
                        cell = None
                say(f"{how}: {count} times, {moving} while it moved, {held[how]} with the vacuum on; the robot stood {max(times):.3f} s after its last command"
                    f" at most (mean {sum(times) / count:.3f}; {from_strike:.3f} s from the strike as this program saw it), outputs as they were"
                    + ("; the session went on" if goes_on else "") + f"; load average {os.getloadavg()[0]:.1f}")
            if cell:  # the last session, to its end
                cell.client.wait(900)
                if cell.client.returncode != 0:
                    raise Found(f"the session ended with {cell.client.returncode}: {cell.why()}")
        finally:
            if cell:
                became += cell.end()
    lost = sum(became[state] for state in ("lost", "dropped", "outside", *(["held"] if goes_on else [])))
    say(f"{sessions} sessions, boxes: {', '.join(f'{number} {state}' for state, number in sorted(became.items()))}")
    if lost:
        raise Found(f"{lost} boxes are lost")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("count", type=int)
    parser.add_argument("--how", choices=HOWS, action="append")
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--within", type=float, default=5.0)
    parser.add_argument("--sequence", default="1")
    parser.add_argument("--snug", default=str(ROOT / "build" / "snug"), help="the program (default: build/snug)")
    parser.add_argument("--seed", type=int, default=1)
    words = parser.parse_args()
    try:
        cut_robot(words.snug, (DEMONSTRATOR, "--sequence", words.sequence), words.count, words.how or HOWS, words.seed,
                  lambda line: print(line, flush=True), not words.fresh, words.within)
    except Found as found:
        print(f"FOUND: {found}")
        sys.exit(1)


if __name__ == "__main__":
    main()
