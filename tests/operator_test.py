#!/usr/bin/env python3
"""operator_test.py: a person steps into `snug pack` by lines of words; the same lines give the same bytes. SNUG names the program."""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "init" / "cell.yaml"
ORDERS = "order,article,length_mm,width_mm,height_mm,mass_kg,count\nmine,A,180,120,90,0.4,2\nmine,B b,150,120,90,0.3,1\n"


class Operator(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = Path(self.scratch.name)
        (self.folder / "mine.csv").write_text(ORDERS)

    def pack(self, *more, said=""):
        words = ["pack", str(CELL), "--items", "mine.csv", "--sequence", "mine", "--samples", "0", "--decision-time", "0.05", *more]
        return subprocess.run([SNUG, *words], cwd=self.folder, input=said, text=True, capture_output=True, timeout=600, check=False)

    def result(self, *more, said=""):
        done = self.pack("--json", *more, said=said)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(done.stdout)

    def test_orders_of_a_log_repeat_its_session_at_any_number_of_threads(self):
        plain = self.result("--threads", "1")
        self.assertEqual(self.result("--threads", "1", "--operator", "-")["state_hash"], plain["state_hash"], "nobody said anything")
        first = self.result("--threads", "1", "--operator", "-", "--log", "a.jsonl", said="next elsewhere\nITEM000002 skip\nnext take-out ITEM000001\n")
        self.assertNotEqual(first["state_hash"], plain["state_hash"])
        self.assertEqual([item["end"] for item in first["items"]][1], "skipped")
        self.assertIn("by the operator", [item.get("reason") for item in first["items"]])
        steps = [step for item in first["items"] for step in item.get("operator", [])]
        self.assertEqual(len(steps), 3, steps)
        events = [json.loads(line) for line in (self.folder / "a.jsonl").read_text().splitlines()]
        orders = [event["order"] for event in events if event["event"] == "operated" and event["was_followed"]]
        (self.folder / "said.operator").write_text("\n".join(orders) + "\n")
        again = self.result("--threads", "3", "--operator", "said.operator")
        self.assertEqual(again["state_hash"], first["state_hash"])

    def test_lines_that_are_none_are_refused_before_anything_is_written(self):
        for text, expected in (("nobody skip\n", "said.operator:1: item"), ("next hold\nnext skipp\n", "said.operator:2: action"), ("next\n", "said.operator:1")):
            (self.folder / "said.operator").write_text(text)
            done = self.pack("--operator", "said.operator", "--program", "p.csv")
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertRegex(done.stderr, re.escape(expected))
            self.assertFalse((self.folder / "p.csv").exists())
        self.assertEqual(self.pack("--operator", "nowhere").returncode, 2)
        self.assertEqual(self.pack("--operator", "said.operator", "--log", "said.operator").returncode, 2, "it would be overwritten")


if __name__ == "__main__":
    unittest.main()
