#!/usr/bin/env python3
"""run_checks_test.py: .ci/run never calls passed what did not run to its end, and ends in time."""
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tools"))
import run_checks  # noqa: E402
from run_checks import Check  # noqa: E402


class Machine:
    """Where each command takes the minutes that are its text."""

    def __init__(self):
        self.now = 0.0

    def run(self, command, seconds):
        self.now += min(60.0 * float(command), seconds)
        return 0 if 60.0 * float(command) <= seconds else None

    def check(self, checks, minutes=40.0, begin=0.0):
        return run_checks.run_checks(checks, minutes, begin, clock=lambda: self.now, run=self.run)


def tests_that_take(minutes):
    return Check("tests", minutes, minutes=10.0)


class RunChecks(unittest.TestCase):
    def test_all_run_when_there_is_time_failed_ones_too(self):
        checks = [Check("format", "exit 3"), Check("tests", "true"), Check("clang", "true", may_be_left_out=True)]
        self.assertEqual(run_checks.run_checks(checks, 1.0, time.time()), (["format", "3", "tests", "0", "clang", "0"], []))

    def test_leaves_out_what_would_end_too_late_and_runs_what_is_shorter(self):
        checks = [tests_that_take("10"), Check("long", "31", minutes=31.0, may_be_left_out=True),
                  Check("short", "30", minutes=30.0, may_be_left_out=True)]
        self.assertEqual(Machine().check(checks), (["tests", "0", "short", "0"], ["long: 31.0 min expected, 30.0 left"]))

    def test_time_that_was_used_before_counts(self):
        checks = [tests_that_take("5"), Check("clang", "8", minutes=8.0, may_be_left_out=True)]
        self.assertEqual(Machine().check(checks, begin=-60.0 * 28)[1], ["clang: 8.0 min expected, 7.0 left"])

    def test_expects_of_a_slow_machine_that_it_stays_slow(self):
        checks = [tests_that_take("25"), Check("clang", "8", minutes=8.0, may_be_left_out=True)]
        self.assertEqual(Machine().check(checks)[1], ["clang: 20.0 min expected, 15.0 left"])

    def test_is_not_hopeful_after_a_compiler_cache(self):
        checks = [tests_that_take("2"), Check("clang", "8", minutes=8.0, may_be_left_out=True)]
        self.assertEqual(Machine().check(checks, minutes=9.0)[1], ["clang: 8.0 min expected, 7.0 left"])

    def test_breaks_off_what_takes_longer_than_expected(self):
        checks = [tests_that_take("10"), Check("clang", "31", minutes=8.0, may_be_left_out=True)]
        machine = Machine()
        self.assertEqual(machine.check(checks), (["tests", "0"], ["clang: broken off after 30.0 min"]))
        self.assertEqual(machine.now, 60.0 * 40)

    def test_tests_that_do_not_end_are_a_failure(self):
        self.assertEqual(Machine().check([tests_that_take("81")]), (["tests, broken off after 80.0 min", "1"], []))

    def test_tests_on_a_slow_machine_end_and_the_others_are_left_out(self):
        checks = [tests_that_take("45"), Check("clang", "1", minutes=1.0, may_be_left_out=True)]
        self.assertEqual(Machine().check(checks), (["tests", "0"], ["clang: 4.5 min expected, 0.0 left"]))

    def test_breaks_off_all_that_a_command_started(self):
        with tempfile.TemporaryDirectory() as folder:
            late = Path(folder) / "late"
            begin = time.monotonic()
            self.assertIsNone(run_checks.run(f"(sleep 1; touch {late}) & wait", 0.2))
            self.assertLess(time.monotonic() - begin, 1.0)
            time.sleep(1.2)
            self.assertFalse(late.exists())

    def test_results_of_an_earlier_run_do_not_count(self):
        with tempfile.TemporaryDirectory() as folder:
            results = Path(folder) / "results.xml"
            results.write_text("<testsuite/>")
            Machine().check([Check("tests", "1", results=str(results))])
            self.assertFalse(results.exists())

    def test_each_that_may_be_left_out_fits_behind_the_others_on_an_idle_machine(self):
        always = sum(check.minutes for check in run_checks.CHECKS if not check.may_be_left_out)
        for check in run_checks.CHECKS:
            if check.may_be_left_out:
                self.assertLess(always + check.minutes, run_checks.MINUTES, check.name)


if __name__ == "__main__":
    unittest.main()
