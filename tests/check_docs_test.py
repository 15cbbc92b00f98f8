#!/usr/bin/env python3
"""check_docs_test.py: tools/check_docs.py must notice links that lead nowhere, and only those."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parent.parent / "tools" / "check_docs.py"


class CheckDocs(unittest.TestCase):
    def run_on(self, text):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "a.md").write_text(text)
            (Path(folder) / "b.md").write_text("# A heading: with (marks)\n")
            result = subprocess.run([sys.executable, TOOL, folder], capture_output=True, text=True, check=False)
        return result.returncode, result.stdout

    def test_accepts_links_to_files_and_headings(self):
        status, output = self.run_on("[b](b.md) [h](b.md#a-heading-with-marks) [net](https://example.org/x)\n")
        self.assertEqual((status, output), (0, "2 links lead somewhere\n"))

    def test_refuses_a_missing_file_and_names_the_line(self):
        status, output = self.run_on("fine\n\n![picture](img/none.svg)\n")
        self.assertEqual(status, 1)
        self.assertIn("a.md:3: no file 'img/none.svg'", output)

    def test_refuses_a_missing_heading(self):
        status, output = self.run_on("[h](b.md#other)\n")
        self.assertEqual(status, 1)
        self.assertIn("no heading '#other'", output)

    def test_ignores_links_in_code(self):
        self.assertEqual(self.run_on("`[x](none.md)`\n```\n[y](none.md)\n```\n")[0], 0)

    def test_refuses_a_page_that_the_index_of_the_site_does_not_list(self):
        with tempfile.TemporaryDirectory() as folder:
            docs = Path(folder) / "docs"
            (docs / "theory").mkdir(parents=True)
            for name in ("listed", "forgotten", "theory/contact"):
                (docs / f"{name}.md").write_text("# A page\n")
            (docs / "index.md").write_text("# All\n\n```{toctree}\n:glob:\n\nlisted\ntheory/*\n```\n\nforgotten\n")
            result = subprocess.run([sys.executable, TOOL, folder], capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 1)
        self.assertEqual(result.stdout.splitlines(), [f"{docs}/forgotten.md:1: in no list of docs/index.md"])


if __name__ == "__main__":
    unittest.main()
