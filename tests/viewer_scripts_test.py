#!/usr/bin/env python3
"""viewer_scripts_test.py: the page is built with the packages that its lock file lists, and waits for them while they are fetched."""
import os
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NPM = """#!/bin/sh
case "$*" in
  *ci*) sleep 2; [ ! -e ../no-network ] || exit 1; mkdir -p node_modules ;;
  *install*) exit 1 ;;
  *build) touch "$SNUG_VIEWER_OUT/page" ;;
esac
"""


class ViewerScripts(unittest.TestCase):
    """A copy of the scripts with an npm that takes two seconds to fetch."""

    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.path = Path(scratch.name)
        for folder in ("scripts", "viewer", "bin", "out"):
            (self.path / folder).mkdir()
        for name in ("install-viewer.sh", "build-viewer.sh"):
            shutil.copy(ROOT / "scripts" / name, self.path / "scripts")
        (self.path / "viewer" / "package-lock.json").write_text("{}\n")
        (self.path / "bin" / "npm").write_text(NPM)
        (self.path / "bin" / "npm").chmod(0o755)

    def run_script(self, name, *words):
        environment = {**os.environ, "PATH": f"{self.path / 'bin'}:{os.environ['PATH']}"}
        said = self.path / "said"  # a file: what goes on in the background would keep a pipe open
        begin = time.monotonic()
        with open(said, "w", encoding="utf-8") as errors:
            status = subprocess.run([self.path / "scripts" / name, *words], env=environment, stdout=errors, stderr=errors, check=False).returncode
        return status, said.read_text(encoding="utf-8"), time.monotonic() - begin

    def test_without_packages_it_says_what_to_do(self):
        status, said, _ = self.run_script("build-viewer.sh", self.path / "out")
        self.assertEqual(status, 1)
        self.assertIn("make setup", said)

    def test_waits_for_packages_that_are_being_fetched(self):
        status, _, seconds = self.run_script("install-viewer.sh", "--background")
        self.assertEqual(status, 0)
        self.assertLess(seconds, 1.9)
        status, said, _ = self.run_script("build-viewer.sh", self.path / "out")
        self.assertEqual(status, 0, said)
        self.assertTrue((self.path / "out" / "page").exists())

    def test_packages_that_cannot_be_fetched_end_the_build(self):
        (self.path / "no-network").touch()
        self.run_script("install-viewer.sh", "--background")
        status, said, _ = self.run_script("build-viewer.sh", self.path / "out")
        self.assertEqual(status, 1)
        self.assertIn("make setup", said)

    def test_packages_of_another_lock_file_are_fetched_anew(self):
        self.assertEqual(self.run_script("install-viewer.sh")[0], 0)
        self.assertEqual(self.run_script("build-viewer.sh", self.path / "out")[0], 0)
        (self.path / "viewer" / "package-lock.json").write_text("{ }\n")
        self.assertEqual(self.run_script("build-viewer.sh", self.path / "out")[0], 1)
        self.assertEqual(self.run_script("install-viewer.sh")[0], 0)
        self.assertEqual(self.run_script("build-viewer.sh", self.path / "out")[0], 0)


if __name__ == "__main__":
    unittest.main()
