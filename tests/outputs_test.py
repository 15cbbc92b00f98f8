#!/usr/bin/env python3
"""outputs_test.py: what the program leaves, and what it must not destroy. SNUG names the program."""
import fcntl
import json
import os
import resource
import shutil
import signal
import stat
import struct
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import cli_test
from cli_test import CELL, DROP, LOAD, ROOT, SENSORS, SNUG, snug

TASK = ROOT / "scenarios" / "tosses" / "task.yaml"
ORDERS = ROOT / "scenarios" / "orders-example.csv"
PLACEMENTS = ROOT / "scenarios" / "demo-placements.yaml"
QUICK = ("--samples", 0, "--decision-time", 0.02, "--robot", "none")
TWO_BOXES = """parcel_types:
  - {name: brick, size: [0.11, 0.12, 0.1], mass: 0.4}
parcels:
  - {id: b1, type: brick, material: box}
  - {id: b2, type: brick, material: box}
sequences:
  - name: two
    items: [{parcel: b1, up: Z}, {parcel: b2, up: X}]
"""
WRITER_BYTE, COMMIT_BYTE = 2**62, 2**62 + 1  # docs/formats.md, "Recordings of running and of killed runs"
FLOCK = "hhqqi"  # struct flock: type, whence, start, length, process


def start(*words, **settings):
    return subprocess.Popen([SNUG, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **settings)


def run(*words, **settings):
    return subprocess.run([SNUG, *map(str, words)], stderr=subprocess.PIPE, text=True, check=False, timeout=1100, **settings)


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def names(self):
        return sorted(entry.name for entry in self.folder.iterdir())

    def make_recording(self, name="run.h5", until=0.3):
        path = self.folder / name
        self.assertEqual(snug("simulate", DROP, "--until", until, "-o", path).returncode, 0)
        return path

    def make_program(self, name="program.csv"):
        path = self.folder / name
        self.assertEqual(snug("program", CELL, PLACEMENTS, "--sequence", "1", "-o", path).returncode, 0)
        return path

    def make_archive(self, recording, name="measured.h5"):
        path = self.folder / name
        self.assertEqual(snug("measure", recording, "--sensors", SENSORS, "-o", path).returncode, 0)
        return path

    def make_swing(self):
        path = self.folder / "swing.json"
        self.assertEqual(snug("identify", "pluck", "--repeat", 1, "-o", path).returncode, 0)
        return path

    def one_box(self):
        path = self.folder / "one.csv"
        path.write_text("order,length_mm,width_mm,height_mm,mass_kg\none,120,110,105,0.3\n")
        return path

    def are_being_written(self, count):
        """Do writers hold the locks of `count` files of the folder? Asked without taking a lock."""
        def is_locked(path):
            try:
                with open(path, "rb") as file:
                    asked = struct.pack(FLOCK, fcntl.F_RDLCK, os.SEEK_SET, WRITER_BYTE, 1, 0)
                    return struct.unpack(FLOCK, fcntl.fcntl(file, fcntl.F_GETLK, asked)[:struct.calcsize(FLOCK)])[0] != fcntl.F_UNLCK
            except FileNotFoundError:
                return False
        return sum(is_locked(path) for path in self.folder.iterdir() if not path.is_symlink()) == count

    def wait_for(self, condition):
        for _ in range(12000):
            if condition():
                return
            time.sleep(0.005)
        self.fail("it did not come to that")


class StandardOutput(Folder):
    def printing_verbs(self):
        (self.folder / "load.jsonl").write_text(json.dumps(LOAD) + "\n")
        (self.folder / "touches.csv").write_text("x,y,z,rx,ry,rz\n")
        program, recording = self.make_program(), self.make_recording("whole.h5", 6)
        archive, swing = self.make_archive(recording), self.make_swing()
        small = ("--items", ORDERS, "--container", "220x220x120", *QUICK)
        return (("--help",), ("--version",), ("manual",), ("completion", "bash"), (), ("simulate", "--help"), ("simulate", DROP, "--until", 0.02),
                ("simulate", DROP, "--until", 0.02, "--json"), ("pack", CELL, "--sequence", "kitchen", *small),
                ("compare", CELL, "--sequences", "kitchen", "--agents", "margin", *small, "--csv"),
                ("program", CELL, PLACEMENTS, "--sequence", "1"), ("items", "reduce", ORDERS),
                ("items", "sequence", CELL), ("items", "sequence", CELL, "--sequences", 200),
                ("load", self.one_box(), "--container", 400, 300, 200, "--time", 0.01),
                ("cup", "settle", self.folder / "load.jsonl"), ("bench", "--only", "s1"),
                ("check", CELL, "--program", program, "--sequence", "1"),
                ("identify", "damping", swing), ("identify", "damping", swing, "--json"),
                ("identify", "scene", TASK, "--evaluate"), ("archive", "list", archive), ("archive", "check", archive),
                ("validate", "--simulated", recording, "--measured", archive))

    def test_full_device_is_exit_1_with_the_reason_in_every_verb(self):
        with open("/dev/full", "w") as full:
            for words in self.printing_verbs():
                with self.subTest(words=words):
                    result = run(*words, stdout=full)
                    self.assertEqual(result.returncode, 1, result.stderr)
                    self.assertEqual(result.stderr.count("standard output: could not be written: No space left on device"), 1)
                    self.assertNotIn("an earlier write failed", result.stderr)

    def test_closed_output_is_exit_1_with_the_reason_in_every_verb(self):
        for words in self.printing_verbs():
            with self.subTest(words=words):
                result = run(*words, preexec_fn=lambda: os.close(1))
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn("standard output: could not be written: Bad file descriptor", result.stderr)

    def test_closed_streams_are_not_mistaken_for_files(self):
        recording, page = self.make_recording(), self.folder / "page.html"
        for streams in ((0,), (1,), (2,), (0, 1, 2)):
            with self.subTest(streams=streams):
                result = run("report", recording, "-o", page, preexec_fn=lambda: [os.close(stream) for stream in streams])
                self.assertEqual(result.returncode, 0)
                self.assertTrue(page.read_text().rstrip().endswith("</html>"))
                page.unlink()

    def test_worse_exit_code_is_kept(self):
        with open("/dev/full", "w") as full:
            self.assertEqual(run("simulate", "none.yaml", stdout=full).returncode, 2)


class WholeFiles(Folder):
    """Every file is written whole or not at all."""

    def writers(self):
        """Words that end with the option whose file they write; all over before a second has passed."""
        recording, program = self.make_recording(), self.make_program()
        whole = self.make_recording("whole.h5", 6)
        archive, swing = self.make_archive(whole), self.make_swing()
        small = ("pack", CELL, "--items", self.one_box(), "--sequence", "one", *QUICK)
        return {"run.html": ("report", recording, "-o"), "run.svg": ("plot", recording, "--what", "speed", "-o"),
                "run.mcap": ("export", recording, "--format", "mcap", "-o"),
                "run.csv": ("export", recording, "--format", "csv", "-o"),
                "run.scene.yaml": ("export", recording, "--format", "moveit-scene", "-o"),
                "arm.script": ("export", program, "--format", "urscript", "--unchecked", "--scenario", CELL, "-o"),
                "direct.csv": ("simulate", DROP, "--until", 0.3, "--csv"), "direct.h5": ("simulate", DROP, "--until", 0.3, "-o"),
                "new.csv": ("program", CELL, PLACEMENTS, "--sequence", "1", "-o"),
                "types.yaml": ("items", "reduce", ORDERS, "-o"), "drawn.yaml": ("items", "sequence", CELL, "-o"),
                "load.json": ("load", self.one_box(), "--container", 400, 300, 200, "--time", 0.01, "--json", "-o"),
                "camera.yaml": ("calibrate", "camera", ROOT / "scenarios" / "examples" / "board.csv", "-o"),
                "cup-fit.yaml": ("identify", "stiffness", ROOT / "scenarios" / "examples" / "poses.json", "-o"),
                "arm.urdf": ("calibrate", "ft", self.readings(), "-o"),
                "page.html": ("validate", "--simulated", whole, "--measured", archive, "-o"),
                "errors.csv": ("validate", "--simulated", whole, "--measured", archive, "--csv"),
                "cup.yaml": ("identify", "damping", swing, "-o"),
                "pluck.json": ("identify", "pluck", "--repeat", 1, "-o"),
                "packed.csv": (*small, "--program"), "packed.json": (*small, "--plan"), "packed.h5": (*small, "-o")}

    def readings(self):
        """Of a force sensor that hangs 1.2 kg, turned."""
        quarter, weight = 1.5707963267948966, 1.2 * 9.81
        rows = [(0, 0, 0, 0, 0, -weight), (2 * quarter, 0, 0, 0, 0, weight), (quarter, 0, 0, 0, -weight, 0),
                (-quarter, 0, 0, 0, weight, 0), (0, quarter, 0, weight, 0, 0), (0, -quarter, 0, -weight, 0, 0)]
        path = self.folder / "readings.csv"
        path.write_text("rx,ry,rz,fx,fy,fz,tx,ty,tz\n" + "".join(
            ",".join(str(v) for v in (*row, -0.1 * row[4], 0.1 * row[3], 0)) + "\n" for row in rows))
        return path

    def test_replaced_files_keep_their_mode_and_links_stay_links(self):
        writers = self.writers()
        (self.folder / "far").mkdir()
        for name, words in writers.items():
            with self.subTest(name=name):
                place = self.folder / "far" / name
                (self.folder / name).symlink_to(Path("far") / name)
                self.assertEqual(snug(*words, self.folder / name).returncode, 0)
                new = place.read_bytes()
                if not name.endswith(".h5"):  # others than recordings are replaced by no recording
                    place.write_text("old")
                place.chmod(0o640)
                self.assertEqual(snug(*words, self.folder / name).returncode, 0)
                self.assertTrue((self.folder / name).is_symlink())
                self.assertEqual(stat.S_IMODE(place.stat().st_mode), 0o640)
                if not name.endswith(".h5"):
                    self.assertEqual(place.read_bytes(), new)
        self.assertEqual(sorted(path.name for path in (self.folder / "far").iterdir()), sorted(writers))

    def test_file_that_grows_too_large_leaves_the_old_one_and_nothing_else(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (200, 200))

        writers, old = self.writers(), self.make_recording("old.h5").read_bytes()
        (self.folder / "out").mkdir()
        for name, words in writers.items():
            with self.subTest(name=name):
                place = self.folder / "out" / name
                place.write_bytes(old)
                result = run(*words, place, stdout=subprocess.PIPE, preexec_fn=limit)
                self.assertEqual(result.returncode, 1, result.stderr)
                self.assertIn(f"{name}: could not be written", result.stderr)
                self.assertIn("File too large", result.stderr)
                self.assertEqual(place.read_bytes(), old)
        self.assertEqual(sorted(path.name for path in (self.folder / "out").iterdir()), sorted(writers))

    def test_full_disk_leaves_the_old_recording(self):
        disk = self.folder / "disk"
        disk.mkdir()
        if os.geteuid() != 0 or subprocess.run(["mount", "-t", "tmpfs", "-o", "size=800k", "tmpfs", disk], check=False,
                                               capture_output=True).returncode != 0:
            self.skipTest("no right to mount a small disk")
        self.addCleanup(subprocess.run, ["umount", disk], check=False)
        recording = disk / "run.h5"
        self.assertEqual(snug("simulate", DROP, "--until", 0.1, "-o", recording).returncode, 0)
        old = recording.read_bytes()
        result = snug("simulate", DROP, "--until", 100000, "-o", recording)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("run.h5: could not be written: ", result.stderr)
        self.assertIn("No space left on device", result.stderr)
        self.assertEqual(recording.read_bytes(), old)
        self.assertEqual([path.name for path in disk.iterdir()], ["run.h5"])

    def test_run_that_is_killed_leaves_the_old_recording(self):
        recording = self.make_recording()
        old = recording.read_bytes()
        process = start("simulate", DROP, "--until", 100000, "-o", recording)
        self.addCleanup(process.communicate)
        draft = self.folder / "run.h5.snug-part"
        self.wait_for(lambda: draft.exists() and draft.stat().st_size > 2_000_000)
        process.kill()
        process.wait()
        self.assertEqual(recording.read_bytes(), old)
        self.assertEqual(snug("report", draft, "-o", self.folder / "part.html").returncode, 0, "what it had done is there")
        self.make_recording()
        self.assertEqual(self.names(), ["part.html", "run.h5"])

    def test_session_that_ends_at_any_instant_leaves_what_it_had_done(self):
        """KILL at many instants, and HUP: the recording opens, program and placements are the beginning of the whole ones, and all say so."""
        items = self.folder / "two.yaml"
        items.write_text(TWO_BOXES)
        pack = ("pack", CELL, "--items", items, "--sequence", "two", *QUICK, "--threads", 1, "--json")
        names = {"--program": "sent.csv", "--plan": "plan.json", "-o": "run.h5"}

        def files(folder):
            folder.mkdir()
            return [word for option, name in names.items() for word in (option, folder / name)]

        began = time.monotonic()
        whole = snug(*pack, *files(self.folder / "whole"))
        took = time.monotonic() - began
        self.assertEqual(whole.returncode, 0, whole.stderr)
        whole_program = (self.folder / "whole" / "sent.csv").read_text()
        placements = json.loads((self.folder / "whole" / "plan.json").read_text())["placements"]
        self.assertEqual(len(placements), 2)
        self.assertNotIn("incomplete", whole_program)
        seen = 0
        for k in range(8):
            folder = self.folder / f"killed{k}"
            process = start(*pack, *files(folder))
            time.sleep((k + 0.5) / 8 * took)
            process.send_signal(signal.SIGHUP if k == 4 else signal.SIGKILL)
            process.communicate()
            for path in folder.glob("*.snug-*"):
                path.unlink()
            if (folder / "sent.csv").exists():
                text = (folder / "sent.csv").read_text()
                first, rest = text.split("\n", 1)
                if k != 4 and text != whole_program:  # the signal may come after the session's end
                    self.assertEqual(first, "# incomplete, the session had not ended")
                    self.assertTrue(whole_program.startswith(rest), k)
                seen += 1
            if (folder / "run.h5").exists():
                page = snug("report", folder / "run.h5", "-o", folder / "run.html")
                self.assertEqual(page.returncode, 0, page.stderr)
                seen += 1
            if (folder / "plan.json").exists():
                plan = json.loads((folder / "plan.json").read_text())
                self.assertEqual(plan["placements"], placements[:len(plan["placements"])])
                is_complete = plan.get("complete", True)
                if k == 4:
                    self.assertTrue(is_complete, "a session that ends in order")
                elif is_complete:
                    self.assertEqual(plan["placements"], placements, "only a session that had ended may say so")
                seen += 1
        self.assertGreater(seen, 6, "of 24: some were killed too early")

    def test_run_that_is_killed_early_leaves_no_empty_file(self):
        for delay in (0.0, 0.02, 0.05, 0.1):
            process = start("simulate", DROP, "--until", 100000, "-o", self.folder / "run.h5")
            time.sleep(delay)
            process.kill()
            process.communicate()
            if (self.folder / "run.h5").exists():
                self.assertEqual(snug("report", self.folder / "run.h5", "-o", self.folder / "run.html").returncode, 0)
                (self.folder / "run.h5").unlink()

    def test_interrupted_runs_leave_no_drafts(self):
        for sent in (signal.SIGINT, signal.SIGTERM):
            recording = self.make_recording()
            old = recording.read_bytes()
            process = start("simulate", DROP, "--until", 100000, "-o", recording, "--csv", self.folder / "run.csv")
            self.addCleanup(process.communicate)
            self.wait_for(lambda: len(self.names()) == 3)
            process.send_signal(sent)
            self.assertEqual(process.wait(timeout=20), -sent)
            self.assertEqual(self.names(), ["run.h5"])
            self.assertEqual(recording.read_bytes(), old)

    def test_what_cannot_be_written_is_refused_before_the_work(self):
        recording, program = self.make_recording(), self.make_program()
        kept = self.folder / "kept.h5"
        kept.write_text("months of work")
        long = ("--sequence", "1", "--decision-time", 60)
        pack = ("pack", CELL, *long)
        for words in ((*pack, "--program"), (*pack, "--plan"), (*pack, "-o"), ("report", recording, "-o"),
                      ("simulate", DROP, "--until", 100000, "-o"), ("simulate", DROP, "--until", 100000, "--csv"),
                      ("simulate", CELL, "--program", program, "--sequence", "1", "-o"),
                      ("view", "--no-open", "--live", DROP, "--until", 100000, "-o"),
                      ("load", ORDERS, "--container", 400, 300, 200, "--time", 60, "-o"),
                      ("picture", recording, "-o")):
            for place in (self.folder / "no" / "such" / "file", "/dev/full", self.folder):
                with self.subTest(words=words, place=place):
                    began = time.monotonic()
                    result = snug(*words, place)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn(str(place), result.stderr)
                    self.assertLess(time.monotonic() - began, 30)
        self.assertEqual(snug(*pack, "-o", kept).returncode, 2)
        self.assertEqual(kept.read_text(), "months of work")
        self.assertEqual(self.names(), ["kept.h5", "program.csv", "run.h5"])

    def test_folder_that_cannot_be_written_into_is_refused_before_the_work(self):
        recording, file, closed = self.make_recording(), self.folder / "file", self.folder / "closed"
        file.write_text("kept")
        closed.mkdir(mode=0o555)
        self.folder.chmod(0o755)
        user = 65534 if os.geteuid() == 0 else None  # root may write everywhere
        for words, word in ((("compare", CELL, "--runs"), "--runs"), (("picture", recording, "--video"), "--video"),
                            (("init", "cell"), "folder")):
            for place in (file, file / "below", closed):
                with self.subTest(words=words, place=place):
                    began = time.monotonic()
                    result = subprocess.run([SNUG, *map(str, words), place], capture_output=True, text=True, check=False,
                                            user=user, cwd="/")
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn(f"{word}: got '{place}'", result.stderr)
                    self.assertLess(time.monotonic() - began, 30)
        self.assertEqual((file.read_text(), list(closed.iterdir())), ("kept", []))


class TwoWriters(Folder):
    def assert_busy(self, *words):
        result = snug(*words)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("another run is writing", result.stderr)

    def test_second_writer_of_a_recording_is_refused_and_the_first_goes_on(self):
        recording = self.folder / "run.h5"
        (self.folder / "link.h5").symlink_to("run.h5")
        first = start("simulate", DROP, "--until", 300, "-o", recording)
        self.addCleanup(first.communicate)
        self.wait_for(lambda: first.poll() is not None or self.are_being_written(1))
        first.send_signal(signal.SIGSTOP)
        for words in (("simulate", DROP, "--until", 1, "-o", recording), ("simulate", DROP, "--until", 1, "-o", self.folder / "link.h5"),
                      ("simulate", DROP, "--until", 1, "--csv", recording)):
            with self.subTest(words=words):
                self.assert_busy(*words)
        first.send_signal(signal.SIGCONT)
        self.assertEqual(first.wait(timeout=1100), 0)
        self.assertEqual(self.names(), ["link.h5", "run.h5"])
        alone = self.folder / "alone.csv", self.folder / "of-two.csv"
        self.assertEqual(snug("simulate", DROP, "--until", 300, "--csv", alone[0]).returncode, 0)
        self.assertEqual(snug("export", recording, "--format", "csv", "-o", alone[1]).returncode, 0)
        self.assertEqual(alone[0].read_bytes(), alone[1].read_bytes())

    def test_all_outputs_of_a_verb_are_taken_from_its_beginning(self):
        outputs = [self.folder / name for name in ("out.csv", "plan.json", "out.h5")]
        words = ("pack", CELL, "--sequence", "1", "--decision-time", 60, "--threads", 1)
        first = start(*words, "--program", outputs[0], "--plan", outputs[1], "-o", outputs[2])
        self.addCleanup(first.communicate)
        self.addCleanup(first.kill)
        self.wait_for(lambda: first.poll() is not None or self.are_being_written(3))
        for option, output in zip(("--program", "--plan", "-o"), outputs):
            with self.subTest(option=option):
                self.assert_busy(*words, option, output)
        self.assert_busy("program", CELL, PLACEMENTS, "--sequence", "1", "-o", outputs[0])
        self.assert_busy("identify", "pluck", "-o", outputs[1])
        self.assert_busy("identify", "scene", TASK, "-o", outputs[1])


class SameFile(Folder):
    def test_files_of_a_study_are_not_replaced_by_what_is_found_in_it(self):
        scene = Path(shutil.copy(DROP, self.folder / "drop.yaml"))
        study, folder, page = self.folder / "study.yaml", self.folder / "rows", self.folder / "page.html"
        study.write_text(f"name: s\nverb: simulate\nscenario: {scene}\noptions: {{--until: 0.02}}\n"
                         "factors:\n  - {option: --dt, values: [0.001, 0.002]}\n")
        self.assertEqual(run("study", study, "--dir", folder).returncode, 0)
        link = self.folder / "link.csv"
        link.symlink_to(folder / "chunk-000000.jsonl")
        kept = {path: path.read_bytes() for path in (scene, study, *folder.iterdir())}
        for verb, output in (("report", folder / "chunk-000000.jsonl"), ("report", folder / "study.yaml"), ("report", scene),
                             ("report", study), ("merge", link)):
            with self.subTest(verb=verb, output=output):
                result = run("study", verb, study, "--dir", folder, "-o", output)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn("the same file as", result.stderr)
                self.assertEqual({path: path.read_bytes() for path in kept}, kept)
        self.assertEqual(run("study", "report", study, "--dir", folder, "-o", page).returncode, 0)

    def test_output_that_is_an_input_is_refused_and_kept(self):
        recording, program = self.make_recording(), self.make_program()
        copies = {name: self.folder / name for name in ("cell.yaml", "orders.csv", "places.yaml", "arm.urdf", "points.csv")}
        for name, source in (("cell.yaml", CELL), ("orders.csv", ORDERS), ("places.yaml", PLACEMENTS),
                             ("arm.urdf", ROOT / "scenarios" / "robots" / "ur10.urdf")):
            shutil.copy(source, copies[name])
        copies["cell.yaml"].write_text(copies["cell.yaml"].read_text().replace("robots/ur10.urdf", str(copies["arm.urdf"])))
        copies["points.csv"].write_text("x,y,z,rx,ry,rz\n")
        cell, orders, places, arm, points = copies.values()
        scene, pusher, mesh = (Path(shutil.copy(ROOT / "scenarios" / name, self.folder)) for name in ("conveyor.yaml", "conveyor-pusher.csv", "conveyor-ramp.obj"))
        before = {path: path.read_bytes() for path in self.folder.iterdir()}
        items = ("--items", orders, "--sequence", "kitchen")
        simulate = ("simulate", cell, "--program", program, "--sequence", "1")
        for words, output in ((("report", recording, "-o"), recording), (("plot", recording, "--what", "speed", "-o"), recording),
                              (("export", recording, "--format", "mcap", "-o"), recording),
                              (("export", recording, "--format", "csv", "-o"), recording),
                              (("export", program, "--format", "urscript", "--scenario", cell, "-o"), program),
                              (("export", program, "--format", "urscript", "--scenario", cell, "-o"), cell),
                              (("export", program, "--format", "urscript", "--scenario", cell, "-o"), arm),
                              (("picture", recording, "-o"), recording),
                              ((*simulate, "--csv"), program), ((*simulate, "--csv"), cell), ((*simulate, "--csv"), arm),
                              ((*simulate, "-o"), program), (("pack", cell, *items, "--program"), cell),
                              (("pack", cell, *items, "--plan"), orders), (("pack", cell, *items, "-o"), orders),
                              (("program", cell, places, "--sequence", "1", "-o"), places),
                              (("program", cell, places, "--sequence", "1", "-o"), cell),
                              (("items", "reduce", orders, "-o"), orders), (("items", "sequence", cell, "-o"), cell),
                              (("load", orders, "--container", 400, 300, 200, "-o"), orders),
                              (("calibrate", "kinematics", "--urdf", arm, "--yaml", places, "-o"), arm),
                              (("calibrate", "kinematics", "--urdf", arm, "--yaml", places, "--write-yaml"), places),
                              (("calibrate", "tool", points, "--urdf", arm, "-o"), points),
                              (("calibrate", "ft", points, "--urdf", arm, "-o"), arm),
                              (("measure", recording, "--sensors", SENSORS, "-o"), recording),
                              (("validate", "--simulated", recording, "--measured", orders, "-o"), recording),
                              (("validate", "--simulated", recording, "--measured", orders, "--csv"), orders),
                              (("report", recording, "--urdf", arm, "-o"), arm), (("plot", recording, "--what", "limits", "--urdf", arm, "-o"), arm),
                              (("picture", recording, "--urdf", arm, "-o"), arm), (("export", recording, "--format", "mcap", "--urdf", arm, "-o"), arm),
                              (("identify", "stiffness", points, "--scenario", cell, "-o"), cell), (("identify", "damping", points, "--scenario", cell, "-o"), cell),
                              (("simulate", scene, "--csv"), pusher), (("simulate", scene, "--csv"), mesh),
                              (("archive", "convert", orders, "-o"), orders), (("archive", "merge", recording, orders, "-o"), recording),
                              (("identify", "stiffness", points, "-o"), points), (("identify", "damping", points, "-o"), points),
                              (("identify", "scene", TASK, "--recordings", points, "--log"), points),
                              (("identify", "scene", TASK, "--recordings", points, "-o"), points),
                              (("view", "--no-open", "--live", cell, "--program", program, "--sequence", "1", "-o"), program)):
            link, hard = self.folder / "link", self.folder / "hard"
            link.symlink_to(output)
            os.link(output, hard)
            for name in (output, self.folder / "." / output.name, link, hard):
                with self.subTest(words=words, name=name):
                    result = snug(*words, name)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn("the same file as", result.stderr)
            link.unlink()
            hard.unlink()
        self.assertEqual({path: path.read_bytes() for path in self.folder.iterdir()}, before)

    def test_draft_that_is_an_input_is_refused_and_kept(self):
        """What a killed run left is read, to go on from it or to look at it, and the run is written to where that one was to be."""
        recording = self.make_recording()
        draft, link = self.folder / "run.h5.snug-part", self.folder / "link.h5"
        shutil.copy(recording, draft)
        link.symlink_to("run.h5")
        old = draft.read_bytes()
        for words in (("simulate", DROP, "--resume", draft, "--until", 1, "-o"), ("report", draft, "-o"), ("plot", draft, "--what", "speed", "-o"),
                      ("export", draft, "--format", "csv", "-o"), ("measure", draft, "--sensors", SENSORS, "-o")):
            for output in (recording, link, self.folder / "." / "run.h5"):
                with self.subTest(words=words, output=output):
                    result = snug(*words, output)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn("whose draft is the same file as", result.stderr)
        self.assertEqual(draft.read_bytes(), old)
        self.assertEqual(recording.read_bytes(), old)

    def test_two_outputs_in_one_file_are_refused(self):
        one, two = self.folder / "one", self.folder / "two"
        two.symlink_to("one")
        pack = ("pack", CELL, "--sequence", "1", "--decision-time", 60)
        for words in (("simulate", DROP, "-o", one, "--csv", one), ("simulate", DROP, "-o", one, "--csv", two),
                      (*pack, "--program", one, "--plan", self.folder / "." / "one"), (*pack, "--plan", one, "-o", one),
                      ("calibrate", "kinematics", "--yaml", PLACEMENTS, "-o", one, "--write-yaml", two)):
            with self.subTest(words=words):
                result = snug(*words)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn("the same file as", result.stderr)
        self.assertEqual(self.names(), ["two"])


class LiveRecording(Folder):
    def live(self, recording):
        process = start("simulate", DROP, "--until", 100000, "-o", recording)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        self.wait_for(recording.exists)
        return process

    def test_recording_is_read_at_any_moment_while_it_is_written(self):
        recording = self.folder / "run.h5"
        self.live(recording)
        for i in range(20):
            result = snug("plot", recording, "--what", "speed", "--to", 0.5, "-o", self.folder / "run.svg")
            self.assertEqual(result.returncode, 0, f"try {i}: {result.stderr}")

    def test_other_programs_copy_it_while_they_hold_the_lock(self):
        recording, copy = self.folder / "run.h5", self.folder / "copy.h5"
        self.live(recording)
        for i in range(10):
            with open(recording, "rb") as file:  # as docs/formats.md tells
                fcntl.lockf(file, fcntl.LOCK_SH, 1, COMMIT_BYTE)
                copy.write_bytes(file.read())
            result = snug("plot", copy, "--what", "speed", "--to", 0.5, "-o", self.folder / "run.svg")
            self.assertEqual(result.returncode, 0, f"try {i}: {result.stderr}")

    def test_live_run_that_is_ended_early_is_marked_interrupted(self):
        recording, mcap = self.folder / "live.h5", self.folder / "live.mcap"
        process = start("view", "--no-open", "--live", DROP, "--until", 1000, "--speed", 2, "-o", recording)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        self.wait_for(recording.exists)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=20), 0)
        self.assertIn("ended early", process.stdout.read())
        self.assertEqual(snug("export", recording, "--format", "mcap", "-o", mcap).returncode, 0)

        def text(value):
            return len(value).to_bytes(4, "little") + value

        self.assertIn(text(b"complete") + text(b"false"), mcap.read_bytes())
        self.assertIn(text(b"interrupted") + text(b"true"), mcap.read_bytes())
        self.assertIn(b'"interrupted": true', mcap.read_bytes())
        self.assertEqual(self.names(), ["live.h5", "live.mcap"])


class ExitCodes(Folder):
    def test_session_whose_way_home_fails_is_exit_1(self):
        cell, program = self.folder / "cell.yaml", self.folder / "out.csv"
        text = CELL.read_text().replace("robots/ur10.urdf", str(CELL.parent / "robots" / "ur10.urdf"))
        # So slow that it would take longer than a run may.
        slow = "max_acceleration: 3.0, max_speed: 1.0e-5, max_turn_speed: 1.5, max_turn_acceleration: 0.5}"
        cell.write_text("\n".join(line[:line.index("max_acc")] + slow if "prefix: home" in line else line
                                  for line in text.splitlines()))
        items = ("--items", self.one_box(), *QUICK, "--controller", "lagged", "--json")  # whose limits these are
        for scenario, code in ((CELL, 0), (cell, 1)):
            with self.subTest(code=code):
                failure = "on the way home: timeout: after 60.0 s toward home" if code else ""
                result = snug("pack", scenario, "--sequence", "one", *items, "--program", program)
                self.assertEqual(result.returncode, code, result.stderr)
                self.assertEqual(json.loads(result.stdout)["executed_boxes"], 1, "it is the way home that fails")
                self.assertEqual(json.loads(result.stdout)["failure"], failure)
                self.assertEqual(result.stderr, f"snug: failed: {failure}\n" if code else "")
                self.assertTrue(program.exists(), "what was done is kept")
                program.unlink()
                result = snug("compare", scenario, "--sequences", "one", "--agents", "margin", *items)
                self.assertEqual(result.returncode, code, result.stderr)
                self.assertEqual(json.loads(result.stdout)["rows"][0]["failure"], failure)
                self.assertEqual("1 of 1 sessions did not finish" in result.stderr, code == 1)

    def test_monte_carlo_with_a_run_that_does_not_reach_its_end_is_exit_1(self):
        program = self.folder / "far.csv"
        words = ("simulate", CELL, "--program", program, "--sequence", "1", "--robot", "ur10", "--monte-carlo", 2, "--json")
        for text, code in ((cli_test.Robot.NEAR, 0), (cli_test.Robot.NEAR + cli_test.Robot.FAR, 1)):
            program.write_text(text)
            result = snug(*words)
            self.assertEqual(result.returncode, code, result.stderr)
            self.assertEqual(json.loads(result.stdout)["failed_runs"], 2 * code)
        self.assertIn("2 of 2 runs did not reach their end", result.stderr)


class Spreadsheets(Folder):
    def assert_harmless(self, table, separator):
        for cell in table.replace("\n", separator).split(separator):
            self.assertNotRegex(cell, r"^[=+@\t\r]|^-(?![0-9.])")

    def test_no_cell_is_a_formula(self):
        scene, table = self.folder / "evil.yaml", self.folder / "evil.csv"
        scene.write_text(DROP.read_text().replace("name: parcel", "name: \"=cmd|' /C calc'!A0\""))
        self.assertEqual(snug("simulate", scene, "--until", 0.1, "--csv", table).returncode, 0)
        self.assertIn(";_cmd|'_/C_calc'!A0_FloatingBase_position_x", table.read_text())
        self.assert_harmless(table.read_text(), ";")
        orders = self.folder / "orders.csv"
        orders.write_text(ORDERS.read_text().replace("kitchen", "@kitchen"))
        table = snug("compare", CELL, "--items", orders, "--sequences", "@kitchen", "--agents", "margin", "--container",
                     "220x220x120", *QUICK, "--csv")
        self.assertEqual(table.returncode, 0, table.stderr)
        self.assert_harmless(table.stdout, ",")
        self.assertIn(",_kitchen,", table.stdout)


if __name__ == "__main__":
    unittest.main()
