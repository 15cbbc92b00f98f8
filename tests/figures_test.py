#!/usr/bin/env python3
"""figures_test.py: the numbers that documents state are those that the program makes: those that take seconds are made again, what is said twice agrees;
and tools/figures.py finds, replaces and names blocks as it says. SNUG names the program."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True
import figures  # noqa: E402
from figure_makers import common, packing, physics  # noqa: E402


def row(sequence, plant, percent, **more):
    return {"agent": "contact-aware", "sequence": sequence, "plant_seed": plant, "executed_boxes": 12, "executed_percent": percent,
            "boxes_per_hour": 400.0, "items_sent": 12, "items_as_planned": 12, "boxes_lost": 0, "recoveries": 1,
            "failure": "", **more}


class Documents(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name) / "page.md"
        self.path.write_text("It is <!-- figures: one -->3 boxes<!-- end --> here.\n\n<!-- figures: two -->\n| a |\n\n*n = 1; commit 123, x86-64, 2 cores (`make figures`).*\n"
                             "<!-- end -->\n", encoding="utf-8")
        for name, value in (("documents", lambda: [self.path]), ("ROOT", Path(self.folder.name))):
            patch = mock.patch.object(figures, name, value)
            patch.start()
            self.addCleanup(patch.stop)

    def test_a_block_is_replaced_and_the_rest_stays(self):
        different = figures.put({"one": "4 boxes"}, False)
        self.assertEqual(len(different), 1)
        text = self.path.read_text(encoding="utf-8")
        self.assertIn("It is <!-- figures: one -->4 boxes<!-- end --> here.", text)
        self.assertIn("| a |", text)

    def test_a_check_writes_nothing_and_names_what_differs(self):
        before = self.path.read_bytes()
        different = figures.put({"one": "4 boxes"}, True)
        self.assertIn("page.md: one: stands:\n3 boxes\nmade:\n4 boxes", different[0])
        self.assertEqual(self.path.read_bytes(), before)

    def test_another_commit_is_no_difference(self):
        self.assertEqual(figures.put({"two": "| a |\n\n*n = 1; commit 456, aarch64, 8 cores (`make figures`).*"}, True), [])
        self.assertEqual(len(figures.put({"two": "| b |\n\n*n = 1; commit 456, aarch64, 8 cores (`make figures`).*"}, True)), 1)

    def test_times_may_differ_by_half_and_nothing_else(self):
        text = "| a | {} ms | {} boxes |\n\n*n; commit 123, x86-64, 2 cores of 2.5 GHz (`make figures`).*"
        for old, new, is_same in (((10, 3), (14, 3), True), ((14, 3), (10, 3), True), ((10, 3), (16, 3), False), ((10, 3), (10, 4), False)):
            self.assertEqual(figures.is_same(text.format(*old), common.Timed(text.format(*new))), is_same, (old, new))
        self.assertFalse(figures.is_same(text.format(10, 3), text.format(11, 3)))

    def test_a_table_whose_times_are_as_before_stays_byte_by_byte(self):
        self.path.write_text("<!-- figures: two -->\n| 10 ms |\n\n*n; commit 123, x86-64, 2 cores (`make figures`).*\n<!-- end -->\n", encoding="utf-8")
        before = self.path.read_bytes()
        figures.put({"two": common.Timed("| 11 ms |\n\n*n; commit 456, x86-64, 2 cores (`make figures`).*")}, False)
        self.assertEqual(self.path.read_bytes(), before)
        figures.put({"two": common.Timed("| 31 ms |\n\n*n; commit 456, x86-64, 2 cores (`make figures`).*")}, False)
        self.assertIn("| 31 ms |", self.path.read_text(encoding="utf-8"))

    def test_a_figure_without_a_place_is_an_error(self):
        with self.assertRaisesRegex(figures.CannotMake, "figures: three"):
            figures.put({"three": "x"}, True)


class Readme(unittest.TestCase):
    """What README repeats outside its blocks is what the blocks say."""

    def setUp(self):
        self.text = (figures.ROOT / "README.md").read_text(encoding="utf-8")
        self.blocks = {match[2]: match[3] for path in figures.documents() for match in figures.BLOCK.finditer(path.read_text(encoding="utf-8"))}

    def test_the_demonstrators_programs(self):
        row = next(line for line in self.blocks["acceptance"].splitlines() if line.startswith("| run on the real cell"))
        packed, boxes = (sum(map(int, counts)) for counts in zip(*re.findall(r"\| (\d+) of (\d+) (?=\|)", row)))
        self.assertIn(f"| {packed} of {boxes} boxes packed", self.text)
        self.assertIn(f"re-picked boxes lie {re.search(r'off by ([0-9.]+) mm', row)[1]} mm off on average", self.text)

    def test_the_filling(self):
        filled = re.search(r"may leave out two boxes \| ([0-9.]+) %", self.blocks["sessions"])[1]
        self.assertIn(f"instead of {filled} %", self.text)

    def test_the_tables_of_sessions_agree(self):
        short = re.search(r"may leave out two boxes \| (.*?) % \((.*?)\)", self.blocks["sessions"]).groups()
        long = re.search(r"\| snug, six plants \|.*\| ([0-9.]+) \(([^()]*)\) \|", self.blocks["sessions-by-sequence"]).groups()
        self.assertEqual(short, long)


class SaidTwice(unittest.TestCase):
    """docs/trust.md sums up what the tables of other pages state."""

    def setUp(self):
        self.text = (figures.ROOT / "docs" / "trust.md").read_text(encoding="utf-8")
        self.blocks = {match[2]: match[3] for path in figures.documents() for match in figures.BLOCK.finditer(path.read_text(encoding="utf-8"))}

    def found(self, name, pattern):
        match = re.search(pattern, self.blocks[name])
        self.assertIsNotNone(match, f"{name}: {pattern}")
        return match.groups()

    def test_the_tosses(self):
        position, rotation, right = self.found("tosses", r"\| held back \| ([0-9.]+) mm \| ([0-9.]+) degrees \| ([0-9.]+) %")
        self.assertIn(f"on the 57 held back: {float(position):.1f} mm, {float(rotation):.1f} degrees, {float(right):.0f} %", self.text)

    def test_the_releases(self):
        fitted, = self.found("releases", r"fitted to all \| ([0-9.]+) mm")
        left_out, = self.found("releases", r"left out in turn.*?\| ([0-9.]+) mm")
        phases, = self.found("releases", r"not fitted \| ([0-9.]+) mm")
        self.assertIn(f"{fitted} mm rms fitted, {left_out} mm on masses left out", self.text)
        self.assertIn(f"the older model, {phases} mm", self.text)
        readme = (figures.ROOT / "README.md").read_text(encoding="utf-8")
        self.assertIn(f"is {float(fitted):.1f} mm rms off where it was fitted, {float(left_out):.1f} mm on masses left out", readme)
        self.assertIn(f"an older one: {phases} mm", readme)

    def test_the_loads(self):
        filled = self.found("loading", r"\| ([0-9.]+) " * 6 + r"\| ([0-9.]+) ")
        self.assertIn(f"{min(map(float, filled)):.1f} to {max(map(float, filled)):.1f} %", self.text)

    def test_the_camera(self):
        position, = self.found("camera", r"position, median / 95th percentile \|[^|]*\| ([0-9.]+) /")
        chi, = self.found("camera", r"chi-square per degree of freedom \|[^|]*\| ([0-9.]+) ")
        self.assertIn(f"{position} mm and", self.text)
        self.assertIn(f"chi-square per degree of freedom {chi}", self.text)

    def test_the_numbers_called_identified(self):
        worst, = self.found("cases", r"none is more than ([0-9.]+) standard errors off")
        self.assertIn(f"none is more than {worst} standard errors off", self.text)


class NamedTests(unittest.TestCase):
    """A document that says which test checks a number names one that exists."""

    def test_every_test_that_a_document_names_exists(self):
        sources = "\n".join(path.read_text(encoding="utf-8") for folder in ("src", "apps", "bench") for path in (figures.ROOT / folder).rglob("*_test.cpp"))
        tests = {f"{suite}.{name}" for suite, name in re.findall(r"^TEST(?:_[FP])?\(\s*(\w+),\s*(\w+)\)", sources, re.M)}
        self.assertGreater(len(tests), 2000)
        wrong = []
        for path in figures.documents():
            for name in re.findall(r"`([A-Z]\w+\.(?:[A-Z]\w+(?:\.\.\.)?|\*))`", path.read_text(encoding="utf-8")):
                begin = name.removesuffix("...").removesuffix("*")
                if name != "Subject.DoesWhatWhenSituation" and not any(test.startswith(begin) for test in tests):
                    wrong.append(f"{path.relative_to(figures.ROOT)}: {name}")
        self.assertEqual(wrong, [])


class Made(unittest.TestCase):
    def test_the_tables_of_sessions(self):
        rows = [row(name, plant, 70.0 + plant) for name in common.SEQUENCES for plant in range(1, 7)]
        rows[3]["items_as_planned"] = 11
        strict = [row(name, plant, 68.0 + plant) for name in common.SEQUENCES for plant in range(1, 7)]
        words = mock.Mock(snug="snug", folder=Path("rows"))
        with mock.patch.object(packing, "run", side_effect=lambda command: json.dumps({"rows": strict if 0 in command else rows})):
            made = packing.sessions(words)
        self.assertIn("| snug, may leave out two boxes | 73.5 % (71.0 to 76.0) | 400 |", made["sessions"])
        self.assertIn("| snug, stopped at the first box that does not fit | 71.5 % (69.0 to 74.0) |", made["sessions"])
        self.assertIn("Of 360 boxes that the robot moved to a place 359 ended as planned; none was lost.", made["sessions"])
        self.assertIn("| people, by hand (the report) | 71.9 % | |", made["sessions"])
        self.assertIn("| snug, plant 1 | 12 / 71.0 |", made["sessions-by-sequence"])
        self.assertIn("| plant 2 | 72.00 | 72.00 | 72.00 | 72.00 | 72.00 | 72.00 |", made["sessions-by-plant"])
        self.assertIn("recoveries: 30. Of those stopped at the first box that does not fit (`--skips 0`), 360 of 360 ended as planned.", made["sessions-by-sequence"])

    def test_the_table_of_scenes(self):
        names = ("s1.awake.penetration_mm", "s1.awake.drift_mm", "s2.worst_penetration_mm", "s3.0.error_percent", "s3.22.error_percent", "s3.45.error_percent",
                 "s4.error_percent", "s6b.completes", "s6b.peak_force_N")
        results = [{"name": name, "value": 0.5 if name == "s3.22.error_percent" else 1.0} for name in names]
        with mock.patch.object(common, "run", return_value=json.dumps({"results": results})):
            made = physics.scenes(mock.Mock(snug="snug"))["bench"]
        self.assertIn("| distance of a sliding box, at 0, 22.5 and 45 degrees | 1.0000 % off | 0.05 % |", made)
        self.assertIn("| in, with 1 N |", made)

    def test_a_session_that_broke_off_makes_no_table(self):
        words = mock.Mock(snug="snug", folder=Path("rows"))
        with mock.patch.object(packing, "run", return_value=json.dumps({"rows": [row("1", 1, 70.0, failure="the plant was gone")]})), self.assertRaises(figures.CannotMake):
            packing.sessions(words)

    def test_a_figure_whose_data_are_not_here_makes_no_table(self):
        skipped = [{"name": "s1.awake.penetration_mm", "value": 0.0, "skipped": "no folder"}]
        with mock.patch.object(common, "run", return_value=json.dumps({"results": skipped})), self.assertRaisesRegex(figures.CannotMake, "s3.0.error_percent"):
            physics.scenes(mock.Mock(snug="snug"))

    def test_every_block_has_its_maker(self):
        named = {match[2] for path in figures.documents() for match in figures.BLOCK.finditer(path.read_text(encoding="utf-8"))}
        self.assertEqual(named, {*figures.MAKERS, "sessions-by-sequence", "sessions-by-plant"})

    def test_a_name_that_is_none_is_refused(self):
        done = subprocess.run([sys.executable, ROOT / "tools" / "figures.py", "session"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("expected first-run, sessions, acceptance", done.stderr)

    def test_what_takes_seconds_is_as_it_stands(self):
        for name in figures.QUICK:
            with self.subTest(name):
                done = subprocess.run([sys.executable, ROOT / "tools" / "figures.py", "--check", name, "--snug", SNUG], capture_output=True, text=True, check=False)
                if done.returncode == 2:  # data of others, or tests that were not built
                    print(done.stderr.strip(), file=sys.stderr)
                    continue
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
