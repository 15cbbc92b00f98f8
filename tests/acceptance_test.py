#!/usr/bin/env python3
"""acceptance_test.py: the table of the demonstrator's programs in docs/trust.md is what tools/acceptance.py prints. SNUG names the program."""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAMS = ROOT.parent / "shared" / "data" / "waypoints"


def accept(folder):
    return subprocess.run([sys.executable, ROOT / "tools" / "acceptance.py", folder], capture_output=True, text=True,
                          check=False, timeout=1100)


def rows(text):
    """{title: ["12 of 12", ..., remark]} of the table's rows."""
    table = re.findall(r"^\| ((?:run on|made for)[^|]*) \|(.*)$", text, re.MULTILINE)
    return {title: [cell.strip() for cell in cells.strip("|").split("|")] for title, cells in table}


class Acceptance(unittest.TestCase):
    def test_table_is_that_of_the_documents(self):
        if not PROGRAMS.is_dir():
            self.skipTest(f"the demonstrator's programs are not at {PROGRAMS}")
        result = accept(PROGRAMS)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        printed = rows(result.stdout)
        self.assertEqual(len(printed), 2)
        self.assertEqual(printed, rows((ROOT / "docs" / "trust.md").read_text()))

    def test_folder_without_programs_is_refused_with_where_they_are(self):
        with tempfile.TemporaryDirectory() as folder:
            result = accept(folder)
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertIn("FSM-Bin-Packing", result.stderr)


if __name__ == "__main__":
    unittest.main()
