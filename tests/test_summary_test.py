#!/usr/bin/env python3
"""test_summary_test.py: the last line of .ci/run must never call a failed run passed."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

TOOL = Path(__file__).resolve().parent.parent / "tools" / "test_summary.py"
PASSED = '<testcase name="good" status="run"/>'
FAILED = '<testcase name="bad" status="fail"><failure message=""/></testcase>'
SKIPPED = '<testcase name="absent" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/></testcase>'
BROKEN = '<testcase name="gone" status="notrun"><skipped message="Unable to find executable"/></testcase>'


class TestSummary(unittest.TestCase):
    def run_on(self, cases, status):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "results.xml"
            if cases is not None:
                path.write_text(f"<testsuite>{cases}</testsuite>")
            result = subprocess.run([sys.executable, TOOL, path, str(status)],
                                    capture_output=True, text=True, check=False)
        return result.returncode, result.stdout.splitlines()[-1]

    def test_counts_passed_cases(self):
        self.assertEqual(self.run_on(PASSED * 2 + SKIPPED, 0), (0, "2 passed, 0 failed"))

    def test_counts_failed_cases(self):
        self.assertEqual(self.run_on(PASSED + FAILED, 2), (1, "1 passed, 1 failed"))

    def test_counts_tests_that_could_not_start_as_failed(self):
        self.assertEqual(self.run_on(PASSED + BROKEN, 2), (1, "1 passed, 1 failed"))

    def test_calls_a_broken_build_a_failure(self):
        self.assertEqual(self.run_on(None, 2), (1, "0 passed, 1 failed"))

    def test_calls_a_run_without_tests_a_failure(self):
        self.assertEqual(self.run_on("", 0), (1, "0 passed, 1 failed"))

    def test_adds_up_several_runs_and_checks(self):
        with tempfile.TemporaryDirectory() as folder:
            first, second = Path(folder) / "a.xml", Path(folder) / "b.xml"
            first.write_text(f"<testsuite>{PASSED}{PASSED}</testsuite>")
            second.write_text(f"<testsuite>{PASSED}{FAILED}</testsuite>")
            result = subprocess.run([sys.executable, TOOL, "format", "0", first, "0", "clang", "2", second, "8"],
                                    capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stdout.splitlines()[-1]), (1, "4 passed, 2 failed"))
        self.assertIn("FAILED: clang", result.stdout)

    def test_calls_a_file_that_is_not_whole_a_failure(self):
        self.assertEqual(self.run_on("<testcase", 0), (1, "0 passed, 1 failed"))

    def test_calls_an_unexplained_exit_code_a_failure(self):
        self.assertEqual(self.run_on(PASSED, 8), (1, "1 passed, 1 failed"))


if __name__ == "__main__":
    unittest.main()
