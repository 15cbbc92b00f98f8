#!/usr/bin/env python3
"""docs_commands_test.py: every command of README, the documents and of --help runs, on files that are shipped or that a command before it has made.

A command that takes long is let run for LONG seconds: it has then read its input and all its words. SNUG_LONG=1 waits for its end.
Commands that are no tests of the program (make, cmake, git, apt, downloads) are left out.
"""
import os
import random
import re
import shlex
import shutil
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True
import build_site  # noqa: E402
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
LONG = 1.0  # s: ten times what reading the largest shipped scenario takes
SNUG_LONG = bool(os.environ.get("SNUG_LONG"))
WAIT = 3600.0 if SNUG_LONG else LONG

# Of these the beginning is enough: minutes of computing, or servers that end with Ctrl-C.
LONG_COMMANDS = re.compile(r"snug (bench|view|ui|compare|study examples|identify (damping|scene .*--local|stiffness .*(21|errors))|picture .*--video|simulate .*--monte-carlo|"
                           r"pack .*--monte-carlo|pack (?!.*(small\.csv|kitchen\.h5|my-cell)))")
# Not commands of snug: shells, other programs, and places of the reader's own machine.
# `--slurm` and `--ray` hand jobs to clusters, which tests of studies have of their own; the rest is not of this program.
LEFT_OUT = re.compile(r"^(make|cmake|git|apt|apt-get|sudo|npm|pip|bash|export|cd|ffmpeg|xacro|bench/|scripts/|SNUG|#)|completion|--slurm|--ray|\\| man |\.\.\./")
PREPARED = ("program.csv", "plan.json", "run.h5", "again.h5", "measured.h5")
MAY_FAIL = re.compile(r"snug (check|bench|perceive|shake|export .*--format (urscript|ros-trajectory))")  # what they say no to is a result (exit code 1)


def commands_of(text, shell_only):
    """Lines that call snug: of ```sh blocks of a document, or anywhere in a help text."""
    lines = re.findall(r"```(?:sh|shell|console)\n(.*?)```", text, re.S) if shell_only else [text]
    for line in "\n".join(lines).replace("\\\n", " ").splitlines():
        line = re.sub(r"(^|\s)#.*", "", line).strip().removeprefix("$ ")
        line = re.sub(r"^build/snug\b", "snug", line)
        if line and not LEFT_OUT.search(line) and line.split()[0] in ("snug", "python3", "mkdir"):
            yield line


def documents():
    yield from sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "src" / "snug").glob("*/README.md"), ROOT / "viewer" / "README.md",
                       ROOT / "scenarios" / "examples" / "README.md"])


def help_of(words):
    return subprocess.run([SNUG, *words, "--help"], capture_output=True, text=True, check=True).stdout


def verbs():
    """Every verb and part of a verb, as words."""
    def parts(words):
        found = re.search(r"^(?:SUBCOMMANDS|Subcommands):\n(.*?)(?:\n\n|\Z)", help_of(words), re.S | re.M)
        return re.findall(r"^  (\w[\w-]*)", found.group(1), re.M) if found else []
    for verb in parts([]):
        yield [verb]
        for part in parts([verb]):
            yield [verb, part]


def free_ur_offset():
    """Of a served UR: below the ports that systems give to clients."""
    for offset in range(100 + os.getpid() % 130 * 10, 2700, 10):
        sockets = [socket.socket() for _ in range(6)]
        try:
            for port, one in enumerate(sockets, start=29999 + offset):
                one.bind(("127.0.0.1", port))
            return offset
        except OSError:
            continue
        finally:
            for one in sockets:
                one.close()
    raise unittest.SkipTest("no five ports are free")


class Commands(unittest.TestCase):
    """A folder as a reader has it who has followed docs/commands.md: the shipped scenarios, a program, two recordings, measurements."""

    server = None
    begun = set()  # long commands that ran: their beginning is the same from every document

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = Path(cls.folder.name)
        for shipped in ("scenarios", "examples"):  # copies: some commands write beside what they read
            shutil.copytree(ROOT / shipped, cls.path / shipped)
        cell = "scenarios/box-demonstrator.yaml"
        simulate = ["simulate", cell, "--program", "program.csv", "--sequence", "1"]
        for words in (["pack", cell, "--sequence", "1", "--plant-seed", "7", "--samples", "0", "--program", "program.csv", "--plan", "plan.json",
                       "--save-belief", "beliefs"],
                      [*simulate, "--robot", "ur10", "-o", "run.h5"], [*simulate, "-o", "again.h5"],
                      ["measure", "run.h5", "--sensors", "scenarios/sensors/demonstrator.yaml", "--repetitions", "2", "-o", "measured.h5"]):
            result = subprocess.run([SNUG, *words], cwd=cls.path, capture_output=True, text=True, check=False)
            assert result.returncode == 0, result.stderr
            if words[0] == "pack":
                cls.keep_items(cls.path / "program.csv", 2)

    @staticmethod
    def keep_items(program, count):
        """The rows of a program's first items: minutes less of every command that reads it."""
        kept, items = [], set()
        for line in program.read_text(encoding="utf-8").splitlines(keepends=True):
            items |= set(re.findall(r"\((\w+)\)", line))
            if len(items) > count:
                break
            kept.append(line)
        program.write_text("".join(kept), encoding="utf-8")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def serve(self, line, folder, environment):
        """A server is there for the commands after it, until the next one or the end of the document."""
        self.stop_server()
        self.server = subprocess.Popen(line, shell=True, cwd=folder, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                                       start_new_session=True)
        for said in self.server.stderr:  # where it listens, or why it does not
            if "://" in said:
                return
        self.fail(f"{line}: ended before it listened")

    def stop_server(self):
        if self.server is not None:
            os.killpg(self.server.pid, 9)
            self.server.communicate()
            self.server = None

    def run_command(self, line, folder):
        environment = {**os.environ, "PATH": f"{Path(SNUG).resolve().parent}:{os.environ['PATH']}"}
        if line.startswith("snug serve"):
            self.serve(line, folder, environment)
            return
        is_long = LONG_COMMANDS.search(line) is not None
        if is_long and not SNUG_LONG:
            if line in self.begun:
                return
            self.begun.add(line)
        if is_long:  # on one core: reading takes no more, and what it would compute until it is ended is thrown away
            line = f"taskset --cpu-list {random.choice(sorted(os.sched_getaffinity(0)))} {line}"
        with subprocess.Popen(line, shell=True, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              start_new_session=True) as process:
            try:
                _, errors = process.communicate(timeout=WAIT if is_long else 600)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, 9)
                process.communicate()
                self.assertTrue(is_long, f"{line}: takes too long for a test: list it among LONG_COMMANDS")
                return
        allowed = (0, 1) if MAY_FAIL.search(line) else (0,)
        self.assertIn(process.returncode, allowed, f"{line}\n{errors}")

    def is_repeated(self, line, later, known):
        """Whether a line is among those that another test runs, and makes nothing that a later one reads."""
        made = [word for word in shlex.split(line)[2:] if not word.startswith("-") and not (self.path / word).exists()]
        read = {word for other in later for word in re.split(r"[\s/]", other)}
        return line in known and read.isdisjoint(made)

    def run_all(self, lines, known=frozenset()):
        lines = list(lines)
        if not SNUG_LONG:
            lines = [line for at, line in enumerate(lines) if not self.is_repeated(line, lines[at + 1:], known)]
        with socket.socket() as any_free:  # tests run side by side, and all documents name the same port
            any_free.bind(("127.0.0.1", 0))
            port = any_free.getsockname()[1]
        lines = [line.replace(":5555", f":{port}") for line in lines]
        offset = free_ur_offset() if any("--ur 127.0.0.1" in line for line in lines) else 0
        lines = [re.sub(r"--ur 127\.0\.0\.1", rf"\g<0> --ur-port-offset {offset}", line) for line in lines]
        lines = [re.sub(r"(ur://|ur check )127\.0\.0\.1", rf"\g<0>:{offset}", line) for line in lines]
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for file in self.path.iterdir():
                (folder / file.name).symlink_to(file)
            for line in lines:
                with self.subTest(command=line):
                    for word in shlex.split(line):  # outputs replace a copy, here only; a command cut short leaves it
                        if (folder / word).is_symlink() and word in PREPARED and re.search(rf"(-o|--record|pack .*--program|--plan) {word}", line):
                            (folder / word).unlink()
                            shutil.copy(self.path / word, folder / word)
                    self.run_command(line, folder)
            self.stop_server()
        return len(lines)

    def test_of_readme_and_documents(self):
        count, known = 0, set()
        for path in documents():
            lines = list(commands_of(path.read_text(encoding="utf-8"), True))
            count += self.run_all(lines, known)
            known |= {line for line in lines if "127.0.0.1" not in line}  # what a server says depends on the one before
        self.assertGreater(count, 20)

    def test_of_help(self):
        text = help_of([])
        known = {line for path in documents() for line in commands_of(path.read_text(encoding="utf-8"), True)}
        lines = list(commands_of(text[text.index("Examples:"):], False))
        self.assertGreater(len(lines), 2)
        self.run_all(lines, known)
        for words in verbs():
            self.run_all((line for line in commands_of(help_of(words), False) if line.split()[1:2] != ["VERB"]), known)


class Help(unittest.TestCase):
    def test_every_verb_that_takes_a_file_shows_an_example(self):
        for words in verbs():
            text = help_of(words)
            if "FILE" in text or "SCENARIO" in text or "DIR" in text:
                self.assertIn("snug " + words[0], text, " ".join(words))


class Site(unittest.TestCase):
    """The pages that tools/build_site.py makes itself."""

    def test_every_verb_stands_with_its_options(self):
        with mock.patch.object(build_site, "SNUG", SNUG):
            page = build_site.options_page()
        for words in verbs():
            self.assertIn(f"# snug {' '.join(words)}\n\n```text\n", page)
        self.assertIn("--plant-seed N=1", page)

    def test_the_gallery_links_the_pages_of_the_demo_that_there_are(self):
        with tempfile.TemporaryDirectory() as name, mock.patch.object(build_site, "DEMO", Path(name)):
            self.assertIn("make demo", build_site.gallery_page())
            (Path(name) / "sequence-3.html").write_text("page", encoding="utf-8")
            self.assertEqual(re.findall(r"gallery/sequence-\d.html", build_site.gallery_page()), ["gallery/sequence-3.html"])
            build_site.copy_gallery(Path(name) / "site")
            self.assertTrue((Path(name) / "site" / "gallery" / "sequence-3.html").exists())

    def test_the_index_lists_what_is_made(self):
        index = (ROOT / "docs" / "index.md").read_text(encoding="utf-8").splitlines()
        self.assertTrue({"options", "gallery"} <= set(index))


class Init(unittest.TestCase):
    """What `snug init` writes runs by the commands that it prints."""

    def begin(self, kind):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        path = Path(folder.name) / "new" / "folder"
        result = subprocess.run([SNUG, "init", kind, path], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        return path, re.findall(r"^(snug .*)$", result.stdout, re.M)

    def run_next(self, path, lines):
        for line in lines:
            words = [SNUG, *shlex.split(line)[1:]]
            result = subprocess.run(words, cwd=path, capture_output=True, text=True, check=False)
            self.assertEqual(result.returncode, 0, f"{line}\n{result.stderr}")
            yield result.stdout

    def test_cell_packs_all_its_boxes(self):
        path, lines = self.begin("cell")
        out = "".join(self.run_next(path, lines))
        self.assertIn("executed           6 boxes", out)
        self.assertTrue((path / "run.html").stat().st_size > 1e5)

    def test_pallet_packs_all_its_boxes(self):
        path, lines = self.begin("pallet")
        self.assertIn("executed           6 boxes", "".join(self.run_next(path, lines)))

    def pack_two(self, kind):
        """Two boxes through the arm, whose file lies beside the cell."""
        path, _ = self.begin(kind)
        (path / "two.csv").write_text("length_mm,width_mm,height_mm,mass_kg,count\n190,140,90,0.8,2\n", encoding="utf-8")
        line = f"snug pack {kind}.yaml --items two.csv --sequence two --samples 0 --decision-time 0.05"
        self.assertIn("executed           2 boxes", "".join(self.run_next(path, [line])))

    def test_ur_packs_through_its_arm(self):
        self.pack_two("ur")

    def test_gantry_packs_through_its_axes(self):
        self.pack_two("gantry")

    def test_scene_runs_and_its_bodies_come_to_rest(self):
        path, lines = self.begin("scene")
        out = "".join(self.run_next(path, lines))
        speeds = [float(row.split()[-1]) for row in re.findall(r"^(?:slider|lower|upper) .*$", out, re.M)]
        self.assertEqual(len(speeds), 3)
        self.assertLess(max(speeds), 0.01)

    def test_does_not_overwrite(self):
        path, _ = self.begin("scene")
        result = subprocess.run([SNUG, "init", "scene", path], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 2)
        self.assertIn("not overwritten", result.stderr)

    def test_unknown_kind_names_the_kinds(self):
        result = subprocess.run([SNUG, "init", "robot", "x"], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 2)
        self.assertIn("cell", result.stderr)


if __name__ == "__main__":
    unittest.main()
