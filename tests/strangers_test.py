#!/usr/bin/env python3
"""strangers_test.py: what programs, pages and people that nobody asked can do to a served cell, a served page and a study: nothing.
SNUG names the program."""
import contextlib
import http.client
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
DROP = ROOT / "scenarios" / "drop.yaml"



def field(number, payload):
    return bytes([number << 3 | 2, len(payload)]) + payload


def messages():
    """By the description of the protocol (src/snug/click/click.proto): a handshake, and a Control with speeds of the joints."""
    entry = field(1, b"ur10") + field(2, field(5, struct.pack("<6d", 0.2, 0, 0, 0, 0, 0)))
    return [bytes([8, 0, 16, 1]), bytes([8, 2]) + field(2, entry)]


class Scratch(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)

    def snug(self, *words, code=0, **more):
        result = subprocess.run([SNUG, *map(str, words)], cwd=self.folder, capture_output=True, text=True, check=False, timeout=300,
                                **more)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def start(self, *words, until, **more):
        """A program that goes on, once its standard error says `until`; the match."""
        process = subprocess.Popen([SNUG, *map(str, words)], cwd=self.folder, text=True, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)
        self.addCleanup(self.end, process)
        for line in process.stderr:
            if match := re.search(until, line):
                return process, match
        self.fail(f"{words} ended with {process.wait()}")

    @staticmethod
    def end(process, how=signal.SIGINT):
        if process.poll() is None:
            process.send_signal(how)
        out, err = process.communicate(timeout=60)
        return process.returncode, out, err


class Cell(Scratch):
    def test_text_of_a_page_moves_no_served_cell(self):
        process, match = self.start("serve", CELL, "--click", "tcp://127.0.0.1:*", "--json", until=r"serving .* at tcp://127\.0\.0\.1:(\d+)")
        port = int(match[1])
        with socket.create_connection(("127.0.0.1", port)) as page:
            page.sendall(self.request())
            page.settimeout(1.0)
            with contextlib.suppress(OSError):
                while page.recv(4096):  # until nothing comes any more, or the connection is closed
                    pass
            time.sleep(0.3)
        _, out, err = self.end(process)
        self.assertIn("snug: 0 steps", err)
        self.assertEqual(out, "")

    @staticmethod
    def request():
        """What `fetch` of another site's page sends: it chooses path and body. As ZMTP 1.0 the text is frames, each with its length and flags
        first; the body is padded up to where the one ends that reaches into it."""
        frames = b"".join(bytes([len(frame) + 1, 0]) + frame for frame in messages())
        for pad in range(200):
            head = (f"POST /{'x' * pad} HTTP/1.1\r\nHost: 127.0.0.1:5555\r\nOrigin: http://page.example\r\n"
                    f"Content-Type: text/plain;charset=UTF-8\r\nContent-Length: 300\r\n\r\n").encode()
            at = 0
            while at < len(head):
                begin, at = at, at + 1 + head[at]
            if begin + 1 < len(head) and not head[begin + 1] & 1:  # no frame of the same message follows
                return head + (b"\0" * (at - len(head)) + frames).ljust(300, b"x")
        raise AssertionError("no path is long enough")

    def test_an_address_for_other_machines_takes_keys(self):
        result = self.snug("serve", CELL, "--click", "tcp://*:5555", code=2)
        self.assertIn("--keys", result.stderr)

    def test_a_cell_with_keys_is_driven_by_who_has_one(self):
        self.snug("keys", "keys")
        self.assertEqual((self.folder / "keys" / "server.key_secret").stat().st_mode & 0o777, 0o600)
        self.assertIn("already", self.snug("keys", "keys", code=2).stderr)
        self.snug("keys", "keys", "--add", "camera")
        (self.folder / "program.csv").write_text("-0.6,0.1,0.3,0,3.14159,0,home,0,0,0,0,0,0")
        _, match = self.start("serve", CELL, "--click", "tcp://0.0.0.0:*", "--keys", "keys", until=r"serving .*:(\d+) ")
        words = ("control", "program.csv", "--scenario", CELL, "--click", f"tcp://127.0.0.1:{match[1]}")
        self.assertIn("nobody answers", self.snug(*words, "--timeout", "1", code=2).stderr)
        self.assertIn("one of the files", self.snug(*words, "--keys", "keys", code=2).stderr)
        self.assertIn("home", (self.folder / "program.csv").read_text())
        self.snug(*words, "--keys", "keys/camera.key_secret")
        self.snug("keys", "others")
        self.assertIn("nobody answers", self.snug(*words, "--keys", "others", "--timeout", "1", code=2).stderr)

    def test_a_served_cell_that_is_hung_up_ends_in_order(self):
        process, _ = self.start("serve", CELL, "--click", "tcp://127.0.0.1:*", until="serving")
        code, _, err = self.end(process, signal.SIGHUP)
        self.assertEqual(code, 0, err)
        self.assertIn("0 steps", err)


class Page(Scratch):
    def ask(self, port, path, **headers):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10)
        connection.putrequest("GET", path, skip_host=True)
        for name, value in {"Host": f"127.0.0.1:{port}", **headers}.items():
            connection.putheader(name, value)
        connection.endheaders()
        return connection.getresponse()

    def test_for_other_machines_asks_for_its_token_and_its_name(self):
        self.snug("simulate", DROP, "--until", "0.05", "-o", "run.h5")
        _, match = self.start("view", "run.h5", "--host", "0.0.0.0", "--name", "viewer.example", "--no-open",
                              until=r"showing at http://[^/]*:(\d+)/(\?token=[0-9a-f]{32})? ")
        port, query = int(match[1]), match[2] or ""
        self.assertEqual(self.ask(port, "/" + query, Host="evil.example").status, 403)
        self.assertEqual(self.ask(port, "/").status, 403)
        answer = self.ask(port, "/" + query, Host="viewer.example")
        self.assertEqual(answer.status, 200)
        cookie = answer.getheader("Set-Cookie").split(";")[0]
        self.assertEqual(self.ask(port, "/recordings.json").status, 403)
        self.assertEqual(self.ask(port, "/recordings.json", Cookie=cookie).status, 200)

    def test_that_is_hung_up_ends_in_order(self):
        self.snug("simulate", DROP, "--until", "0.05", "-o", "run.h5")
        process, _ = self.start("view", "run.h5", "--no-open", until="showing")
        self.assertEqual(self.end(process, signal.SIGHUP)[0], 0)


HUNG = """
import signal, time
signal.signal(signal.SIGINT, signal.SIG_IGN)
signal.signal(signal.SIGTERM, signal.SIG_IGN)
class Hung:
    def decide(self, state, item, candidates):
        print("asked", flush=True)
        time.sleep(1000)
"""


class Agents(Scratch):
    def interpreters(self):
        """Of this test: in its folder."""
        found = []
        for process in Path("/proc").glob("[0-9]*"):
            try:
                if os.readlink(process / "cwd") == str(self.folder) and b"agent.py" in (process / "cmdline").read_bytes():
                    found.append(process.name)
            except OSError:
                continue
        return found

    def pack(self, *more):
        (self.folder / "hung.py").write_text(HUNG)
        return ("pack", CELL, "--sequence", "1", "--samples", "0", "--agent", "hung:Hung", *more)

    def test_that_hang_end_with_the_program_at_the_first_signal(self):
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGKILL):
            with self.subTest(sent=sent):
                process, _ = self.start(*self.pack(), until="asked")
                start = time.monotonic()
                code, _, err = self.end(process, sent)
                self.assertLess(time.monotonic() - start, 20.0)
                if sent != signal.SIGKILL:
                    self.assertEqual(code, 1, err)
                    self.assertIn("interrupted", err)
                time.sleep(0.5)
                self.assertEqual(self.interpreters(), [])

    def test_that_hang_have_a_limit(self):
        result = self.snug(*self.pack("--agent-timeout", "2"), code=1)
        self.assertIn("no answer within 2 s", result.stderr)
        self.assertEqual(self.interpreters(), [])


class Bounds(Scratch):
    def test_a_load_of_many_kinds_is_refused_at_once(self):
        lines = ["length_mm,width_mm,height_mm,mass_kg,article"]
        lines += [f"{100 + i % 300},{100 + i // 300},50,1,a{i}" for i in range(100_000)]
        (self.folder / "orders.csv").write_text("\n".join(lines))
        before = os.times()
        self.assertIn("at most 1000 kinds", self.snug("load", "orders.csv", "--container", "1000", "1000", "1000", code=2).stderr)
        after = os.times()
        self.assertLess(after.children_user - before.children_user, 3.0)

    def test_a_spin_that_no_step_can_follow_is_refused(self):
        self.snug("simulate", DROP, "--until", "0.05", "--set", "bodies.parcel.twist.angular=[0, 0, 1000]")
        words = ("simulate", DROP, "--set", "bodies.parcel.twist.angular=[0, 0, 1000]")
        for more in (("--set", "time_step=0.1"), ("--dt", "0.1")):
            result = self.snug(*words, *more, code=2)
            self.assertIn("rad/s", result.stderr)


class Counts(Scratch):
    """Some of what `make attack` does as often as is asked for (tools/attack.py)."""

    def attack(self, what, count):
        done = subprocess.run([sys.executable, "-B", ROOT / "tools" / "attack.py", what, str(count), "--snug", SNUG], cwd=self.folder, capture_output=True,
                              text=True, check=False, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_at_every_server_move_nothing_and_end_nothing(self):
        said = self.attack("servers", 48)
        self.assertIn("0 motions by strangers", said)
        for server in ("CLICK", "UR dashboard", "UR primary", "UR secondary", "UR real time", "UR RTDE", "view", "ui"):
            self.assertIn(f"{server}: ", said)

    def test_verbs_that_are_killed_leave_the_old_file_or_a_whole_one(self):
        self.assertIn("3 kills over 3 verbs", self.attack("kills", 3))

    def test_a_study_that_is_killed_comes_to_the_same_table(self):
        self.assertIn("tables are equal", self.attack("studies", 3))


if __name__ == "__main__":
    unittest.main()
