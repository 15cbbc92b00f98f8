#!/usr/bin/env python3
"""install_test.py: the installed program and libraries, moved elsewhere, and projects that use them. BUILD is the build folder."""
import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = Path(os.environ.get("BUILD", ROOT / "build"))
CONSUMER = ROOT / "tests" / "consumer"


def run(*words, **more):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, timeout=1100, **more)


class Installed(unittest.TestCase):
    """Installed into one folder, used from another, so that nothing may remember where it was."""

    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        cls.folder = Path(cls.scratch.name)
        first = cls.folder / "first"
        result = run("cmake", "--install", BUILD, "--prefix", first)
        assert result.returncode == 0, result.stderr
        cls.prefix = cls.folder / "moved" / "here"
        cls.prefix.parent.mkdir()
        shutil.move(first, cls.prefix)
        cls.snug = cls.prefix / "bin" / "snug"

    def configure(self, source, *words):
        build = Path(tempfile.mkdtemp(dir=self.folder))
        return build, run("cmake", "-S", source, "-B", build, "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}", *words)

    def make(self, build):
        result = run("cmake", "--build", build)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)

    def test_program_finds_its_scenarios_from_any_folder(self):
        for words in (("simulate", "scenarios/drop.yaml", "--until", "0.01"),
                      ("items", "sequence", "scenarios/box-demonstrator.yaml", "--fill", "50"),
                      ("bench", "--only", "s3")):
            with self.subTest(words=words):
                result = run(self.snug, *words, cwd=self.folder)
                self.assertIn(result.returncode, (0, 1) if words[0] == "bench" else (0,), result.stderr)
                self.assertNotEqual(result.stdout, "")

    def test_file_that_is_neither_here_nor_installed_is_refused_by_the_name_given(self):
        result = run(self.snug, "simulate", "scenarios/none.yaml", cwd=self.folder)
        self.assertEqual(result.returncode, 2)
        self.assertIn("error: scenarios/none.yaml", result.stderr)

    def test_nothing_installed_names_the_folder_of_the_sources(self):
        texts = ((str(ROOT) + "/").encode(), (str(BUILD) + "/").encode())
        for path in sorted(self.prefix.rglob("*")):
            if path.is_file():
                content = path.read_bytes()
                for text in texts:
                    self.assertNotIn(text, content, path)

    def test_manual_and_completion_are_where_shells_and_man_look(self):
        for name in ("share/man/man1/snug.1", "share/bash-completion/completions/snug",
                     "share/zsh/vendor-completions/_snug", "share/fish/vendor_completions.d/snug.fish"):
            self.assertGreater((self.prefix / name).stat().st_size, 1000, name)

    def test_examples_are_built_with_the_installed_libraries(self):
        build, result = self.configure(self.prefix / "share" / "snug" / "examples")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.make(build)
        result = run(build / "example_02_hanging_box")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("stable", result.stdout)

    def test_project_that_asks_for_one_module_gets_it(self):
        build, result = self.configure(CONSUMER, "-DSNUG_COMPONENTS=spatial")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.make(build)
        self.assertEqual(run(build / "consumer").stdout, "1.571\n")

    def test_project_that_asks_for_an_unknown_module_is_told_the_known(self):
        _, result = self.configure(CONSUMER, "-DSNUG_COMPONENTS=spatail")
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("'spatail'", result.stderr)
        self.assertIn("spatial", result.stderr)


class Sources(unittest.TestCase):
    def test_project_that_adds_the_folder_gets_the_module_it_names_and_no_more(self):
        with tempfile.TemporaryDirectory() as folder:
            result = run("cmake", "-S", CONSUMER, "-B", folder, "-G", "Ninja", f"-DSNUG_FOLDER={ROOT}",
                         "-DCMAKE_BUILD_TYPE=Debug",
                         "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=12")  # as a project does that wants it quickly
            self.assertEqual(result.returncode, 0, result.stderr)
            targets = run("cmake", "--build", folder, "--target", "help").stdout
            self.assertNotIn("snug_cell", targets)
            self.assertNotIn("spatial_test", targets)
            self.assertNotIn("snug_geometry", targets)
            result = run("cmake", "--build", folder)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertEqual(run(Path(folder) / "consumer").stdout, "1.571\n")


if __name__ == "__main__":
    unittest.main()
