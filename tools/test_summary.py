#!/usr/bin/env python3
"""test_summary.py RESULTS.xml STATUS: counts test cases of a JUnit file; STATUS is what the test run returned.

Prints the failed and the skipped cases, then `N passed, N failed`; skipped cases count as neither. A run without results
or one that failed for a reason that no case shows (the build, a crash of the runner) counts as one failure.
"""
import os
import sys
import xml.etree.ElementTree as ElementTree


def count(path):
    passed, skipped, failed = [], [], []
    chosen = ("SKIP_REGULAR_EXPRESSION_MATCHED", "SKIP_RETURN_CODE", "Disabled")  # the others could not start
    for case in ElementTree.parse(path).getroot().iter("testcase"):
        status = case.get("status", "")
        if case.find("failure") is not None or case.find("error") is not None or status == "fail":
            failed.append(case.get("name"))
        elif case.find("skipped") is not None or status in ("notrun", "disabled"):
            message = case.find("skipped").get("message", "") if case.find("skipped") is not None else ""
            known = status == "disabled" or any(word in message for word in chosen)
            (skipped if known else failed).append(case.get("name"))
        else:
            passed.append(case.get("name"))
    return passed, skipped, failed


def main(arguments):
    path, status = arguments[1], int(arguments[2])
    passed, skipped, failed = [], [], []
    if os.path.exists(path):
        passed, skipped, failed = count(path)
    if not failed and (status != 0 or not passed):
        failed = ["the build or the run of the tests (see above)"]
    for name in skipped:
        print(f"skipped: {name}")
    for name in failed:
        print(f"FAILED: {name}")
    if skipped:
        print(f"{len(skipped)} skipped")
    print(f"{len(passed)} passed, {len(failed)} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
