#!/usr/bin/env python3
"""cli_test.py: the command line as a user or a script meets it. SNUG names the program."""
import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CUP_DATA = ROOT.parent / "shared" / "data" / "cup"


def snug(*words, stdin=""):
    return subprocess.run([SNUG, *map(str, words)], input=stdin, capture_output=True, text=True, check=False,
                          timeout=240)



class CommandLine(unittest.TestCase):
    def assert_refused(self, result, *expected):
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(result.stdout, "", "messages belong on stderr")
        self.assertTrue(result.stderr.startswith("snug: error: "), result.stderr)
        for text in expected:
            self.assertIn(text, result.stderr)

    def test_version_is_printed_on_stdout(self):
        result = snug("--version")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, r"^snug \d+\.\d+\.\d+\n$")

    def test_version_is_that_of_the_changelog(self):
        newest = next(line for line in (ROOT / "CHANGELOG.md").read_text().splitlines() if line.startswith("## "))
        self.assertIn(snug("--version").stdout.split()[1], newest)

    def test_help_has_examples(self):
        result = snug("--help")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertIn("Examples:", result.stdout)

    def test_no_words_print_the_help(self):
        self.assertEqual(snug().stdout, snug("--help").stdout)

    def test_unknown_verb_is_refused_and_the_verbs_are_named(self):
        self.assert_refused(snug("jump"), "'jump'", "expected one of")

    def test_unknown_option_is_refused(self):
        self.assert_refused(snug("--jump"), "--jump", "--help")

    def test_misspelt_verb_gets_a_suggestion(self):
        self.assert_refused(snug("simulat"), "did you mean simulate?")


DROP = ROOT / "scenarios" / "drop.yaml"
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"


class Simulate(unittest.TestCase):
    assert_refused = CommandLine.assert_refused

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def test_simulate_help_has_examples(self):
        result = snug("simulate", "--help")
        self.assertEqual(result.returncode, 0)
        self.assertIn("Examples:", result.stdout)

    def test_missing_scenario_is_refused_by_name(self):
        self.assert_refused(snug("simulate", self.folder / "none.yaml"), "none.yaml")

    def test_folder_as_scenario_is_refused(self):
        self.assert_refused(snug("simulate", self.folder), str(self.folder))

    def test_no_scenario_is_refused(self):
        self.assert_refused(snug("simulate"), "scenario")

    def test_unknown_key_is_refused_with_file_and_line_and_nearest_key(self):
        path = self.write("typo.yaml", DROP.read_text() + "\ngravitee: [0, 0, -9.81]\n")
        line = path.read_text().splitlines().index("gravitee: [0, 0, -9.81]") + 1
        self.assert_refused(snug("simulate", path), f"typo.yaml:{line}", "gravitee", "gravity")

    def test_missing_program_is_refused_by_name(self):
        self.assert_refused(snug("simulate", CELL, "--program", self.folder / "none.csv", "--sequence", "1"), "none.csv")

    def test_bad_program_line_is_refused_with_its_number(self):
        row = "-0.5,-0.4,0.4,0,3.14,0,PrePick027,0,0,0,0,0,0\n"
        path = self.write("bad.csv", row + row.replace("0.4,0,", "nan,0,"))
        self.assert_refused(snug("simulate", CELL, "--program", path, "--sequence", "1"), "bad.csv:2")

    def test_program_without_sequence_is_refused(self):
        path = self.write("one.csv", "-0.5,-0.4,0.4,0,3.14,0,PrePick027,0,0,0,0,0,0\n")
        self.assert_refused(snug("simulate", CELL, "--program", path), "--sequence", "one of 1")

    def test_sequence_without_program_is_refused(self):
        self.assert_refused(snug("simulate", CELL, "--sequence", "1"), "--program")

    def test_unknown_sequence_is_refused_and_the_known_are_named(self):
        path = self.write("one.csv", "-0.5,-0.4,0.4,0,3.14,0,PrePick027,0,0,0,0,0,0\n")
        self.assert_refused(snug("simulate", CELL, "--program", path, "--sequence", "nine"), "nine")

    def test_unknown_corrections_are_refused(self):
        path = self.write("one.csv", "-0.5,-0.4,0.4,0,3.14,0,PrePick027,0,0,0,0,0,0\n")
        self.assert_refused(snug("simulate", CELL, "--program", path, "--sequence", "1", "--corrections", "seq9"), "seq9")

    def test_bad_numbers_are_refused(self):
        for option, value in (("--dt", "0"), ("--dt", "-1"), ("--dt", "nan"), ("--dt", "1ms"), ("--until", "inf"),
                              ("--until", ""), ("--seed", "-1"), ("--seed", "x")):
            with self.subTest(option=option, value=value):
                self.assert_refused(snug("simulate", DROP, option, value), option)

    def test_misspelt_choice_gets_a_suggestion(self):
        self.assert_refused(snug("simulate", DROP, "--controller", "idael"), "did you mean ideal?")

    def test_record_into_a_missing_folder_is_refused(self):
        self.assert_refused(snug("simulate", DROP, "--until", "0.01", "-o", self.folder / "none" / "run.h5"), "run.h5")

    def test_scene_prints_a_table(self):
        result = snug("simulate", DROP, "--until", "0.05")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("body", result.stdout.splitlines()[0])

    def test_scene_prints_json_that_says_how_long_it_ran(self):
        result = snug("simulate", DROP, "--until", "0.05", "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        answer = json.loads(result.stdout)
        self.assertAlmostEqual(answer["duration_s"], 0.05, delta=1e-9)  # a whole number of steps
        self.assertGreater(len(answer["bodies"]), 0)

    def test_same_input_gives_the_same_hash_and_another_seed_may_not_crash(self):
        runs = [json.loads(snug("simulate", DROP, "--until", "0.1", "--seed", seed, "--json").stdout)
                for seed in (3, 3, 4)]
        self.assertEqual(runs[0]["state_hash"], runs[1]["state_hash"])
        self.assertEqual(len(runs[0]["bodies"]), len(runs[2]["bodies"]))

    def test_csv_has_a_strictly_increasing_time_and_leaves_nothing_else(self):
        path = self.folder / "drop.csv"
        result = snug("simulate", DROP, "--until", "0.1", "--csv", path)
        self.assertEqual(result.returncode, 0, result.stderr)
        rows = [line.split(";") for line in path.read_text().splitlines()]
        self.assertEqual(rows[0][0], "t")
        times = [float(row[0]) for row in rows[1:]]
        self.assertGreater(len(times), 5)
        self.assertTrue(all(a < b for a, b in zip(times, times[1:])))
        self.assertEqual([entry.name for entry in self.folder.iterdir()], ["drop.csv"])

    def test_recording_is_written_where_asked(self):
        path = self.folder / "drop.h5"
        self.assertEqual(snug("simulate", DROP, "--until", "0.05", "-o", path).returncode, 0)
        self.assertEqual(path.read_bytes()[:8], b"\x89HDF\r\n\x1a\n")
