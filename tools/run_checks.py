#!/usr/bin/env python3
"""run_checks.py [BEGIN]: runs what is checked before a change is taken; the last line is `N passed, N failed`.

BEGIN, a time in seconds as `date +%s` tells it, is when the time that it has began; without, now.

A check that fails does not keep the others from running. Those with an expected duration run when they should end in time:
that duration, times how much longer than usual the ones before took. What is left out, or broken off because time ran out, is
named and counts neither as passed nor as failed. Those without have twice the time: where the machine is slow they tell more when they end.
"""
import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import test_summary

MINUTES = 38.0  # of 40: the rest is for what ends a check that is broken off, and for the summary


@dataclass(frozen=True)
class Check:
    name: str
    command: str
    results: str = ""  # JUnit file that the command writes; without, the check counts as one
    minutes: float = 0.0  # on two idle cores without compiler cache
    may_be_left_out: bool = False


CHECKS = (
    Check("format", "make format-check"),
    Check("tests", "make test", results="build/test-results.xml", minutes=17.0),
    Check("headers", "make headers", minutes=1.0, may_be_left_out=True),
    Check("clang", "make clang", minutes=12.5, may_be_left_out=True),
    Check("sanitizers", "make san-fast", results="build-sanitize/test-results.xml", minutes=10.0, may_be_left_out=True),
)


def run(command, seconds):
    """The exit code of a shell's command; None when it was broken off after these seconds."""
    process = subprocess.Popen(command, shell=True, start_new_session=True)
    try:
        return process.wait(timeout=max(0.0, seconds))
    except subprocess.TimeoutExpired:
        return None
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)  # and all that it started
            process.wait()


def run_checks(checks, minutes, begin, clock=time.time, run=run):
    """Words for test_summary.py, and the checks that were not run to their end."""
    words, not_run, usual, actual = [], [], 0.0, 0.0
    for check in checks:
        taken = (clock() - begin) / 60.0
        slowness = max(1.0, actual / usual) if usual > 0.0 else 1.0
        if check.may_be_left_out and taken + slowness * check.minutes > minutes:
            not_run.append(f"{check.name}: {slowness * check.minutes:.1f} min expected, {max(0.0, minutes - taken):.1f} left")
            continue
        if check.results:
            Path(check.results).unlink(missing_ok=True)
        print(f"run_checks.py: {check.name} ({check.command})", flush=True)
        until = 60.0 * minutes * (1.0 if check.may_be_left_out else 2.0)
        status = run(check.command, until - (clock() - begin))
        now = (clock() - begin) / 60.0
        print(f"run_checks.py: {check.name} took {now - taken:.1f} min", flush=True)
        if status is not None:
            words += [check.results or check.name, str(status)]
        elif check.may_be_left_out:
            not_run.append(f"{check.name}: broken off after {now - taken:.1f} min")
        else:
            words += [f"{check.name}, broken off after {now - taken:.1f} min", "1"]
        if check.minutes > 0.0:
            usual, actual = usual + check.minutes, actual + now - taken
    return words, not_run


def main(words):
    if len(words) > 2 or not all(word.isdigit() for word in words[1:]):
        print(__doc__, file=sys.stderr)
        return 2
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # so that nothing is left running
    os.chdir(Path(__file__).resolve().parent.parent)
    words, not_run = run_checks(CHECKS, MINUTES, float(words[1]) if len(words) > 1 else time.time())
    for line in not_run:
        print(f"not run for lack of time: {line}")
    return test_summary.main(["", *words])


if __name__ == "__main__":
    sys.exit(main(sys.argv))
