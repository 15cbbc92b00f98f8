#!/usr/bin/env python3
"""attack_test.py: files and words made to harm. They are refused, shortly and harmlessly, and take little memory and time.

SNUG names the program."""
import json
import os
import resource
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
DROP = ROOT / "scenarios" / "drop.yaml"
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
# Sanitizers take memory of their own; a limit of address space does not go with them.
IS_PLAIN = b"__asan_init" not in Path(SNUG).read_bytes() if Path(SNUG).exists() else True
WAYPOINT = "0.5,0,0.5,0,3.14,0,{},0,0,0,0,0,0\n"


class Answer:
    """What a run of snug came to."""

    def __init__(self, code, stdout, stderr, peak, seconds):
        self.code, self.stdout, self.stderr = code, stdout, stderr
        self.peak = peak  # bytes
        self.seconds = seconds  # of the processor


def snug(*words, stdin=subprocess.DEVNULL):
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        child = subprocess.Popen([SNUG, *[w if isinstance(w, bytes) else str(w) for w in words]], stdin=stdin, stdout=out,
                                 stderr=err)
        _, status, used = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        out.seek(0)
        err.seek(0)
        return Answer(child.returncode, out.read(), err.read(), used.ru_maxrss * 1024, used.ru_utime + used.ru_stime)


class Attack(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def file(self, name, content):
        path = self.folder / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def assert_refused(self, answer, *expected):
        text = answer.stderr.decode()  # fails when it is not UTF-8
        self.assertEqual(answer.code, 2, text)
        self.assertEqual(answer.stdout, b"")
        self.assertTrue(text.startswith("snug: error: ") and text.endswith("\n"), text)
        message = text[len("snug: error: "):-1]
        self.assertLessEqual(len(message), 300)
        self.assertTrue(message.isprintable(), ascii(message))
        for part in expected:
            self.assertIn(part, message)

    def assert_cheap(self, answer, size, seconds=5.0):
        if IS_PLAIN:
            self.assertLessEqual(answer.peak, 20 * size + 100e6)
            self.assertLess(answer.seconds, seconds)


class Memory(Attack):
    """Of any input at most 20 times its size and 100 MB."""

    def check(self, text, *expected, seconds=5.0):
        path = self.file("x.yaml", text)
        answer = snug("simulate", path)
        self.assert_refused(answer, *expected)
        self.assert_cheap(answer, len(text), seconds)

    def test_yaml_aliases_of_aliases_are_counted_as_what_they_stand_for(self):
        text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n"
        for i in range(1, 9):
            text += f"a{i}: &a{i} [" + ", ".join([f"*a{i - 1}"] * 10) + "]\n"
        self.check(text, ":5: ", "more than 100000 values")

    def test_yaml_of_64_kb_with_one_long_alias_is_refused(self):
        self.check("name: &a [" + "x," * 10000 + "x]\nbodies:\n" + "  - *a\n" * 6000, "more than 100000 values")

    def test_yaml_with_an_endless_list_in_brackets_is_refused(self):
        self.check("name: [" + "a," * 1_900_000 + "a]\n", "more than 100000 values")

    def test_yaml_of_many_values_is_refused(self):
        self.check("- a\n" * 120_000, "more than 100000 values")

    def test_yaml_nested_deeply_is_refused(self):
        for piece in ("[", "{", "- ", "? ", "{a: ", "&a [*a, "):
            self.check(piece * 30_000, "x.yaml")

    def test_yaml_that_contains_itself_is_refused(self):
        self.check("name: x\nbodies: &a\n  - *a\n", ":3: ", "contains itself")

    def test_other_readers_of_yaml_count_its_values_too(self):
        text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n" + "".join(f"a{i}: &a{i} [" + ", ".join([f"*a{i - 1}"] * 10) + "]\n" for i in range(1, 9))
        path, recording = self.file("x.yaml", text), self.folder / "run.h5"
        self.assertEqual(snug("simulate", DROP, "--until", "0.1", "-o", recording).code, 0)
        for words in (("study", path), ("identify", "scene", path), ("items", "sequence", CELL, "--types", path), ("program", CELL, path, "--sequence", "1"),
                      ("measure", recording, "--sensors", path, "-o", self.folder / "m.h5"), ("pack", CELL, "--sequence", "1", "--items", path),
                      ("calibrate", "kinematics", "--yaml", path, "-o", self.folder / "o")):
            with self.subTest(words=words[:2]):
                answer = snug(*words)
                self.assert_refused(answer, "more than 100000 values")
                self.assert_cheap(answer, len(text))

    def test_yaml_larger_than_any_scenario_is_refused(self):
        self.check("# " + "x" * 5_000_000 + "\n", "bytes")

    def test_yaml_of_many_bodies_takes_no_minute(self):
        vertices = ", ".join(f"[{5 + 0.1 * (i % 4)}, {0.1 * (i // 4 % 4)}, {0.1 * (i // 16)}]" for i in range(64))
        text = ("materials: [{name: m}]\ncontacts: {pairs: [{between: [m, m], friction: 0.3, restitution: 0}]}\n"
                f"bodies:\n  - {{name: b, kind: static, material: m, hull: &v [{vertices}]}}\n")
        for i in range(300):
            text += f"  - {{name: b{i}, kind: static, material: m, hull: *v, pose: {{position: [0, {i + 1}, 0]}}}}\n"
        for i in range(2500):
            text += f"  - {{name: c{i}, kind: static, material: m, size: [9, 0.1, 0.1], pose: {{position: [0, 0, {i + 1}]}}}}\n"
        path = self.file("x.yaml", text)
        answer = snug("simulate", path, "--until", "0.001")
        self.assertIn(answer.code, (0, 2), answer.stderr)
        self.assert_cheap(answer, len(text), 10.0)

    def test_counts_in_a_small_order_are_bounded(self):
        text = "length_mm,width_mm,height_mm,mass_kg,count\n" + "100,100,100,1,5000\n" * 20
        path = self.file("x.csv", text)
        answer = snug("pack", CELL, "--items", path, "--sequence", "x")
        self.assert_refused(answer, "x.csv:2: ", "more than 3000 boxes")
        self.assert_cheap(answer, len(text))

    def test_as_many_boxes_as_allowed_are_cheap(self):
        text = "length_mm,width_mm,height_mm,mass_kg,count\n" + "".join(f"{100 + i},100,100,1,30\n" for i in range(100))
        path = self.file("x.csv", text)
        answer = snug("pack", CELL, "--items", path, "--sequence", "no such")
        self.assert_refused(answer, "no such")
        self.assert_cheap(answer, len(text))

    def test_thousands_of_articles_without_a_name_take_no_minute(self):
        text = "order,length_mm,width_mm,height_mm,mass_kg\n" + "".join(f"o{i},{100 + i},100,100,1\n" for i in range(2900))
        path = self.file("x.csv", text)
        answer = snug("pack", CELL, "--items", path, "--sequence", "no such")
        self.assert_refused(answer, "no such")
        self.assert_cheap(answer, len(text), 10.0)

    def test_nested_json_is_cheap(self):
        for text in ("[" * 1_000_000, '{"a":' * 300_000, '{"7": {"x": ' + "[[]," * 1_000_000):
            path = self.file("x.json", text)
            answer = snug("items", "reduce", path)
            self.assert_refused(answer, "x.json:1: ")
            self.assert_cheap(answer, len(text))

    def test_nested_json_of_sessions_is_refused(self):
        deep = '{"event": ' + "[" * 300_000 + "]" * 300_000 + "}\n"
        path = self.file("x.jsonl", deep)
        for words in (("pack", CELL, "--sequence", "1", "--resume", path), ("plan", path)):
            answer = snug(*words)
            self.assert_refused(answer, "x.jsonl:1: ", "deep")
            self.assert_cheap(answer, len(deep))
        path = self.file("y.jsonl", '{"event": "item started", "time": 1e999, "item": 0, "because_of": null}\n')
        self.assert_refused(snug("pack", CELL, "--sequence", "1", "--resume", path), "y.jsonl:1: ", "double precision")

    def test_long_programs_and_tables_are_cheap(self):
        for name, text, words in (
                ("x.csv", WAYPOINT.format("a") * 110_000, ("simulate", CELL, "--sequence", "1", "--program")),
                ("x.txt", "100000\n" + "1 1 1 1 1 1 1 1 1 1 1 1 1 1\n" * 60_000, ("load",)),
                ("x.csv", "length_mm,width_mm,height_mm,mass_kg\n" + "1,1,1,1\n" * 120_000, ("items", "reduce"))):
            path = self.file(name, text)
            answer = snug(*words, path)
            self.assert_refused(answer, name)
            self.assert_cheap(answer, len(text))

    def test_urdf_of_many_links_is_cheap(self):
        text = "<robot name='x'>" + "<link name='a'/>" * 200_000 + "</robot>"
        path = self.file("x.urdf", text)
        answer = snug("calibrate", "tool", self.file("t.csv", "x,y,z,rx,ry,rz\n0,0,0,0,0,0\n"), "--urdf", path)
        self.assert_refused(answer, "x.urdf")
        self.assert_cheap(answer, len(text))
        path = self.file("x.urdf", "<robot>" + "<a>" * 200_000)
        self.assert_refused(snug("calibrate", "tool", self.folder / "t.csv", "--urdf", path), "x.urdf")

    def test_deep_json_lines_are_refused(self):
        path = self.file("x.jsonl", '{"R": ' + "[" * 30_000 + "]" * 30_000 + "}\n")
        self.assert_refused(snug("cup", "evaluate", path), "x.jsonl:1: ")
        self.assert_refused(snug("cup", "settle", self.file("y.jsonl", b'\n{"id": "\xe9"}\n')), "y.jsonl:2: ", "UTF-8")

    def test_a_line_of_json_that_does_not_end_is_cheap(self):
        with open("/dev/zero", "rb") as zeros:
            answer = snug("cup", "evaluate", stdin=zeros)
        self.assert_refused(answer, "stdin:1: ", "65536 bytes")
        self.assert_cheap(answer, 0)


class Files(Attack):
    """What is no file, or never ends."""

    def readers(self, path):
        """Every place in which a file may be named, as words."""
        table = self.file("ok.csv", "x,y,z,rx,ry,rz\n0,0,0,0,0,0\n")
        recording, out = self.folder / "ok.h5", self.folder / "out"
        if not recording.exists():
            self.assertEqual(snug("simulate", DROP, "--until", "0.1", "-o", recording).code, 0)
        task, sensors = (ROOT / "scenarios" / name for name in ("tosses/task.yaml", "sensors/demonstrator.yaml"))
        placements = ROOT / "scenarios/demo-placements.yaml"
        return [
            ("simulate", DROP, "--resume", path),
            ("compare", CELL, "--items", str(path) + ".csv"),
            ("study", str(path) + ".yaml"),
            ("serve", path),
            ("control", path),
            ("report", recording, "--urdf", path, "-o", out),
            ("cup", "evaluate", path),
            ("camera", path, "-o", str(out) + ".png"),
            ("camera", recording, "--scenario", path, "-o", str(out) + ".png"),
            ("perceive", str(path) + ".png", "--scenario", CELL, "--expect", placements),
            ("perceive", str(path) + ".ply", "--scenario", CELL, "--expect", placements),
            ("perceive", str(path) + ".h5", "--scenario", CELL, "--expect", placements),
            ("calibrate", "camera", path),
            ("measure", path, "--sensors", sensors, "-o", str(out) + ".h5"),
            ("measure", recording, "--sensors", path, "-o", str(out) + ".h5"),
            ("archive", "check", path),
            ("archive", "convert", str(path) + ".csv", "-o", str(out) + ".h5"),
            ("validate", "--simulated", path, "--measured", str(path) + ".csv"),
            ("validate", "--simulated", recording, "--measured", str(path) + ".csv"),
            ("validate", "--simulated", recording, "--measured", path),
            ("identify", "stiffness", path),
            ("identify", "damping", str(path) + ".csv"),
            ("identify", "scene", path),
            ("identify", "scene", task, "--recordings", path),
            ("identify", "scene", task, "--recordings", str(path) + ".csv"),
            ("identify", "scene", task, "--log", path),
            ("simulate", path),
            ("simulate", CELL, "--sequence", "1", "--program", path),
            ("check", CELL, "--program", path),
            ("pack", path, "--sequence", "1"),
            ("pack", CELL, "--sequence", "1", "--items", str(path) + ".csv"),
            ("pack", CELL, "--sequence", "1", "--items", str(path) + ".json"),
            ("pack", CELL, "--sequence", "1", "--items", str(path) + ".yaml"),
            ("program", CELL, path, "--sequence", "1"),
            ("items", "reduce", str(path) + ".csv"),
            ("items", "sequence", CELL, "--types", str(path) + ".yaml"),
            ("load", str(path) + ".txt"),
            ("export", path, "--format", "csv", "-o", self.folder / "out.csv"),
            ("export", path, "--format", "urscript", "--scenario", CELL, "-o", self.folder / "out.script"),
            ("report", path, "-o", self.folder / "out.html"),
            ("plot", path, "--what", "wrench", "-o", self.folder / "out.svg"),
            ("picture", path, "-o", self.folder / "out.png"),
            ("view", path, "--no-open"),
            ("calibrate", "kinematics", "--deltas", path, "-o", self.folder / "out.urdf"),
            ("calibrate", "kinematics", "--yaml", path, "-o", self.folder / "out.urdf"),
            ("calibrate", "kinematics", "--poses", path, "-o", self.folder / "out.urdf"),
            ("calibrate", "tool", path),
            ("calibrate", "tool", table, "--urdf", path),
            ("calibrate", "ft", path),
        ]

    def check_all(self, make):
        base = self.folder / "thing"
        for ending in ("", ".csv", ".json", ".yaml", ".txt", ".h5", ".png", ".ply"):
            make(Path(str(base) + ending))
        for words in self.readers(base):
            with self.subTest(words=" ".join(map(str, words[:2]))):
                answer = snug(*words)
                self.assert_refused(answer, "thing")
                self.assert_cheap(answer, 0)

    def test_devices_that_never_end_are_refused(self):
        self.check_all(lambda path: path.symlink_to("/dev/zero"))

    def test_pipes_that_nobody_writes_to_are_refused(self):
        self.check_all(os.mkfifo)

    def test_folders_are_refused(self):
        self.check_all(Path.mkdir)

    def test_files_larger_than_any_of_ours_are_refused(self):
        def make(path):
            with open(path, "wb") as file:
                file.truncate(10 << 30)  # takes no room on the disk
        self.check_all(make)


class Text(Attack):
    """Names that are not UTF-8, and words that a terminal would obey."""

    def test_text_that_is_not_utf8_is_refused_with_its_line(self):
        latin = "name: caf\u00e9\n".encode("latin-1")
        cases = [
            (("simulate", self.file("a.yaml", b"# x\n" + latin + DROP.read_bytes())), "a.yaml:2: "),
            (("simulate", CELL, "--sequence", "1", "--program",
              self.file("a.csv", (WAYPOINT.format("a") * 2).encode() + WAYPOINT.format("\u00e9").encode("latin-1"))), "a.csv:3: "),
            (("items", "reduce", self.file("b.csv", b"article,length_mm,width_mm,height_mm,mass_kg\n\xff,1,1,1,1\n")), "b.csv:2: "),
            (("items", "reduce", self.file("b.json", b'{"7":\n{"item_sequence": {"1": {"id": "\xe9"}}}}')), "b.json:2: "),
            (("pack", CELL, "--sequence", "1", "--items", self.file("c.yaml", b"parcel_types:\n  - {name: \xe9}\n")), "c.yaml:2: "),
            (("program", CELL, self.file("p.yaml", b"- {box: \xc3}\n"), "--sequence", "1"), "p.yaml:1: "),
            (("load", self.file("d.txt", b"1\n1 \xff\n")), "d.txt:2: "),
            (("calibrate", "tool", self.file("t.csv", b"x,y,z,rx,ry,rz\n0,0,0,0,0,\xe9\n")), "t.csv:2: "),
            (("calibrate", "kinematics", "--deltas", self.file("d.conf", b"[mounting]\n# \xe9\n"), "-o", self.folder / "o"), "d.conf:2: "),
            (("calibrate", "kinematics", "--yaml", self.file("k.yaml", b"kinematics:\n  \xe9: 1\n"), "-o", self.folder / "o"), "k.yaml:2: "),
            (("calibrate", "tool", self.file("ok.csv", "x,y,z,rx,ry,rz\n"), "--urdf",
              self.file("a.urdf", b"<robot>\n<link name='\xe9'/></robot>")), "a.urdf:2: "),
        ]
        for words, where in cases:
            with self.subTest(where=where):
                self.assert_refused(snug(*words), where, "got the byte 0x", "expected text in UTF-8")

    def test_characters_that_are_none_are_refused_in_a_urdf(self):
        urdf = self.file("a.urdf", "<robot>\n<link name='&#xd800;'/></robot>")
        self.assert_refused(snug("calibrate", "tool", self.file("t.csv", "x,y,z,rx,ry,rz\n0,0,0,0,0,0\n"), "--urdf", urdf), "a.urdf:2: ")

    def test_words_that_are_not_utf8_are_refused_before_anything_is_done(self):
        record = self.folder / "run.h5"
        for words in ((b"simulate", b"caf\xe9.yaml"), (b"simulate", bytes(DROP), b"-o", bytes(record) + b"\xff")):
            self.assert_refused(snug(*words), "command line: word ", "\\x", "expected UTF-8")
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_names_beyond_ascii_are_shown_as_they_are(self):
        path = self.file("caf\u00e9.yaml", "stra\u00dfe: 1\n")
        self.assert_refused(snug("simulate", path), "caf\u00e9.yaml:1: stra\u00dfe", "'stra\u00dfe'")

    def test_control_characters_are_shown_escaped(self):
        cases = [
            (("simulate", self.file("a.yaml", '"a\\e[2Jb\\u202e": 1\n')), "a\\x1b[2Jb\\u202e"),
            (("simulate", self.file("b.yaml", 'name: x\nduration: "\\a\\x9b"\n')), "\\x07\\u009b"),
            (("simulate", CELL, "--sequence", "1", "--program", self.file("a.csv", WAYPOINT.format("a\x1b]0;x\x07"))), "\\x1b]0;x\\x07"),
            (("items", "reduce", self.file("b.csv", "length_mm,\x1b[31m\n")), "\\x1b[31m"),
            (("items", "reduce", self.file("b.json", '{"\\u001b[2J": 1}')), "\\x1b[2J"),
            (("simulate", DROP, "--until", "\x1b[2J\n"), "\\x1b[2J\\n"),
            (("ju\x1bmp",), "ju\\x1bmp"),
            (("simulate", self.folder / "no\nsuch\x1b[2J.yaml"), "no\\nsuch\\x1b[2J.yaml"),
        ]
        for words, shown in cases:
            with self.subTest(shown=shown):
                self.assert_refused(snug(*words), shown)

    def test_messages_are_short_whatever_they_are_about(self):
        long = "x" * 100_000
        cases = [
            ("simulate", self.file("a.yaml", f"{long}: 1\n")),
            ("simulate", self.file("b.yaml", f"duration: {long}\n")),
            ("simulate", CELL, "--sequence", "1", "--program", self.file("a.csv", f"{long},0,0,0,0,0,a,0,0,0,0,0,0\n")),
            ("items", "reduce", self.file("b.csv", f"{long}\n")),
            ("items", "reduce", self.file("b.json", f'{{"{long}": 1}}')),
            ("load", self.file("b.txt", long)),
            ("calibrate", "tool", self.file("t.csv", f"x,y,z,rx,ry,rz\n0,0,0,0,0,{long}\n")),
            ("calibrate", "tool", self.file("u.csv", f"{long}\n")),
            ("calibrate", "kinematics", "--deltas", self.file("d.conf", f"[mounting]\ndelta_d = {long}\n"), "-o", self.folder / "o"),
            ("calibrate", "kinematics", "--yaml", self.file("k.yaml", f"kinematics: {{{long}: 1}}\n"), "-o", self.folder / "o"),
            ("simulate", DROP, "--until", long),
            ("simulate", DROP, "--" + long),
            (long,),
            ("simulate", CELL, "--sequence", long, "--program", self.file("ok.csv", WAYPOINT.format("a"))),
        ]
        for words in cases:
            with self.subTest(words=[str(w)[:20] for w in words]):
                self.assert_refused(snug(*words))

    def test_json_orders_name_the_line_and_what_would_do(self):
        item = '"length/mm": 100, "width/mm": 80,\n "height/mm": 60, "weight/kg": 1'
        cases = [
            ("[]", ":1: ", "expected a JSON object of orders"),
            ('{\n"7": 3}', ":2: 7: ", "got 3; expected an order with an item_sequence"),
            ('{"7": {"x": 1\n}}', ":1: 7: ", "no item_sequence"),
            ('{"7": {"item_sequence": [\n]}}', ":1: 7.item_sequence: ", "got a list"),
            ('{"7": {"item_sequence": {"1": {%s},\n"one": {}}}}' % item, ":3: ", "got 'one'; expected items counted from 1"),
            ('{"7": {"item_sequence": {"1": {%s},\n"1": {}}}}' % item, ":3: 7.item_sequence.1: ", "a second time"),
            ('{"7": {"item_sequence": {\n"1": {%s}}}}' % item.replace("80", "0.5"), ":2: 7.item_sequence.1.width/mm: ",
             "got 0.5; expected a number from 1 to 1e+05"),
            ('{"7": {"item_sequence": {\n"1": {%s}}}}' % item.replace("60", '"60"'), ":3: 7.item_sequence.1.height/mm: ", "got '60'"),
            ('{"7": {"item_sequence": {\n"1": {"length/mm":\n100\n}}}}', ":2: 7.item_sequence.1.width/mm: ", "got nothing"),
            ('{"7": {"item_sequence": {\n"1": {"length/mm":\n0\n}}}}', ":3: 7.item_sequence.1.length/mm: ", "got 0"),
            ('{"7": {"item_sequence": {\n\n"1": {%s,}}}}' % item, ":4: ", "syntax error"),
            ('{"7": {"item_sequence": {\n"1": {%s, "length/mm": 1}}}}' % item, ":3: 7.item_sequence.1.length/mm: ", "a second time"),
            ('{"7": {"item_sequence": {"1": {%s}}},\n"7": {}}' % item, ":3: 7: ", "a second time"),
            ("{}", ":1: ", "no items"),
        ]
        for text, where, what in cases:
            with self.subTest(text=text):
                self.assert_refused(snug("items", "reduce", self.file("x.json", text)), "x.json" + where, what)

    def test_settings_in_a_recording_are_json_whatever_names_are(self):
        scenario = CELL.read_text().replace("name: seq1", 'name: "a\\"b\\\\c"')
        self.assertIn('a\\"b', scenario)
        program = self.folder / "p.csv"
        self.assertEqual(snug("program", CELL, ROOT / "scenarios/demo-placements.yaml", "--sequence", "1", "-o", program).code, 0)
        record = self.folder / "run.h5"
        answer = snug("simulate", self.file("s.yaml", scenario), "--program", program, "--sequence", "1", "--corrections",
                      'a"b\\c', "--until", "0.1", "-o", record)
        self.assertEqual(answer.code, 0, answer.stderr)
        settings = record.read_bytes()
        start = settings.index(b'{"cup":')
        self.assertEqual(json.JSONDecoder().raw_decode(settings[start:].decode("utf-8", "replace"))[0]["corrections"], 'a"b\\c')


class Options(Attack):
    """Everything that is counted has a range, which the message says, and names the option."""

    def test_counts_out_of_range_are_refused_by_the_name_of_the_option(self):
        program = self.file("p.csv", WAYPOINT.format("a"))
        run = ("simulate", CELL, "--sequence", "1", "--program", program)
        pack = ("pack", CELL, "--sequence", "1")
        orders = ROOT / "scenarios" / "orders-example.csv"
        cases = [
            (run, "--monte-carlo", "1 to 10000"),
            (run + ("--monte-carlo", "2"), "--threads", "1 to 256"),
            (pack, "--threads", "1 to 256"),
            (pack, "--samples", "0 to 64"),
            (pack, "--monte-carlo", "1 to 10000"),
            (pack, "--skips", "0 to 1000"),
            (("compare", CELL), "--plants", "1 to 10000"),
            (pack, "--decision-time", "0 to 3600"),
            (("compare", CELL), "--random", "1 to 10000"),
            (("compare", CELL, "--sequences", "1"), "--threads", "1 to 256"),
            (("items", "sequence", CELL), "--sequences", "1 to 1000"),
            (("items", "sequence", CELL), "--repeat", "0 to 1"),
            (("items", "reduce", orders), "--count", "1 to 10000"),
            (("load", orders, "--container", "400", "300", "200"), "--threads", "1 to 256"),
            (("load", orders, "--container", "400", "300", "200"), "--first", "1 to 1000000"),
            (("load", orders, "--container", "400", "300", "200"), "--time", "0 to 86400"),
            (("report", "run.h5", "-o", "x.html"), "--every", "1 to 1000000"),
            (("view", "run.h5"), "--every", "1 to 1000000"),
            (("view", "run.h5"), "--port", "0 to 65535"),
            (("view", "run.h5"), "--speed", "0 to 1000000"),
            (("picture", "run.h5", "--video", "x"), "--fps", "0.001 to 1000"),
            (("picture", "run.h5", "--video", "x"), "--speed", "0.001 to 1000"),
            (("picture", "run.h5", "-o", "x.png"), "--size", "16 to 8192"),
            (("export", "x", "--format", "urscript", "-o", "x"), "--vacuum-output", "0 to 7"),
            (("export", "x", "--format", "urscript", "-o", "x"), "--blow-off-output", "0 to 7"),
            (("export", "x", "--format", "ros-trajectory", "-o", "x"), "--period", "0.001 to 100"),
            (("export", "x", "--format", "urscript", "-o", "x"), "--vacuum-timeout", "0.1 to 600"),
            (("simulate", DROP), "--dt", "1e-06 to 0.1"),
        ]
        for words, option, allowed in cases:
            for value in ("60000000", "-3", "99999999999999999999999", "1e300", "x", "nan", ""):
                with self.subTest(option=option, value=value):
                    self.assert_refused(snug(*words, f"{option}={value}"), option)
            with self.subTest(option=option):
                self.assert_refused(snug(*words, f"{option}=60000000"), option, allowed)

    def test_seeds_of_64_bits_are_taken_and_larger_ones_refused(self):
        words = ("items", "sequence", CELL, "--fill", "30", "--seed")
        self.assertEqual(snug(*words, str(2**64 - 1)).code, 0)
        self.assert_refused(snug(*words, str(2**64)), "--seed")

    def test_as_many_threads_as_allowed_work(self):
        program = self.folder / "p.csv"
        self.assertEqual(snug("program", CELL, ROOT / "scenarios/demo-placements.yaml", "--sequence", "1", "-o", program).code, 0)
        answer = snug("simulate", CELL, "--sequence", "1", "--program", program, "--until", "0.1", "--monte-carlo", "2",
                      "--threads", "256")
        self.assertEqual(answer.code, 0, answer.stderr)


if __name__ == "__main__":
    if hasattr(resource, "RLIMIT_CORE"):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    sys.exit(unittest.main())
