#!/usr/bin/env python3
"""cli_test.py: the command line as a user or a script meets it. SNUG names the program."""
import html
import json
import os
import re
import shlex
import signal
import subprocess
import tempfile
import time
import unittest
import urllib.parse
import urllib.request
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CUP_DATA = ROOT.parent / "shared" / "data" / "cup"
RELEASES = ROOT.parent / "shared" / "data" / "releases" / "releases.csv"
POSES = ROOT.parent / "shared" / "data" / "cup-poses" / "poses.csv"


def snug(*words, stdin=""):
    return subprocess.run([SNUG, *map(str, words)], input=stdin, capture_output=True, text=True, check=False,
                          timeout=1100)


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
        self.assertRegex(result.stdout, r"^snug \d+\.\d+\.\d+( \([0-9a-f]+(-dirty)?\))?\n$")

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

    def test_misspelt_options_and_verbs_behind_others_get_a_suggestion(self):
        pack = ("pack", CELL)
        for words, part in (((*pack, "--sequnce", 1), "--sequnce: got an unknown option; expected one of `snug pack --help`; "
                                                      "did you mean --sequence?"),
                            ((*pack, "--sequence", 1, "--samlpes", 0), "did you mean --samples?"),
                            ((*pack, "--sequence", 1, "--samlpes=0"), "--samlpes: got"),
                            (("simulate", DROP, "--unitl", "x"), "did you mean --until?"),
                            (("identify", "scene", "x.yaml", "--thraeds", 1), "did you mean --threads?"),
                            (("identify", "stifness", "x.json"), "did you mean stiffness?"),
                            (("items",), "verb after items: got nothing; expected one of draw, read, reduce, sequence"),
                            (("simulate", DROP, "--set", "contacts.pairs.box/flor.friction=0.1"), "nearest is 'box/floor'"),
                            ((*pack, "--sequence", 1, "--set", "contacts.pairs.box/cup.friction=0.1"), "box/gripper, box/lip")):
            with self.subTest(words=words):
                self.assert_refused(snug(*words), part)


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
        self.assert_refused(snug("simulate", DROP, "--controller", "exatc"), "did you mean exact?")

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


def rows(count):
    return [[float(i == j) for j in range(count)] for i in range(count)]


DEFORMATION = {"R": rows(3), "o": [0.0, 0.0, 0.001], "K": [[1000.0 * v for v in row] for row in rows(6)],
               "S_R_S1": rows(3), "S_o_S1": [0.0, 0.0, 0.0]}
LOAD = {"W_R_E": [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]], "mass": 1.0, "com_S": [0.0, 0.0, 0.05],
        "K": [[1000.0 * v for v in row] for row in rows(6)],
        "E_H_S2": {"R": rows(3), "o": [0.0, 0.0, 0.025]}, "S_H_S1": {"R": rows(3), "o": [0.0, 0.0, -0.025]}}


def norm(values):
    return sum(value * value for value in values) ** 0.5


class Robot(unittest.TestCase):
    """simulate --robot, check and export of programs."""
    assert_refused = CommandLine.assert_refused
    setUp = Simulate.setUp
    write = Simulate.write
    NEAR = "-0.1,-0.69,0.2,0,3.14159,0,home,0,0,0,0,0,0\n"
    FAR = "-0.1,-3.69,0.2,0,3.14159,0,home,0,0,0,0,0,0\n"

    def test_helps_have_examples(self):
        for verb in ("check", "export"):
            self.assertIn("Examples:", snug(verb, "--help").stdout)

    def test_unknown_robot_is_refused_and_the_known_is_named(self):
        path = self.write("near.csv", self.NEAR)
        words = ("simulate", CELL, "--program", path, "--sequence", "1", "--robot", "ur5")
        self.assert_refused(snug(*words), "ur5", "ur10")

    def test_robot_without_program_is_refused(self):
        self.assert_refused(snug("simulate", CELL, "--robot", "ur10"), "--program")

    def test_scenario_without_robot_cannot_be_checked(self):
        self.assert_refused(snug("check", DROP, "--program", self.write("near.csv", self.NEAR)), "robot")

    def test_csv_has_joints_and_sensor(self):
        path, table = self.write("near.csv", self.NEAR), self.folder / "near-joints.csv"
        result = snug("simulate", CELL, "--program", path, "--sequence", "1", "--robot", "ur10", "--csv", table)
        self.assertEqual(result.returncode, 0, result.stderr)
        names = table.read_text().splitlines()[0].split(";")
        for name in ("qIn_0", "alphaIn_5", "tauIn_3", "UR10FTSensor_fz", "UR10FTSensor_cx",
                     "robot/forearm_link_FloatingBase_position_x"):
            self.assertIn(name, names)

    def test_check_passes_what_can_be_done(self):
        result = snug("check", CELL, "--program", self.write("near.csv", self.NEAR), "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertTrue(json.loads(result.stdout)["ok"])

    def test_check_names_row_and_margin_of_what_is_out_of_reach(self):
        result = snug("check", CELL, "--program", self.write("far.csv", self.NEAR + self.FAR), "--json")
        self.assertEqual(result.returncode, 1)
        reach = [f for f in json.loads(result.stdout)["findings"] if f["kind"] == "reach"]
        self.assertEqual(reach[0]["row"], 2)
        self.assertLess(reach[0]["margin"], -1.0)

    def test_simulation_stops_there_too(self):
        path = self.write("far.csv", self.NEAR + self.FAR)
        result = snug("simulate", CELL, "--program", path, "--sequence", "1", "--robot", "ur10", "--json")
        self.assertEqual(result.returncode, 1)
        stop = json.loads(result.stdout)["protective_stop"]
        self.assertEqual((stop["what"], stop["row"]), ("stuck", 2))

    def test_export_of_a_program_needs_the_scenario(self):
        path = self.write("near.csv", self.NEAR)
        self.assert_refused(snug("export", path, "--format", "urscript", "-o", self.folder / "x"), "--scenario")

    def test_export_writes_all_formats_of_programs(self):
        path = self.write("near.csv", self.NEAR)
        for name, begins in (("urscript", b"def snug_program"), ("ros-trajectory", b"# trajectory_msgs"),
                             ("mc-rtc-csv", b"t;qIn_0"), ("mc-rtc-flat", b"")):
            out = self.folder / name
            result = snug("export", path, "--scenario", CELL, "--format", name, "-o", out)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(begins, out.read_bytes())

    def test_export_refuses_what_the_robot_cannot_do_and_writes_nothing(self):
        path, out = self.write("far.csv", self.NEAR + self.FAR), self.folder / "far.yaml"
        result = snug("export", path, "--scenario", CELL, "--format", "ros-trajectory", "-o", out)
        self.assertEqual(result.returncode, 1)
        self.assertIn("waypoint 2", result.stderr)
        self.assertFalse(out.exists())


    PICK = ("-0.469,-0.422,0.37,0,3.14159,0,PrePick027,0,0,0,0,0,0\n-0.494,-0.43,{z},0,3.14159,0,Box027,0,0,0,0,0,0\n"
            "-0.494,-0.43,0.366,0,3.14159,0,PostPick027,1,0,0,0,0,0\n0.505,-0.35,0.2,0,3.14159,0,PrePlace027,{carry},0,0,0,0,0\n"
            "0.505,-0.35,-0.115,0,3.14159,0,Place027,{carry},0,0,0,0,0\n0.505,-0.35,0.2,0,3.14159,0,PostPlace027,0,0,0,0,0,0\n")

    def test_export_refuses_a_pick_that_does_not_seal_and_a_box_that_is_lost_on_the_way(self):
        out = self.folder / "out"
        for name, program, reason in (("high", self.PICK.format(z=0.11, carry=1), "no seal toward PostPick027"),
                                      ("dropped", self.PICK.format(z=0.06, carry=0), "BOX027 is dropped, not packed")):
            for head in ("", "# tempo: 1\n"):
                path = self.write(f"{name}.csv", head + program)
                for form in ("urscript", "ros-trajectory"):
                    with self.subTest(name, head=head, form=form):
                        words = ("export", path, "--scenario", CELL, "--sequence", "1", "--format", form, "-o", out)
                        result = snug(*words)
                        self.assertEqual(result.returncode, 1, result.stderr)
                        self.assertIn(reason, result.stderr)
                        self.assertFalse(out.exists())
        self.assertEqual(snug(*words, "--unchecked").returncode, 0)

    def test_export_refuses_options_that_mean_nothing_to_the_format(self):
        path = self.write("near.csv", self.NEAR)
        for form, option, value, right in (("urscript", "--period", 0.1, "ros-trajectory"), ("urscript", "--every", 3, "mcap or csv"),
                                           ("ros-trajectory", "--vacuum-output", 3, "urscript"), ("mc-rtc-csv", "--period", 0.04, "ros-trajectory"),
                                           ("mcap", "--sequence", 1, "mc-rtc-flat"), ("csv", "--compression", "none", "mcap"),
                                           ("csv", "--urdf", "x.urdf", "mcap"), ("csv", "--encoding", "json", "mcap"),
                                           ("moveit-scene", "--load", None, "glb"), ("csv", "--time", 1, "glb or moveit-scene")):
            with self.subTest(form, option=option):
                scenario = () if form in ("mcap", "csv", "moveit-scene") else ("--scenario", CELL)
                result = snug("export", path, "--format", form, *scenario, option, *([] if value is None else [value]), "-o", self.folder / "x")
                self.assert_refused(result, option, f"with --format {form}", right)

    def test_export_refuses_a_vacuum_timeout_out_of_range_and_a_tempo_or_a_swing_that_is_misspelt(self):
        export = ("export", self.write("near.csv", self.NEAR), "--scenario", CELL, "--format", "urscript", "-o", self.folder / "x")
        for seconds in (0.0001, 601, 1e300, "nan"):
            self.assert_refused(snug(*export, "--vacuum-timeout", seconds), "--vacuum-timeout", "0.1 to 600")
        self.write("near.csv", "# tmepo: 1\n" + self.NEAR)
        self.assert_refused(snug(*export), "near.csv:1", "'# tempo: NUMBER'")
        self.write("near.csv", self.NEAR.replace("home", "PostPick(BOX027)~nan+0"))
        self.assert_refused(snug(*export), "near.csv:1", "~0.42+0.31")

    def test_a_urdf_without_efforts_is_used_with_a_warning(self):
        urdf = (ROOT / "scenarios" / "robots" / "ur10.urdf").read_text()
        line = next(n for n, text in enumerate(urdf.splitlines(), 1) if 'effort="330"' in text)
        self.write("robot.urdf", urdf.replace('effort="330"', 'effort="0"', 1))
        cell = self.write("cell.yaml", CELL.read_text().replace("urdf: robots/ur10.urdf", "name: ur10\n  urdf: robot.urdf"))
        words = ("--program", self.write("near.csv", self.NEAR), "--sequence", "1")
        for result in (snug("simulate", cell, *words, "--robot", "ur10"), snug("check", cell, *words)):
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn(f"robot.urdf:{line}: joint 'shoulder_pan_joint'", result.stderr)
            self.assertIn("effort 0", result.stderr)

    def test_a_scenario_without_limits_has_defaults_for_every_name(self):
        head, _, tail = CELL.read_text().partition("  limits:  # [ctl]")
        cell = self.write("cell.yaml", head + "  # [ctl] Offsets" + tail.partition("  # [ctl] Offsets")[2])
        self.assertNotIn("prefix: PrePick,", cell.read_text())
        cell.write_text(cell.read_text().replace("urdf: robots/", f"urdf: {CELL.parent}/robots/"))
        result = snug("check", cell, "--program", self.write("near.csv", self.NEAR.replace("home", "anything")))
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_rows_of_one_finding_are_printed_as_one_line(self):
        path = self.write("far.csv", self.NEAR + 3 * (self.NEAR.replace("0.2,0,", "-0.3,0,")))
        result = snug("check", CELL, "--program", path)
        self.assertEqual(result.returncode, 1)
        lines = [line for line in result.stdout.partition("Smallest")[0].splitlines() if line.startswith("collision       gripper")]
        self.assertEqual(len(lines), 1, result.stdout)
        self.assertIn("rows 2-4", lines[0])

    def test_program_of_another_sequence_is_warned_of_by_every_verb_that_does_it(self):
        with tempfile.TemporaryDirectory() as folder:
            path, out = Path(folder) / "program.csv", Path(folder) / "out"
            self.assertEqual(snug("program", CELL, ROOT / "scenarios" / "demo-placements.yaml", "--sequence", "1", "-o", path).returncode, 0)
            check = ("check", CELL, "--program", path)
            simulate = ("simulate", CELL, "--program", path, "--until", "1")
            for words in (check, simulate):
                with self.subTest(words[0]):
                    self.assertIn("program.csv does not fit sequence 2:", snug(*words, "--sequence", "2").stderr)
                    self.assertNotIn("warning", snug(*words, "--sequence", "1").stderr)
            rows = path.read_text().splitlines()
            path.write_text("\n".join(row for row in rows if "PrePick(" not in row) + "\n")
            for words in (check, simulate):
                self.assertRegex(snug(*words, "--sequence", "1").stderr, r"program.csv picks \d+ boxes before a row PrePick lets them come: BOX")
            path.write_text("\n".join(rows) + "\n")
            for form in ("ros-trajectory", "urscript"):
                export = ("export", path, "--scenario", CELL, "--format", form, "--unchecked", "-o", out)
                self.assert_refused(snug(*export, "--sequence", "2"), "--sequence", "got 2", "expected 1")
                self.assertFalse(out.exists())
            self.assertEqual(snug(*export, "--sequence", "1").returncode, 0)


class Cup(unittest.TestCase):
    assert_refused = CommandLine.assert_refused

    def answers(self, part, cases):
        result = snug("cup", part, stdin="".join(json.dumps(case) + "\n" for case in cases))
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return [json.loads(line) for line in result.stdout.splitlines()]

    def vectors(self, name):
        if not CUP_DATA.exists():
            self.skipTest(f"no test vectors at {CUP_DATA}")
        return json.loads((CUP_DATA / name).read_text())["cases"]

    def test_cup_alone_asks_for_a_part(self):
        self.assert_refused(snug("cup"), "nothing; expected one of evaluate, settle")

    def test_cup_help_has_examples(self):
        for part in ("evaluate", "settle"):
            self.assertIn("Example:", snug("cup", part, "--help").stdout)

    def test_stretched_cup_pulls_the_box_back(self):
        answer, = self.answers("evaluate", [DEFORMATION])
        # Closed form: V = k x^2 / 2 and f = -k x for a translation; the rest is rounding.
        self.assertAlmostEqual(answer["V"], 1000.0 * 0.001**2 / 2.0, delta=1e-15)
        self.assertAlmostEqual(answer["wrench_S"][2], -1.0, delta=1e-12)

    def test_hanging_box_stretches_the_cup_by_weight_over_stiffness(self):
        answer, = self.answers("settle", [LOAD])
        self.assertTrue(answer["stable"])
        self.assertAlmostEqual(answer["E_o_S"][2], 0.05 + 9.81 / 1000.0, delta=1e-9)  # the solver's tolerance

    def test_a_cup_estimated_from_a_data_sheet_is_one_that_a_scenario_takes(self):
        words = ("cup", "estimate", "--diameter", 40, "--bellows", 1.5, "--material", "silicone", "--lip", "foam", "--stroke", 12, "--mass-max", 5)
        with tempfile.TemporaryDirectory() as folder:
            scenario = Path(folder) / "scene.yaml"
            result = snug(*words, "--vacuum", "-60kPa")
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            scenario.write_text(DROP.read_text() + "\n" + result.stdout)
            self.assertEqual(snug("simulate", scenario, "--until", "0.01", "--json").returncode, 0)
        found = json.loads(snug(*words, "--vacuum", "-0.6bar", "--json").stdout)
        self.assertTrue(all(p["low"] <= p["value"] <= p["high"] for p in [*found["parameters"], found["pull_off_N"]]))
        self.assertEqual(snug(*words, "--vacuum", "-60").returncode, 2)
        self.assertIn("pull-off", snug("cup", "catalogue").stdout)

    def test_blank_lines_are_skipped_and_the_answers_keep_their_order(self):
        cases = [dict(DEFORMATION, id=number) for number in (5, 3, 9)]
        result = snug("cup", "evaluate", "-", stdin="\n" + "\n\n".join(json.dumps(case) for case in cases))
        self.assertEqual([json.loads(line)["id"] for line in result.stdout.splitlines()], [5, 3, 9])

    def test_bad_line_is_refused_with_its_number_after_the_good_ones(self):
        result = snug("cup", "evaluate", stdin=json.dumps(DEFORMATION) + "\n\n{broken\n")
        self.assertEqual((result.returncode, len(result.stdout.splitlines())), (2, 1))
        self.assertRegex(result.stderr, r"^snug: error: stdin:3: ")

    def test_bad_values_are_refused_by_key(self):
        for key, value in (("R", [[2.0, 0, 0], [0, 1.0, 0], [0, 0, 1.0]]), ("o", [0.0, 0.0]), ("K", "stiff"),
                           ("K", [[-1.0 * v for v in row] for row in rows(6)]), ("kay", 1)):
            with self.subTest(key=key, value=value):
                self.assert_refused(snug("cup", "evaluate", stdin=json.dumps(dict(DEFORMATION, **{key: value}))),
                                    "stdin:1", key)

    def test_missing_file_is_refused_by_name(self):
        self.assert_refused(snug("cup", "settle", "/none/loads.jsonl"), "/none/loads.jsonl")

    def test_evaluate_agrees_with_the_test_vectors(self):
        cases = self.vectors("wrench.json")
        for case, answer in zip(cases, self.answers("evaluate", cases), strict=True):
            with self.subTest(id=case["id"], kind=case["kind"]):
                # Tolerances as stated with the vectors.
                self.assertLessEqual(abs(answer["V"] - case["V"]), 1e-10 * (abs(case["V"]) + 1e-12))
                for key in ("wrench_S", "wrench_S1"):
                    error = norm([a - b for a, b in zip(answer[key], case[key], strict=True)])
                    self.assertLessEqual(error, 1e-9 * (norm(case[key]) + 1e-6), key)

    def test_settle_agrees_with_the_test_vectors(self):
        cases = self.vectors("static.json")
        for case, answer in zip(cases, self.answers("settle", cases), strict=True):
            with self.subTest(id=case["id"]):
                # Tolerances as stated with the vectors: 1e-7 m, 1e-6 rad.
                self.assertLessEqual(norm([a - b for a, b in zip(answer["E_o_S"], case["E_o_S"], strict=True)]), 1e-7)
                turns = [a - b for got, right in zip(answer["E_R_S"], case["E_R_S"], strict=True)
                         for a, b in zip(got, right, strict=True)]
                self.assertLessEqual(norm(turns) / 2.0**0.5, 1e-6)  # |R1 - R2| = sqrt(2) x angle, for small angles
                self.assertEqual(answer["stable"], case["min_tangent_eig"] > 0.0)
class Views(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name)
        self.recording = self.path / "drop.h5"
        result = snug("simulate", DROP, "--until", 1, "-o", self.recording)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_report_is_one_page_without_addresses_to_load_from(self):
        page = self.path / "drop.html"
        result = snug("report", self.recording, "-o", page)
        self.assertEqual(result.returncode, 0, result.stderr)
        text = page.read_text()
        self.assertIn('id="snug-recording-0"', text)
        self.assertNotRegex(text, r"""(?:src|href)=["']https?:""")
        self.assertEqual([p.name for p in self.path.iterdir() if "part" in p.name], [])

    def test_report_refuses_what_is_no_recording_and_writes_nothing(self):
        page = self.path / "page.html"
        result = snug("report", DROP, "-o", page)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("drop.yaml", result.stderr)
        self.assertFalse(page.exists())

    def test_picture_is_a_png_of_the_size_asked_for_with_something_on_it(self):
        picture = self.path / "drop.png"
        result = snug("picture", self.recording, "--time", 0.5, "--size", "320x200", "-o", picture)
        self.assertEqual(result.returncode, 0, result.stderr)
        data = picture.read_bytes()
        self.assertTrue(data.startswith(b"\x89PNG"))
        self.assertEqual((int.from_bytes(data[16:20], "big"), int.from_bytes(data[20:24], "big")), (320, 200))
        self.assertGreater(len(data), 4000)  # an empty one has 1 kB

    def view(self, *words):
        """Starts `snug view`; returns the process and the address it tells."""
        process = subprocess.Popen([SNUG, "view", "--no-open", *map(str, words)], stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        line = process.stderr.readline()
        self.assertRegex(line, r"^snug: showing at http://127\.0\.0\.1:\d+/ ")
        return process, line.split()[3]

    def get(self, address):
        with urllib.request.urlopen(address, timeout=20) as response:
            return response.read()

    def test_view_serves_page_and_recordings_until_it_is_interrupted(self):
        process, address = self.view(self.recording, self.recording)
        page = self.get(address)
        self.assertIn(b"<html", page)
        self.assertNotIn(b"<!--snug:recordings-->", page)
        self.assertEqual(json.loads(self.get(address + "recordings.json")),
                         {"recordings": [{"name": "drop.h5"}, {"name": "drop.h5"}], "live": False})
        self.assertEqual(self.get(address + "recording/1")[:8], b"SNUGRPL1")
        process.send_signal(signal.SIGINT)
        self.assertEqual((process.wait(timeout=10), process.stdout.read()), (0, ""))

    def test_view_live_streams_pauses_and_shows_the_whole_run_at_its_end(self):
        recording = self.path / "live.h5"
        process, address = self.view("--live", DROP, "--until", 1, "--speed", 0, "--paused", "-o", recording)
        self.assertTrue(json.loads(self.get(address + "recordings.json"))["live"])
        with urllib.request.urlopen(address + "live", timeout=20) as stream:
            self.assertEqual(stream.readline(), b"event: header\n")
            command = urllib.request.Request(address + "live/resume", method="POST", headers={"X-Snug": "1"})
            self.assertEqual(urllib.request.urlopen(command, timeout=20).status, 204)
            while stream.readline() != b"event: end\n":
                pass
            self.assertEqual(stream.readline(), b'data: {"failure":""}\n')
        self.assertEqual(self.get(address + "recording/0")[:8], b"SNUGRPL1")
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(timeout=10), 0)
        # Being watched changes nothing.
        told = process.stdout.read().splitlines()[-1]
        self.assertEqual(told, snug("simulate", DROP, "--until", 1).stdout.splitlines()[-1])
        self.assertTrue(recording.exists())

    def test_view_live_that_is_interrupted_ends_in_order(self):
        process, _ = self.view("--live", DROP, "--until", 1000, "--speed", 1)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=10), 0)
        self.assertIn("state hash", process.stdout.read())

    def test_view_refuses_what_it_cannot_show(self):
        for words in ([], [self.recording, "--live", DROP], ["--live", "no.yaml"], ["--live", CELL, "--program", "no.csv"],
                      [DROP], ["no.h5"], [self.recording, "--port", 70000], [self.recording, "--host", "192.0.2.1"],
                      ["--live", DROP, "--speed", -1], ["--live", DROP, "--sequence", "1"],
                      ["--live", DROP, "-o", self.path / "no" / "such.h5"], [self.recording, "--program", "x.csv"]):
            with self.subTest(words=words):
                result = snug("view", "--no-open", *words)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertTrue(result.stderr.startswith("snug: error: "), result.stderr)

    def test_video_is_the_pictures_of_its_instants(self):
        frames = self.path / "frames"
        looks = ["--size", "160x100", "--camera", "cell"]
        result = snug("picture", self.recording, "--video", frames, "--fps", 10, "--from", 0.2, "--to", 0.45, *looks)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(sorted(p.name for p in frames.iterdir()), [f"frame-{i:06}.png" for i in range(3)])
        pictures = [(frames / f"frame-{i:06}.png").read_bytes() for i in range(3)]
        self.assertEqual(len(set(pictures)), 3, "the box falls")
        single = self.path / "single.png"
        result = snug("picture", self.recording, "--time", 0.4, "-o", single, *looks)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(single.read_bytes(), pictures[2])

    def test_video_refuses_what_it_cannot_draw_and_leaves_nothing(self):
        full = self.path / "full"
        full.mkdir()
        (full / "frame-000000.png").write_bytes(b"of another video")
        for words, text in ((["--video", full], "folder"), (["--video", DROP], "--video"), ([], "--video"),
                            (["--video", self.path / "v", "-o", "x.png"], "both"),
                            (["--video", self.path / "v", "--fps", 0], "--fps"),
                            (["--video", self.path / "v", "--from", 2, "--to", 3], "--from"),
                            (["--video", self.path / "v", "--speed", 1e-3, "--fps", 1000], "--fps"),
                            (["--video", self.path / "v", "--time", 1], "--time"), (["-o", "x.png", "--from", 1], "--from")):
            with self.subTest(words=words):
                result = snug("picture", self.recording, *words)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn(text, result.stderr)
        self.assertFalse((self.path / "v").exists())
        self.assertEqual((full / "frame-000000.png").read_bytes(), b"of another video")

    def test_video_that_is_interrupted_ends_in_order(self):
        frames, temporary = self.path / "frames", self.path / "tmp"
        temporary.mkdir()
        process = subprocess.Popen([SNUG, "picture", str(self.recording), "--video", str(frames), "--fps", "1000", "--size",
                                    "160x100"], stderr=subprocess.PIPE, text=True, env={**os.environ, "TMPDIR": str(temporary)})
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        for _ in range(600):
            if frames.is_dir() and any(frames.iterdir()):
                break
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=30), 1)
        self.assertIn("interrupted", process.stderr.read())
        self.assertEqual(list(temporary.glob("snug-picture-*")), [])
        self.assertEqual([p.name for p in frames.iterdir() if not p.name.endswith(".png")], [])

    def test_picture_says_when_the_browser_fails(self):
        for browser, code in (("/bin/true", 1), ("/bin/cat", 1), ("/no/such", 2)):
            result = subprocess.run([SNUG, "picture", str(self.recording), "-o", str(self.path / "x.png")], check=False,
                                    capture_output=True, text=True, env={**os.environ, "SNUG_CHROMIUM": browser}, timeout=60)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertTrue(result.stderr.startswith("snug: "), result.stderr)
        self.assertFalse((self.path / "x.png").exists())

    def test_export_writes_mcap_and_the_table(self):
        for name, begin in (("mcap", b"\x89MCAP0\r\n"), ("csv", b"t;"), ("moveit-scene", b"# moveit_msgs/PlanningScene")):
            out = self.path / f"drop.{name}"
            result = snug("export", self.recording, "--format", name, "-o", out)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertTrue(out.read_bytes().startswith(begin))
        self.assertIn('frame_id: "world"', (self.path / "drop.moveit-scene").read_text())
        table = self.path / "direct.csv"
        snug("simulate", DROP, "--until", 1, "--csv", table)
        self.assertEqual((self.path / "drop.csv").read_bytes(), table.read_bytes())

    def test_export_refuses_what_it_cannot_write_and_leaves_nothing(self):
        out = self.path / "x.mcap"
        for words in ([self.recording, "--format", "mcpa"], [DROP, "--format", "mcap"], ["no.h5", "--format", "mcap"],
                      [self.recording, "--format", "mcap", "--from", 5], [self.recording]):
            result = snug("export", *words, "-o", out)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertTrue(result.stderr.startswith("snug: error: "), result.stderr)
        self.assertEqual([p.name for p in self.path.iterdir() if "x.mcap" in p.name], [])

    def test_times_that_are_none_are_refused_everywhere(self):
        for words in (("export", "--format", "csv"), ("export", "--format", "mcap"), ("plot",), ("report",),
                      ("picture", "--video", self.path / "v")):
            for option in (["--from", "nan"], ["--to", "nan"], ["--from=-inf"], ["--to", "inf"]):
                with self.subTest(words=words, option=option):
                    output = () if "--video" in words else ("-o", self.path / "x.out")
                    result = snug(words[0], self.recording, *words[1:], *option, *output)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn("expected a finite number", result.stderr)
        self.assertEqual([path.name for path in self.path.iterdir()], ["drop.h5"])

    def test_an_instant_that_was_not_recorded_is_refused_alike(self):
        for verb in ("picture", "camera"):
            for time_s in ("1e9", "-5"):
                result = snug(verb, self.recording, "--time", time_s, "-o", self.path / "x.png")
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn("expected an instant of", result.stderr)
            self.assertIn("finite", snug(verb, self.recording, "--time", "nan", "-o", self.path / "x.png").stderr)

    def test_picture_refuses_words_it_does_not_know(self):
        for words in (["--camera", "sied"], ["--size", "12"], ["--show", "names,ghosts"], ["--time", "nan"]):
            result = snug("picture", self.recording, "-o", self.path / "x.png", *words)
            self.assertEqual(result.returncode, 2, result.stderr)
            self.assertIn(words[0], result.stderr)
        self.assertFalse((self.path / "x.png").exists())



UR10_DATA = ROOT.parent / "shared" / "data" / "ur10"


class Calibrate(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def write(self, name, text):
        (self.path / name).write_text(text)
        return self.path / name

    @unittest.skipUnless(UR10_DATA.exists(), f"no reference data at {UR10_DATA}")
    def test_deltas_give_the_same_tool_and_frames_near_nominal(self):
        for name in ("real", "large_delta"):
            out = self.path / "out.urdf"
            result = snug("calibrate", "kinematics", "--deltas", UR10_DATA / f"ur10_{name}_calibration.conf", "-o", out, "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            found = json.loads(result.stdout)
            self.assertLessEqual(found["max_end_effector_error_m"], 1e-9)
            self.assertLessEqual(found["max_end_effector_error_rad"], 1e-9)
            self.assertLessEqual(found["max_frame_shift_m"], 5e-3)
            # What is written is an arm: calibrating it by its own YAML changes nothing.
            yaml = self.path / "out.yaml"
            again = snug("calibrate", "kinematics", "--deltas", UR10_DATA / f"ur10_{name}_calibration.conf", "--write-yaml", yaml)
            self.assertEqual(again.returncode, 0, again.stderr)
            result = snug("calibrate", "kinematics", "--yaml", yaml, "--urdf", out, "--json")
            self.assertLess(json.loads(result.stdout)["max_frame_shift_m"], 1e-12)

    def test_tool_tip_is_found_and_written(self):
        # Touches of (0.5, 0, 0) with a tip at (0, 0, 0.3): turned by quarter turns, written by hand.
        quarter = 1.5707963267948966
        touches = self.write("touches.csv", "x,y,z,rx,ry,rz\n0.5,0,-0.3,0,0,0\n0.5,0.3,0," + f"{quarter},0,0\n"
                             f"0.5,-0.3,0,{-quarter},0,0\n0.2,0,0,0,{quarter},0\n0.8,0,0,0,{-quarter},0\n")
        out = self.path / "bent.urdf"
        result = snug("calibrate", "tool", touches, "-o", out, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        for value, expected in zip(found["tip_m"] + found["point_m"], [0, 0, 0.3, 0.5, 0, 0]):
            self.assertAlmostEqual(value, expected, places=12)
        self.assertAlmostEqual(found["tool_shift_m"][2], 0.3 - 0.335, places=12)
        again = json.loads(snug("calibrate", "tool", touches, "--urdf", out, "--json").stdout)
        self.assertLess(max(map(abs, again["tool_shift_m"])), 1e-12)

    def test_force_sensor_is_found_and_its_load_written(self):
        quarter, half = 1.5707963267948966, 3.141592653589793
        weight, lever = 1.2 * 9.81, 0.1  # N, m along z
        rows = [(0, 0, 0, 0, 0, -weight), (half, 0, 0, 0, 0, weight), (quarter, 0, 0, 0, -weight, 0),
                (-quarter, 0, 0, 0, weight, 0), (0, quarter, 0, weight, 0, 0), (0, -quarter, 0, -weight, 0, 0)]
        text = "rx,ry,rz,fx,fy,fz,tx,ty,tz\n"
        for rx, ry, rz, fx, fy, fz in rows:
            text += ",".join(str(v) for v in (rx, ry, rz, fx + 1, fy + 2, fz + 3, -lever * fy, lever * fx, 0.5)) + "\n"
        out = self.path / "weighed.urdf"
        result = snug("calibrate", "ft", self.write("ft.csv", text), "-o", out, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        self.assertAlmostEqual(found["mass_kg"], 1.2, places=9)
        for value, expected in zip(found["com_m"] + found["force_offset_N"] + found["torque_offset_Nm"],
                                   [0, 0, lever, 1, 2, 3, 0, 0, 0.5]):
            self.assertAlmostEqual(value, expected, places=9)
        self.assertIn("Calibrated: load of the sensor from ft.csv", out.read_text())

    def test_a_tool_frame_that_coincides_with_the_last_joint_can_be_measured(self):
        urdf = (ROOT / "scenarios" / "robots" / "ur10.urdf").read_text()
        turned = ('rpy="0 -1.5707963267948966 -1.5707963267948966"', 'rpy="1.5707963267948966 0 1.5707963267948966"')
        for rpy in turned:
            self.assertEqual(urdf.count(rpy), 1)
            urdf = urdf.replace(rpy, 'rpy="0 0 0"')
        arm = self.write("coincident.urdf", urdf)
        poses = self.write("poses.csv", "q1,q2,q3,q4,q5,q6,x,y,z,rx,ry,rz\n0,0,0,0,0,0,1,0,0,0,0,0\n")
        words = ("calibrate", "kinematics", "--poses", poses, "--urdf", arm, "--end")
        self.assertIn("10 or more", snug(*words, "tool0").stderr)
        result = snug(*words, "wrist_3_link")
        self.assertEqual(result.returncode, 2)
        self.assertIn("such as 'flange'", result.stderr)

    def test_another_arm_or_another_unit_is_refused_with_line_and_key(self):
        text = ("kinematics:\n  shoulder: {x: 0, y: 0, z: 0.1273, roll: 0, pitch: 0, yaw: 0}\n"
                "  upper_arm: {x: 0, y: 0, z: 0, roll: 1.570796327, pitch: 0, yaw: 0}\n"
                "  forearm: {x: -0.612, y: 0, z: 0, roll: 0, pitch: 0, yaw: 0}\n"
                "  wrist_1: {x: -0.5723, y: 0, z: 0.163941, roll: 0, pitch: 0, yaw: 0}\n"
                "  wrist_2: {x: 0, y: -0.1157, z: 0, roll: 1.570796327, pitch: 0, yaw: 0}\n"
                "  wrist_3: {x: 0, y: 0.0922, z: 0, roll: 1.570796327, pitch: 3.141592653, yaw: 3.141592653}\n")
        self.assertEqual(snug("calibrate", "kinematics", "--yaml", self.write("ok.yaml", text)).returncode, 0)
        for old, new, parts in (("x: -0.612", "x: -612", ("arm.yaml:4", "forearm.x", "metres")),
                                ("x: -0.612", "x: -0.425", ("arm.yaml", "elbow_joint", "0.1 m")),
                                ("roll: 1.570796327, pitch: 0, yaw: 0}\n  forearm", "roll: 90, pitch: 0, yaw: 0}\n  forearm",
                                 ("arm.yaml:3", "upper_arm.roll", "radians"))):
            with self.subTest(new=new):
                out = self.path / "out.urdf"
                result = snug("calibrate", "kinematics", "--yaml", self.write("arm.yaml", text.replace(old, new)), "-o", out)
                self.assertEqual(result.returncode, 2, result.stdout)
                for part in parts:
                    self.assertIn(part, result.stderr)
                self.assertFalse(out.exists())

    def test_what_cannot_be_used_is_refused(self):
        short = self.write("short.csv", "x,y,z,rx,ry,rz\n0,0,0,0,0,0\n")
        for words, part in ((["kinematics"], "--deltas, --yaml, --poses"),
                            (["kinematics", "--deltas", self.path / "no.conf"], "no.conf"),
                            (["kinematics", "--yaml", short], "kinematics"),
                            (["kinematics", "--poses", short], "column 'q1'"),
                            (["kinematics", "--poses", short, "--end", "tol0"], "tool0"),
                            (["kinematics", "--deltas", short, "--angles", "rpy"], "euler-xyz"),
                            (["tool", short], "4 or more"), (["tool", short, "--flange", "base_link"], "behind the last joint"),
                            (["ft", short], "column 'fx'"), (["ft", short, "--mass", -1], "--mass"),
                            (["ft", short, "--mass", 1200], "kilograms"),
                            (["tool", short, "--tip-in-tool", 0, 0, 341], "--tip-in-tool")):
            with self.subTest(words=words):
                result = snug("calibrate", *words)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertTrue(result.stderr.startswith("snug: error: "), result.stderr)
                self.assertIn(part, result.stderr)


SENSORS = ROOT / "scenarios" / "sensors" / "demonstrator.yaml"


class Measurements(unittest.TestCase):
    """A virtual experiment, its archive, and the run beside it."""
    assert_refused = CommandLine.assert_refused

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = Path(cls.folder.name)
        cls.recording = cls.path / "drop.h5"
        cls.archive = cls.path / "measured.h5"
        cls.truth = cls.path / "truth.json"
        for words in (("simulate", DROP, "--until", 6, "-o", cls.recording),
                      ("measure", cls.recording, "--sensors", SENSORS, "--repetitions", 3, "--seed", 4, "-o",
                       cls.archive, "--truth", cls.truth)):
            result = snug(*words)
            assert result.returncode == 0, result.stderr

    def test_help_of_measuring_has_examples(self):
        for words in (("measure",), ("validate",), ("archive", "list"), ("archive", "check"), ("archive", "convert"),
                      ("archive", "merge")):
            self.assertIn("Example", snug(*words, "--help").stdout, words)

    def test_measuring_again_makes_the_same_bytes_and_another_seed_others(self):
        again, other = self.path / "again.h5", self.path / "other.h5"
        for path, seed in ((again, 4), (other, 5)):
            snug("measure", self.recording, "--sensors", SENSORS, "--repetitions", 3, "--seed", seed, "-o", path)
        self.assertEqual(again.read_bytes(), self.archive.read_bytes())
        self.assertNotEqual(other.read_bytes(), self.archive.read_bytes())

    def test_archive_list_names_repetitions_and_rates(self):
        listed = json.loads(snug("archive", "list", self.archive, "--json").stdout)["recordings"]
        self.assertEqual([one["remarks"]["repetition"] for one in listed], ["1 of 3", "2 of 3", "3 of 3"])
        self.assertAlmostEqual(listed[0]["sources"]["motion_capture"]["rate_Hz"], 360.0, places=3)
        self.assertAlmostEqual(listed[0]["sources"]["force_torque"]["rate_Hz"], 500.0, places=3)
        self.assertIn("tracked", snug("archive", "list", self.archive).stdout)

    def test_archive_check_tells_whole_from_cut(self):
        self.assertEqual(snug("archive", "check", self.archive).returncode, 0)
        cut = self.path / "cut.h5"
        cut.write_bytes(self.archive.read_bytes()[:-5000])
        self.assert_refused(snug("archive", "check", cut), "cut.h5", "truncated")
        self.assert_refused(snug("archive", "check", self.recording), "a recording of a simulation")

    def test_archive_converts_to_tables_and_back(self):
        folder = self.path / "tables"
        written = snug("archive", "convert", self.archive, "-o", folder).stdout.split()
        self.assertEqual(len(written), 9)
        back = self.path / "back.h5"
        result = snug("archive", "convert", written[0], "--name", "Rec_1", "--sequence", "x", "-o", back)
        self.assertEqual(result.returncode, 0, result.stderr)
        one = json.loads(snug("archive", "list", back, "--json").stdout)["recordings"][0]
        self.assertEqual((one["name"], one["remarks"]["sequence"]), ("Rec_1", "x"))

    def test_archive_merge_keeps_recordings_and_refuses_two_of_one_name(self):
        other, merged = self.path / "later.h5", self.path / "merged.h5"
        snug("measure", self.recording, "--sensors", SENSORS, "--date", "20240229T120000Z", "-o", other)
        self.assertEqual(snug("archive", "merge", self.archive, other, "-o", merged).returncode, 0)
        names = [one["name"] for one in json.loads(snug("archive", "list", merged, "--json").stdout)["recordings"]]
        self.assertEqual(len(names), 4)
        self.assertIn("Rec_20240229T120000Z", names)
        before = merged.read_bytes()
        self.assert_refused(snug("archive", "merge", self.archive, self.archive, "-o", merged), "two recordings")
        self.assertEqual(merged.read_bytes(), before)

    def test_validate_finds_the_clocks_and_errors_of_the_sensors(self):
        page, csv, figures = self.path / "v.html", self.path / "v.csv", self.path / "figures"
        result = snug("validate", "--simulated", self.recording, "--measured", self.archive, "-o", page, "--csv", csv,
                      "--svg", figures, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        truth = json.loads(self.truth.read_text())["repetitions"]
        for one, true in zip(found["repetitions"], truth):
            clock = one["clocks"][0]
            expected = true["clocks"]["motion_capture"]
            offset = expected["offset_s"] + 1e-6 * expected["rate_ppm"] * clock["at_s"]
            self.assertAlmostEqual(clock["shift_s"], offset, delta=2e-3)
        self.assertLess(found["means"]["clean"]["rest_position_mm"], 1.5)
        self.assertIn("<table>", page.read_text())
        self.assertNotRegex(page.read_text(), r"""(?:src|href)=["']https?:""")
        self.assertTrue(list(figures.glob("*-poses.svg")))
        self.assertEqual(len(csv.read_text().splitlines()), 1 + 6 * len(found["bodies"]))

    def test_validate_takes_a_log_and_shifts_by_hand(self):
        log = self.path / "drop.csv"
        snug("simulate", DROP, "--until", 6, "--csv", log)
        result = snug("validate", "--simulated", self.recording, "--measured", log, "--shift", "mocap=0", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        self.assertTrue(found["repetitions"][0]["clocks"][0]["by_hand"])
        self.assertLess(found["means"]["clean"]["rms_position_mm"], 1e-6)

    def test_slips_are_refused_and_leave_nothing(self):
        base = ("validate", "--simulated", self.recording, "--measured", self.archive)
        self.assert_refused(snug(*base, "--shift", "mocp=1"), "mocp", "did you mean mocap?")
        self.assert_refused(snug(*base, "--shift", "mocap=fast"), "mocap=fast")
        before = self.archive.read_bytes()
        self.assert_refused(snug(*base, "--csv", self.archive), "the same file as")
        self.assert_refused(snug("measure", self.recording, "--sensors", SENSORS, "-o", self.recording), "the same file as")
        self.assertEqual(self.archive.read_bytes(), before)
        self.assert_refused(snug("validate", "--simulated", self.archive, "--measured", self.archive), "measured.h5")
        sensors, output = self.path / "s.yaml", self.path / "none.h5"
        sensors.write_text("motion_capture:\n  rte: 360\n")
        self.assert_refused(snug("measure", self.recording, "--sensors", sensors, "-o", output), "s.yaml:2", "rate")
        self.assert_refused(snug("measure", self.recording, "--sensors", SENSORS, "--date", "now", "-o", output), "--date")
        self.assertFalse(output.exists())
        self.assertEqual([p.name for p in self.path.iterdir() if ".part" in p.name], [])


class Identify(unittest.TestCase):
    assert_refused = CommandLine.assert_refused

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name)

    def test_help_names_the_parts_and_has_examples(self):
        self.assertIn("stiffness", snug("identify", "--help").stdout)
        for part in ("stiffness", "damping", "pluck", "poses", "release", "scene"):
            self.assertIn("Examples:", snug("identify", part, "--help").stdout)

    @unittest.skipUnless(CUP_DATA.exists(), f"no reference data at {CUP_DATA}")
    def test_stiffness_of_the_reference_poses_is_written_where_a_scenario_takes_it(self):
        block = self.path / "cup.yaml"
        result = snug("identify", "stiffness", CUP_DATA / "identification.json", "-o", block, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        found = json.loads(result.stdout)
        truth = {"k_lat": 2300.0, "k_ax": 5500.0, "k_bend": 5.5, "k_tors": 2.8, "c": -20.0}
        for parameter in found["parameters"]:
            error = abs(parameter["value"] / truth.pop(parameter["name"]) - 1.0)
            self.assertLess(error, 0.10 if parameter["name"] == "c" else 0.03)  # tolerances stated with the data
            self.assertGreater(parameter["standard_error"], 0.0)
            self.assertEqual(parameter["verdict"], "identified")
        self.assertEqual(truth, {})
        self.assertAlmostEqual(found["chi2_per_dof"], 1.0, delta=0.1)
        self.assertAlmostEqual(found["held_back_error"], 1.0, delta=0.1)
        self.assertTrue(found["symmetry"]["supported"])
        scenario = self.path / "scene.yaml"
        scenario.write_text(DROP.read_text() + "\n" + block.read_text())
        self.assertEqual(snug("simulate", scenario, "--until", "0.01", "--json").returncode, 0)
        again = snug("identify", "stiffness", CUP_DATA / "identification.json", "-o", block, "--json")
        self.assertEqual(again.stdout, result.stdout, "the same input must give the same bytes")
        table = snug("identify", "stiffness", CUP_DATA / "identification.json", "--parameters", "21")
        self.assertIn("k_x_ry", table.stdout)

    @unittest.skipUnless(RELEASES.exists(), f"no recorded releases at {RELEASES}")
    def test_what_recorded_releases_say_is_evaluated_as_it_was_fitted(self):
        block = self.path / "release.yaml"
        result = snug("identify", "release", RELEASES, "-o", block, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        found = json.loads(result.stdout)
        self.assertEqual({p["name"] for p in found["parameters"]}, {
            "growth", "shut_stiffness", "open_stiffness", "damping", "pressure_gauge_start", "volume", "valve_delay", "valve_time", "blow_flow",
            "peel_impulse"})
        self.assertLess(found["rms_mm"], 0.6)
        self.assertLess(found["opening_ms_error"], 5.0)
        scenario = self.path / "scene.yaml"
        scenario.write_text(DROP.read_text() + "\n" + block.read_text())
        evaluated = json.loads(snug("identify", "release", RELEASES, "--evaluate", "--scenario", scenario, "--json").stdout)
        self.assertAlmostEqual(evaluated["rms_mm"], found["rms_mm"], delta=0.02)  # the block has four digits

    def test_recordings_of_releases_that_cannot_be_used_are_refused(self):
        record = self.path / "releases.csv"
        record.write_text("mass_kg,rep,t_s,E_z_m,B_z_m\n0.5,1,0.0,0.17,0.12\n")
        result = snug("identify", "release", record)
        self.assertEqual(result.returncode, 2)
        self.assertIn("releases.csv:2", result.stderr)

    def test_another_makes_cup_is_found_from_poses_and_evaluated_as_fitted(self):
        poses, law = ROOT / "scenarios/examples/cup-poses.csv", self.path / "law.yaml"
        found = json.loads(snug("identify", "poses", poses, "-o", law, "--json").stdout)
        self.assertTrue(found["is_explained"])
        self.assertLess(found["normalised_error"], found["linear_error"] / 5)  # noise is 0.6 % of a standard deviation
        evaluated = json.loads(snug("identify", "poses", poses, "--cup", law, "--evaluate", "--json").stdout)
        self.assertLess(evaluated["normalised_error"], found["normalised_error"])
        other = json.loads(snug("identify", "poses", poses, "--cup", ROOT / "scenarios/cups/other-make.yaml", "--evaluate", "--json").stdout)
        self.assertFalse(other["is_explained"], "another cup's law")
        law.write_text(law.read_text().replace("bend_1:", "bent_1:"))
        broken = snug("identify", "poses", poses, "--cup", law, "--evaluate")
        self.assertEqual(broken.returncode, 2)
        self.assertIn("law.bend_1", broken.stderr)

    @unittest.skipUnless(POSES.exists(), f"no poses of a cup at {POSES}")
    def test_the_shipped_law_of_another_make_is_that_of_its_poses(self):
        found = json.loads(snug("identify", "poses", POSES, "--cup", ROOT / "scenarios/cups/other-make.yaml", "--evaluate", "--json").stdout)
        self.assertTrue(found["zero_drifts"])  # docs/decisions/0123
        self.assertLess(found["normalised_error"], 0.5 * found["linear_error"])
        self.assertLess(found["normalised_error"], found["linear_error_drifting_zero"])
        self.assertTrue(found["is_explained"])

    def test_axial_pluck_tells_the_axial_damping_and_a_swing_does_not(self):
        verdicts = {}
        for direction in ("axial", "bend"):
            record = self.path / f"{direction}.json"
            made = snug("identify", "pluck", "--scenario", CELL, "--parcel", "BOX013", "--direction", direction, "-o", record)
            self.assertEqual(made.returncode, 0, made.stderr)
            result = snug("identify", "damping", record, "--json", "-o", self.path / "cup.yaml")
            self.assertEqual(result.returncode, 0, result.stderr)
            found = json.loads(result.stdout)
            self.assertAlmostEqual(found["chi2_per_dof"], 1.0, delta=0.1)
            verdicts[direction] = next(p for p in found["parameters"] if p["name"] == "d_ax")
        self.assertEqual(verdicts["axial"]["verdict"], "identified")
        self.assertNotEqual(verdicts["bend"]["verdict"], "identified")
        self.assertIn("pluck", verdicts["bend"]["record_instead"])

    def test_measurements_that_cannot_be_used_are_refused(self):
        record = {"E_o_S": [0, 0, 0.05], "E_q_S": [1, 0, 0, 0], "wrench_S": [0, 0, -1, 0, 0, 0]}
        def write(name, content):
            (self.path / name).write_text(content)
            return self.path / name
        no_turn = write("no_turn.json", json.dumps({"records": [record, dict(record, E_q_S=[1, 1, 0, 0])]}))
        cut = write("cut.json", json.dumps({"records": [record] * 9})[:-20])
        few = write("few.json", json.dumps({"records": [record] * 2}))
        for words, parts in ((["stiffness", no_turn], ["no_turn.json", "records[1].E_q_S"]),
                             (["stiffness", cut], ["cut.json:1"]), (["stiffness", few], ["4 or more"]),
                             (["stiffness", few, "--method", "complience"], ["did you mean compliance?"]),
                             (["stiffness", few, "--parameters", "7"], ["21"]),
                             (["stiffness", self.path / "none.json"], ["none.json"]),
                             (["damping", few], ["cases"]), (["damping"], ["releases"]),
                             (["pluck", "--parcel", "BOX013", "-o", self.path / "p.json"], ["--scenario"]),
                             (["pluck", "--scenario", CELL, "--parcel", "BOX13", "-o", self.path / "p.json"], ["BOX013"]),
                             (["pluck", "--amplitude", "1", "-o", self.path / "p.json"], ["0.03 m"])):
            with self.subTest(words=words):
                self.assert_refused(snug("identify", *words), *parts)

    TOSSES = ROOT / "scenarios" / "tosses" / "task.yaml"

    def test_scene_is_evaluated_on_recordings_of_the_task_or_on_others(self):
        example = self.TOSSES.parent / "example.csv"
        own = snug("identify", "scene", self.TOSSES, "--evaluate", "--json")
        self.assertEqual((own.returncode, own.stderr), (0, ""))
        error = json.loads(own.stdout)
        # The example is what the task's cube does, seen with noise: what is left is noise of the start.
        self.assertLess(error["position_mm"], 4.0)
        self.assertLess(error["rotation_deg"], 3.0)
        self.assertGreaterEqual(error["right_orientation_percent"], 90.0)
        self.assertGreater(error["cost"], 0.0)
        given = snug("identify", "scene", self.TOSSES, "--recordings", example, "--evaluate", "--json", "--threads", 1)
        self.assertEqual(given.stdout, own.stdout, "the same at any number of threads")
        floor = json.loads(snug("identify", "scene", self.TOSSES, "--floor", "--json").stdout)
        self.assertLess(floor["position_mm"], 4.0)

    FRICTION = 0.21934  # of the task, and of its example
    planted = None

    def small_task(self, low=0.05):
        """Friction and damping alone, in the scenario that the example was simulated with."""
        task, cell = self.path / "task.yaml", self.path / "planted.yaml"
        if Identify.planted is None:
            result = snug("identify", "scene", self.TOSSES, "--local", 1, "--scenario", cell)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            Identify.planted = cell.read_text()
        cell.write_text(Identify.planted)
        text = self.TOSSES.read_text().replace("cube.yaml", str(cell))
        lines = text.replace("[example.csv]", f"[{self.TOSSES.parent / 'example.csv'}]").splitlines()
        kept = [line for line in lines if "{name:" not in line or "name: friction" in line or "name: damping_ratio" in line]
        task.write_text("\n".join(kept).replace(f"value: {self.FRICTION}, bounds: [0.05", f"value: 0.3, bounds: [{low}") + "\n")
        self.assertIn("value: 0.3,", task.read_text())
        return task

    def test_scene_finds_a_planted_friction_and_writes_task_and_scenario(self):
        task, found, scenario, log = self.small_task(), self.path / "found.yaml", self.path / "cell.yaml", self.path / "log.csv"
        words = ("identify", "scene", task, "--local", 60, "--log", log)
        page = self.path / "found.html"
        result = snug(*words, "-o", found, "--scenario", scenario, "--page", page, "--json")
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        fit = json.loads(result.stdout)
        self.assertLess(fit["held_back"]["cost"], fit["held_back_before"]["cost"])
        self.assertIn("held back", page.read_text())
        for key in ("chi2_per_dof", "held_back_error", "cost"):
            self.assertIsInstance(fit[key], float)
        friction = fit["parameters"][0]
        self.assertEqual(set(friction) - {"record_instead"}, {"name", "value", "standard_error", "verdict"})
        self.assertAlmostEqual(friction["value"], self.FRICTION, delta=0.02)
        self.assertEqual([row["name"] for row in fit["sensitivity"]], ["friction", "damping_ratio"])
        again = snug("identify", "scene", found, "--evaluate", "--json")
        self.assertAlmostEqual(json.loads(again.stdout)["cost"], (8 * fit["cost"] + 2 * fit["held_back_error"]) / 10, delta=0.5)
        self.assertEqual(snug("simulate", scenario, "--until", "0.01", "--json").returncode, 0)
        self.assertEqual(snug(*words, "--json").stdout, result.stdout, "the same from its log")
        self.assert_refused(snug("identify", "scene", self.small_task(0.06), "--log", log), "the log of another task")

    def test_scene_tasks_that_cannot_be_used_are_refused(self):
        for old, new, parts in (("- {body: cube", "- {body: cub", ["'cube'"]), ("toss, time", "tos, time", ["column 'tos'"]),
                                ("pairs[0]", "pairs[3]", ["pairs[3]", "'3'"]), ("loss: distance", "loss: far", ["squares"]),
                                ("example.csv", "none.csv", ["none.csv"])):
            with self.subTest(new=new):
                task = self.small_task()
                task.write_text(task.read_text().replace(old, new))
                self.assert_refused(snug("identify", "scene", task, "--evaluate"), *parts)


class OtherCells(unittest.TestCase):
    """Other boxes and other containers: pack, and everything that goes on with what it leaves."""
    assert_refused = CommandLine.assert_refused

    ORDERS = ("order,article,length_mm,width_mm,height_mm,mass_kg,count,upright_only,no_stack,max_load_kg\n"
              "two,cup,120,110,105,0.3,1,1,0,1.0\ntwo,tray,180,150,60,0.5,1,0,1,\nhuge,crate,800,700,650,6,1,0,0,\n")
    QUICK = ("--samples", 0, "--decision-time", 0.02, "--robot", "none")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.orders = self.folder / "orders.csv"
        self.orders.write_text(self.ORDERS)

    def pack(self, *words):
        result = snug("pack", CELL, "--items", self.orders, *self.QUICK, "--json", *words)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_order_is_packed_into_another_container_and_its_program_and_recording_go_on(self):
        program, plan, recording = (self.folder / name for name in ("out.csv", "plan.json", "out.h5"))
        cell = ("--items", self.orders, "--container", "400x300x200")
        packed = self.pack("--container", "400x300x200", "--sequence", "two", "--plant-seed", 0, "--program", program,
                           "--plan", plan, "-o", recording)
        self.assertEqual((packed["planned_boxes"], packed["executed_boxes"]), (2, 2))
        volume = 0.120 * 0.110 * 0.105 + 0.180 * 0.150 * 0.060
        self.assertAlmostEqual(packed["executed_percent"], 100 * volume / (0.4 * 0.3 * 0.2), places=6)
        run = json.loads(snug("simulate", CELL, *cell, "--program", program, "--sequence", "two", "--cup", "phases",
                              "--json").stdout)
        self.assertEqual([box["state"] for box in run["boxes"]], ["packed"] * 2)
        self.assertEqual(snug("simulate", CELL, "--program", program, "--sequence", "two").returncode, 2)
        checked = snug("check", CELL, *cell, "--program", program, "--sequence", "two", "--json")
        found = json.loads(checked.stdout)
        self.assertEqual(checked.returncode, 0 if found["ok"] else 1)
        self.assertEqual(found["ok"], all(one["severity"] != "error" for one in found["findings"]))
        self.assertGreater(found["looks"], 500)  # one each 10 mm of the tool's way, which is metres long
        rows = len(program.read_text().splitlines())
        self.assertTrue(all(1 <= one["row"] <= rows for one in found["findings"]))
        self.assertLess(abs(found["duration_s"] / run["duration_s"] - 1), 0.2)
        self.assertEqual(snug("report", recording, "-o", self.folder / "out.html").returncode, 0)
        for placement in json.loads(plan.read_text())["placements"]:
            for number in placement["position"]:
                self.assertEqual(number, round(number, 6))

    def test_flags_of_an_order_are_kept(self):
        packed = self.pack("--sequence", "two")
        first, second = packed["items"]
        self.assertEqual((first["planned"]["up"], first["planned"]["up_sign"]), ("Z", 1))
        self.assertLess(second["planned"]["position"][2], 0.1, "0.5 kg may stand on the cup, but the floor is free")

    def test_box_that_fits_nowhere_is_a_reason(self):
        packed = self.pack("--sequence", "huge")
        self.assertEqual(packed["planned_boxes"], 0)
        self.assertIn("too big for the container", packed["items"][0]["reason"])
        self.assertEqual(packed["stopped"], "no more items, 1 not packed")

    def test_items_after_one_that_can_never_fit_are_packed(self):
        self.orders.write_text(self.ORDERS.replace("\ntwo,tray", "\ntwo,crate,800,700,650,6,1,0,0,\ntwo,tray"))
        items = self.pack("--sequence", "two")["items"]
        self.assertEqual([item["placed"] for item in items], [True, False, True])
        self.assertIn("too big for the container", items[1]["reason"])

    def test_boxes_with_any_id_are_packed_and_their_program_runs_again(self):
        ids = ["BOX11", "BOX1", "A12B", "crate", "crate_turn"]
        items = self.folder / "items.yaml"
        items.write_text("parcel_types:\n  - {name: cube, size: [0.11, 0.11, 0.1], mass: 0.3}\nparcels:\n"
                         + "".join(f"  - {{id: {id}, type: cube, material: box}}\n" for id in ids)
                         + "sequences:\n  - name: any\n    items:\n"
                         + "".join(f"      - {{parcel: {id}, up: Z}}\n" for id in ids))
        program = self.folder / "any.csv"
        words = (CELL, "--items", items, "--sequence", "any")
        packed = json.loads(snug("pack", *words, *self.QUICK, "--plant-seed", 0, "--program", program, "--json").stdout)
        self.assertEqual(packed["executed_boxes"], len(ids), packed["stopped"])
        for id in ids:
            self.assertRegex(program.read_text(), rf",PrePick\({id}\)(@[0-9.]+)?,")
        run = json.loads(snug("simulate", *words, "--program", program, "--cup", "phases", "--json").stdout)
        self.assertEqual([box["state"] for box in run["boxes"]], ["packed"] * len(ids))
        comma = snug("pack", CELL, "--sequence", "any", "--items", self.write_items("a,b"))
        self.assert_refused(comma, "parcels[0].id", "without commas")

    def write_items(self, id):
        path = self.folder / "one.yaml"
        path.write_text("parcel_types:\n  - {name: cube, size: [0.11, 0.11, 0.1], mass: 0.3}\n"
                        f"parcels:\n  - {{id: '{id}', type: cube, material: box}}\n"
                        f"sequences:\n  - name: any\n    items:\n      - {{parcel: '{id}', up: Z}}\n")
        return path

    def test_other_items_do_not_change_what_is_expected_unless_asked(self):
        words = ("pack", CELL, "--sequence", "1", "--container", "220x240x120", *self.QUICK, "--json")
        plans = []
        for more in ([], ["--items", self.orders], ["--items", self.orders, "--future", "catalogue"]):
            packed = json.loads(snug(*words, *more).stdout)
            plans.append([item.get("planned") for item in packed["items"]])
        self.assertTrue(any(plans[0]))
        self.assertEqual(plans[0], plans[1])
        self.assertEqual(len(plans[2]), len(plans[0]))
        self.assert_refused(snug(*words, "--future", "som"), "--future", "order", "catalogue", "none")

    def test_layers_of_film_are_a_number_or_the_least_that_hold(self):
        words = ("shake", ROOT / "scenarios" / "demo-placements.yaml", "--scenario", CELL, "--profile", "eumos40509",
                 "--level", "0.3", "--film-layers")
        self.assert_refused(snug(*words, 6), "--film-layers", "without --hold film")
        for layers in ("x", "0", "2.5", "41"):
            self.assert_refused(snug(*words, layers, "--hold", "film"), "--film-layers", "1 to 40, or least")
        shaken = json.loads(snug(*words, "least", "--hold", "film", "--json").stdout)
        self.assertTrue(shaken["holds"])
        self.assertEqual(shaken["film_layers"], 1, "walls hold this load")

    def test_without_samples_nothing_is_said_of_samples(self):
        item = self.pack("--sequence", "two")["items"][0]
        self.assertEqual((item["samples"], item["samples_succeeded"], item["predicted"]), (0, None, None))
        table = snug("pack", CELL, "--items", self.orders, "--sequence", "two", *self.QUICK).stdout
        line = next(line for line in table.splitlines() if line.startswith("ITEM000001"))
        self.assertNotIn("%", line)
        self.assertEqual(line.split().count("-"), 2, "neither a success rate nor a force")

    def test_tempo_is_faster_and_says_where_the_seconds_go(self):
        lagged, fast = self.pack("--sequence", "two", "--controller", "lagged"), self.pack("--sequence", "two")
        slower = self.pack("--sequence", "two", "--tempo", 0.5)
        self.assertEqual((lagged["controller"], lagged["tempo"]), ("lagged", None))
        self.assertEqual((fast["controller"], fast["tempo"]), ("fast", 1.0))
        for packed in (lagged, fast, slower):
            self.assertEqual(packed["executed_boxes"], 2, packed["stopped"])
            self.assertAlmostEqual(packed["boxes_per_hour"], 2 * 3600 / packed["duration"], places=6)
            for item in packed["items"]:
                parts = dict(item["seconds"])
                self.assertAlmostEqual(parts.pop("total"), sum(parts.values()), places=4)
                self.assertEqual(set(parts), {"travel", "carry", "regrasp", "insert", "push", "wait"})
                self.assertGreater(item["hold_factor"], 1.0)
            in_items = sum(item["seconds"]["total"] for item in packed["items"])
            self.assertAlmostEqual(packed["seconds"]["total"], in_items, places=4)
            self.assertLess(in_items, packed["duration"], "the way home is nobody's")
        self.assertGreater(fast["boxes_per_hour"], slower["boxes_per_hour"])
        self.assertGreater(slower["boxes_per_hour"], lagged["boxes_per_hour"])

    def test_program_packed_fast_runs_again_fast(self):
        program = self.folder / "fast.csv"
        self.pack("--sequence", "two", "--plant-seed", 0, "--program", program)
        words = (CELL, "--items", self.orders, "--program", program, "--sequence", "two")
        runs = {kind: json.loads(snug("simulate", *words, "--cup", "phases", "--controller", kind, "--json").stdout)
                for kind in ("fast", "lagged")}
        self.assertEqual([box["state"] for box in runs["fast"]["boxes"]], ["packed"] * 2)
        self.assertLess(runs["fast"]["duration_s"], 0.6 * runs["lagged"]["duration_s"])
        checked = json.loads(snug("check", *words, "--controller", "fast", "--json").stdout)
        # Where boxes are pushed in, what is held is inside things by more than `check` allows, with any controller.
        self.assertEqual([one for one in checked["findings"] if not one["waypoint"].startswith("Place")], [],
                         "as fast as the joints allow and no faster")

    def test_program_packed_fast_says_so_and_is_exported_with_its_own_timing(self):
        program = self.folder / "own.csv"
        self.pack("--sequence", "two", "--plant-seed", 0, "--tempo", 0.8, "--program", program)
        self.assertEqual(program.read_text().splitlines()[0], "# tempo: 0.8")
        words = (CELL, "--items", self.orders, "--program", program, "--sequence", "two", "--robot", "ur10", "--json")
        seconds = {more: json.loads(snug("simulate", *words, *more).stdout)["duration_s"]
                   for more in ((), ("--controller", "fast", "--tempo", "0.8"), ("--tempo", "1"), ("--controller", "lagged"))}
        own, said, faster, lagged = seconds.values()
        self.assertEqual(own, said)
        self.assertLess(faster, own)
        self.assertLess(own, 0.7 * lagged)
        checked = json.loads(snug("check", *words[:-3], "--json").stdout)
        self.assertLess(checked["duration_s"], 0.7 * lagged)
        export = ("export", program, "--scenario", CELL, "--items", self.orders, "--sequence", "two", "--format")
        out = self.folder / "own.yaml"
        self.assertEqual(snug(*export, "ros-trajectory", "-o", out).returncode, 0)
        ends = re.findall(r"time_from_start: \{sec: (\d+), nanosec: (\d+)\}", out.read_text().split("\nio:")[0])
        last = int(ends[-1][0]) + 1e-9 * int(ends[-1][1])
        self.assertAlmostEqual(last, own, delta=0.2, msg="until the joints rest")
        self.assertIn(", tempo 0.8", out.read_text())
        script = self.folder / "own.script"
        # Where the arm stops at a wall: said, and nothing is written.
        wall = "  - {name: wall, kind: static, material: workbench, shapes: [{box: [0.02, 0.9, 1.0], pose: {position: [0.1, -0.5, 0.5]}}]}\n"
        cell = self.folder / "cell.yaml"
        cell.write_text(CELL.read_text().replace("bodies:\n", "bodies:\n" + wall, 1)
                        .replace("robots/ur10.urdf", str(CELL.parent / "robots" / "ur10.urdf")))
        result = snug("export", program, "--scenario", cell, *export[4:], "urscript", "-o", script)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("protective stop", result.stderr)
        self.assertFalse(script.exists())
        self.assertEqual(snug(*export, "urscript", "-o", script, "--unchecked").returncode, 0)
        self.assertNotIn("lags", script.read_text())
        stated = float(re.search(r"Simulated: ([0-9.]+) s", script.read_text())[1])
        self.assertAlmostEqual(stated, own, delta=1.0, msg="and the time until the last waypoint counts as reached")
        self.assert_refused(snug(*export, "urscript", "-o", script, "--controller", "lagged", "--tempo", 0.8), "--tempo")
        program.write_text(program.read_text().replace("tempo: 0.8", "tempo: 8"))
        self.assert_refused(snug("simulate", *words), "own.csv:1", "tempo", "0.1 to 1")

    def test_tempo_out_of_range_is_refused(self):
        for tempo in (0.49, 1.01, "nan", "fast"):
            self.assert_refused(snug("pack", CELL, "--sequence", "1", "--tempo", tempo), "--tempo")
        for verb in (("pack", CELL, "--sequence", "1"), ("compare", CELL)):
            self.assert_refused(snug(*verb, "--tempo", 0.8, "--controller", "lagged"), "--tempo", "--controller fast")

    def test_comparison_prints_names_whole(self):
        lines = snug("compare", CELL, "--sequences", "1", "--agents", "margin", *self.QUICK).stdout.splitlines()
        table7 = {"I.AM.": "12 / 74.22", "State of the Art": "5 / 31.60", "Manual Operator": "12 / 74.22"}
        for agent, cell in table7.items():
            line = next(line for line in lines if line.startswith(f"reported, {agent} "))
            self.assertIn(cell, line)
        reported = [line for line in lines if line.startswith("reported")]
        self.assertEqual(len({len(line) for line in reported}), 1, "columns stand below each other")

    def test_comparison_leaves_a_page_with_every_box_and_the_words_that_repeat_each_run(self):
        page = self.folder / "compare.html"
        rows = json.loads(snug("compare", CELL, "--sequences", "1", "--agents", "margin", *self.QUICK, "--json", "-o", page).stdout)["rows"]
        text = page.read_text(encoding="utf-8")
        self.assertEqual(text.count("<polygon"), rows[0]["executed_boxes"])
        words = html.unescape(re.search(r"<code>snug (.*?) -o run.h5</code>", text).group(1))
        packed = json.loads(snug(*shlex.split(words), "--json").stdout)
        self.assertEqual((packed["executed_boxes"], packed["executed_percent"]), (rows[0]["executed_boxes"], rows[0]["executed_percent"]))

    def test_comparison_links_its_page_to_the_runs(self):
        page, runs = self.folder / "compare.html", self.folder / "the runs"
        snug("compare", CELL, "--sequences", "1", "--agents", "margin", "--plants", 2, *self.QUICK, "-o", page, "--runs", runs)
        text = page.read_text(encoding="utf-8")
        self.assertEqual(text.count('class="mean"'), 5 * (1 + 1 + 2), "five measures of one agent, one sequence, two plants")
        links = re.findall(r'<a href="(.*?)">open this run</a>', text)
        self.assertEqual(len(links), 2)
        for link in links:
            report = self.folder / urllib.parse.unquote(link)
            self.assertIn("<script", report.read_text(encoding="utf-8"))
            self.assertTrue(report.with_suffix(".h5").exists())
        (self.folder / "file").write_text("")
        self.assert_refused(snug("compare", CELL, "--sequences", "1", "--agents", "margin", *self.QUICK, "--runs", self.folder / "file"), "--runs")

    def test_the_words_that_repeat_a_random_sequence_draw_it_too(self):
        page = self.folder / "it's random.html"
        words = ("compare", CELL, "--container", "220x220x120", "--random", 2, "--random-seed", 3, "--agents", "margin", *self.QUICK)
        rows = json.loads(snug(*words, "--json", "-o", page).stdout)["rows"]
        text = page.read_text(encoding="utf-8")
        self.assertEqual(text.count('class="mean"'), 5 * (1 + 2), "each in a plant of its own: lines by plant would repeat them")
        codes = re.findall(r"<code>(.*?) -o run.h5</code>", text)
        self.assertEqual(len(codes), 2)
        for row, code in zip(rows, codes):
            packed = json.loads(snug(*shlex.split(html.unescape(code))[1:], "--json").stdout)
            self.assertEqual((packed["sequence"], packed["executed_percent"]), (row["sequence"], row["executed_percent"]))
        drawn = self.folder / "random.yaml"
        snug("items", "sequence", CELL, "--all", "--name", "random", "--sequences", 2, "--seed", 3, "-o", drawn)
        packed = json.loads(snug("pack", CELL, "--items", drawn, "--container", "220x220x120", "--sequence", "random-2", "--agent", "margin",
                                 "--plant-seed", rows[1]["plant_seed"], *self.QUICK, "--json").stdout)
        self.assertEqual(packed["executed_percent"], rows[1]["executed_percent"], "the same as written to a file")
        self.assert_refused(snug("pack", CELL, "--sequence", "1", "--random-seed", 3, *self.QUICK), "a sequence 1")

    def test_nothing_sent_is_nothing_as_planned(self):
        page = self.folder / "none.html"
        words = ("compare", CELL, "--container", "60x60x60", "--sequences", "1", "--agents", "margin", *self.QUICK)
        table = snug(*words, "-o", page).stdout
        self.assertNotIn("100.00 %", table)
        chart = re.search(r"items that end as planned, %</figcaption>(.*?)</figure>", page.read_text(encoding="utf-8"), re.DOTALL).group(1)
        self.assertNotIn("<circle", chart)
        self.assertNotIn("nan", chart)

    def test_container_too_small_for_anything_is_a_reason(self):
        packed = self.pack("--sequence", "two", "--container", "60x60x60")
        self.assertEqual(packed["executed_boxes"], 0)
        for item in packed["items"]:
            self.assertIn("too big for the container", item["reason"])

    def test_pallet_is_packed_within_its_edges(self):
        packed = self.pack("--sequence", "two", "--pallet", "250x200x300")
        self.assertEqual(packed["executed_boxes"], 2)

    def test_containers_that_cannot_be_are_refused(self):
        for words, parts in ((["--container", "1x1x1"], ["--container", "10 to 10000 mm"]),
                             (["--container", "100000x100000x100000"], ["10 to 10000 mm"]),
                             (["--container", "700x400x200"], ["workbench"]),
                             (["--container", "tote9"], ["tote1, tote2"]), (["--pallet", "600"], ["LxW"]),
                             (["--pallet", "600x400", "--container", "tote2"], ["--container"]),
                             (["--samples", 65], ["--samples", "0 to 64"])):
            with self.subTest(words=words):
                self.assert_refused(snug("pack", CELL, "--sequence", "1", *words), *parts)

    def test_load_takes_a_container_as_pack_does(self):
        orders = ROOT / "scenarios" / "orders-example.csv"
        load = lambda *words: snug("load", *words, "--time", 0.1)
        three = load(orders, "--container", 600, 400, 300)
        self.assertEqual(three.returncode, 0, three.stderr)
        for words in ((orders, "--container", "600x400x300"), ("--container", "600x400x300", orders),
                      ("--container", 600, 400, 300, orders)):
            self.assertEqual(load(*words).stdout, three.stdout)
        for sizes in ("600x400", "600x400x300x2", "600xax300"):
            self.assert_refused(load(orders, "--container", sizes), "--container")

    def test_random_sequences_are_compared_with_their_mean(self):
        small = ("--container", "220x220x120")
        words = ("compare", CELL, *small, "--random", 2, "--random-seed", 3, "--agents", "contact-aware", *self.QUICK)
        table, rows = snug(*words), json.loads(snug(*words, "--json").stdout)
        self.assertEqual([row["sequence"] for row in rows["rows"]], ["random-1", "random-2"])
        mean = sum(row["executed_percent"] for row in rows["rows"]) / 2
        self.assertAlmostEqual(rows["means"][0]["executed_percent"], mean, places=9)
        summary = [line for line in table.stdout.splitlines() if line.startswith("contact-aware ")][-1]
        self.assertIn(f" {mean:.2f} ", summary)
        drawn = snug("items", "sequence", CELL, "--all", "--name", "random", "--sequences", 1, "--seed", 3)
        self.assertEqual(drawn.stdout.count("parcel:"), 18)

    def test_nothing_packed_leaves_no_program_and_no_recording_and_says_so(self):
        words = ("pack", CELL, "--items", self.orders, "--sequence", "huge", *self.QUICK)
        self.assertEqual(snug(*words).returncode, 0, "a no is a result")
        for option, name in (("--program", "out.csv"), ("-o", "out.h5")):
            path = self.folder / name
            result = snug(*words, option, path)
            self.assertEqual(result.returncode, 1)
            self.assertIn("no program, no recording", result.stderr)
            self.assertIn("too big for the container", result.stdout)
            self.assertFalse(path.exists())
