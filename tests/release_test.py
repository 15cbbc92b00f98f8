#!/usr/bin/env python3
"""release_test.py: a release is made where version, tag, citation and notes agree, and nowhere else (tools/release.py --check)."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CHANGELOG = "# Changelog\n\n## 1.2.0 (2026-11-28)\n\n- Boxes.\n\n## 1.1.0 (2026-01-01)\n\n- Older.\n"


class Release(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name)
        self.git("init", "--quiet")
        self.commit("1.2.0", "1.2.0", CHANGELOG)

    def git(self, *words):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", "-c", "commit.gpgsign=false", "-C", str(self.path), *words], check=True, capture_output=True)

    def commit(self, version, cited, changelog):
        (self.path / "CMakeLists.txt").write_text(f"project(snug VERSION {version} LANGUAGES C CXX)\n", encoding="utf-8")
        (self.path / "CITATION.cff").write_text(f"cff-version: 1.2.0\nversion: {cited}\n", encoding="utf-8")
        (self.path / "CHANGELOG.md").write_text(changelog, encoding="utf-8")
        self.git("add", "-A")
        self.git("commit", "--quiet", "--allow-empty", "-m", "a")

    def check(self):
        return subprocess.run([sys.executable, ROOT / "tools" / "release.py", "--check", "--root", self.path], capture_output=True, text=True, check=False)

    def refuses(self, *said):
        done = self.check()
        self.assertEqual(done.returncode, 2, done.stdout)
        for words in said:
            self.assertIn(words, done.stderr)

    def test_what_agrees_is_taken(self):
        self.git("tag", "v1.2.0")
        done = self.check()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout, "v1.2.0: version 1.2.0, notes of 2 words\n")

    def test_without_a_tag_there_is_none(self):
        self.refuses("there is no tag v1.2.0")

    def test_a_tag_before_the_version_was_raised_is_named(self):
        self.commit("1.1.0", "1.1.0", CHANGELOG)
        self.git("tag", "v1.2.0")
        self.commit("1.2.0", "1.2.0", CHANGELOG)
        self.refuses("v1.2.0 has version 1.1.0")

    def test_another_version_in_the_citation_is_named(self):
        self.commit("1.2.0", "1.1.0", CHANGELOG)
        self.git("tag", "v1.2.0")
        self.refuses("CITATION.cff: version 1.1.0; expected 1.2.0")

    def test_notes_need_their_day_and_their_version(self):
        self.commit("1.2.0", "1.2.0", CHANGELOG.replace("2026-11-28", "not released yet"))
        self.git("tag", "v1.2.0")
        self.refuses("'not released yet'", "the day of the release")
        self.commit("1.2.0", "1.2.0", CHANGELOG.replace("1.2.0", "1.3.0"))
        self.git("tag", "--force", "v1.2.0")
        self.refuses("the newest section is 1.3.0; expected 1.2.0")

    def test_this_tree_agrees_but_for_its_day(self):
        sys.path.insert(0, str(ROOT / "tools"))
        sys.dont_write_bytecode = True
        import release
        version = release.find(r"^project\(snug VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text(encoding="utf-8"), "CMakeLists.txt")[1]
        self.assertEqual(release.find(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), "CITATION.cff")[1], version)
        changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8").replace("(not released yet)", "(2026-11-28)")
        self.assertGreater(len(release.notes_of(changelog, version).split()), 100)


if __name__ == "__main__":
    unittest.main()
