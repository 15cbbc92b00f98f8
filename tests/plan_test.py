#!/usr/bin/env python3
"""plan_test.py: decisions of a session are repeated from saved beliefs, and its event log says what it came to. SNUG names the program."""
import json
import os
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
ITEMS = """parcel_types:
  - {name: brick, size: [0.11, 0.12, 0.1], mass: 0.4}
parcels:
  - {id: b1, type: brick, material: box}
  - {id: b2, type: brick, material: box}
  - {id: b3, type: brick, material: box}
sequences:
  - name: three
    items: [{parcel: b1, up: Z}, {parcel: b2, up: X}, {parcel: b3, up: Z}]
"""
QUICK = ("--samples", "1", "--decision-time", "0.02", "--threads", "2")


def snug(*words):
    return subprocess.run([SNUG, *map(str, words)], capture_output=True, text=True)


class RepeatedDecisions(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.beliefs, self.log = self.folder / "beliefs", self.folder / "session.jsonl"

    def pack(self, *words):
        result = snug("pack", CELL, "--plant-seed", 3, *QUICK, "--save-belief", self.beliefs, "--log", self.log, "--json", *words)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout), [json.loads(line) for line in self.log.read_text().splitlines()]

    def test_a_saved_belief_comes_to_the_same_plan_to_the_last_digit(self):
        items = self.folder / "items.yaml"
        items.write_text(ITEMS)
        session, events = self.pack("--items", items, "--sequence", "three")
        planned = [event for event in events if event["event"] == "planned"]
        self.assertGreaterEqual(len(planned), 3)
        for event in planned:
            path = self.beliefs / event["belief_file"]
            result = snug("plan", path, "--json", "--threads", 1)
            self.assertEqual(result.returncode, 0, result.stderr)
            again = json.loads(result.stdout)
            self.assertEqual(again["plan_hash"], event["hash"])
            self.assertEqual(again["planned"], event["planned"])
            self.assertEqual(len(again["tried"]), len(event["tried"]))
            self.assertIn("best", {one["verdict"] for one in again["tried"]})
        table = snug("plan", path)
        self.assertEqual(table.returncode, 0, table.stderr)
        self.assertIn(planned[-1]["hash"], table.stdout)
        self.assertEqual([event["event"] for event in events[:1] + events[-2:]], ["session started", "session ended", "stepped"])
        ended = [event for event in events if event["event"] == "item ended"]
        self.assertEqual([event["end"] for event in ended], [item["end"] for item in session["items"]])

    def test_says_what_is_wrong_with_a_belief(self):
        path = self.folder / "belief.json"
        for text, expected in (("{", "JSON text"), ("{}", "snug_belief"), ('{"snug_belief": 9}', "key")):
            path.write_text(text)
            result = snug("plan", path)
            self.assertEqual(result.returncode, 2)
            self.assertIn(str(path), result.stderr)
            self.assertIn(expected, result.stderr)
        self.assertEqual(snug("plan", self.folder / "nowhere.json").returncode, 2)

    def test_a_killed_session_leaves_its_events(self):
        process = subprocess.Popen([SNUG, "pack", CELL, "--sequence", "1", *QUICK, "--log", self.log, "--json"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        for _ in range(1200):
            if self.log.exists() and self.log.read_text().count('"item ended"') >= 2:
                break
            time.sleep(0.05)
        process.send_signal(signal.SIGKILL)
        process.wait()
        lines = self.log.read_text().split("\n")
        events = [json.loads(line) for line in lines[:-1]]
        self.assertGreaterEqual(sum(event["event"] == "item ended" for event in events), 2)
        self.assertEqual(events[0]["event"], "session started")
        self.go_on(events)

    def go_on(self, events):
        """The session that was killed, from its log: nothing that was done with comes again, and the rest comes."""
        whole, recording = self.folder / "whole.jsonl", self.folder / "rest.h5"
        words = ("pack", CELL, "--sequence", "1", *QUICK, "--resume", self.log)
        refused = snug(*words, "--log", self.log)
        self.assertEqual(refused.returncode, 2, "the log that is gone on with is no output")
        result = snug(*words, "--log", whole, "-o", recording, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        session = json.loads(result.stdout)
        told = [json.loads(line) for line in whole.read_text().splitlines()]
        self.assertEqual(len(session["items"]), len({item["box"] for item in session["items"]}), "each once")
        self.assertEqual([item["box"] for item in session["items"]], told[0]["items"][:len(session["items"])], "in the order of the sequence")
        counted = [i for i, event in enumerate(events) if event["event"] == "counted"]
        self.assertEqual(told[:counted[-1] + 1], events[:counted[-1] + 1], "told again as it was")
        times = [event["time"] for event in told if event["event"] == "counted"]
        self.assertEqual(times, sorted(times))
        before = sum(event["event"] == "item ended" for event in events[:counted[-1] + 1])
        self.assertGreater(len(session["items"]), before)
        self.assertEqual(session["executed_boxes"], sum(item["placed"] for item in session["items"]), "those from before count")
        self.assertEqual(session["boxes_lost"], 0)
        self.assertEqual(snug("report", recording, "-o", self.folder / "rest.html").returncode, 0)
        other = snug("pack", CELL, "--sequence", "2", *QUICK, "--resume", self.log)
        self.assertEqual(other.returncode, 2)
        self.assertIn("--resume: sequence", other.stderr)


if __name__ == "__main__":
    unittest.main()
