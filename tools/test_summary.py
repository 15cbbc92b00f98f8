#!/usr/bin/env python3
"""test_summary.py WHAT STATUS [WHAT STATUS]...: adds up what was checked; STATUS is what each check returned.

WHAT is a JUnit file, RESULTS.xml, of which every case counts, or the name of a check that counts as one. Prints the failed and
the skipped, then `N passed, N failed`; skipped cases count as neither. A run without results, or one that failed for a
reason that no case shows (the build, a crash of the runner), counts as one failure.
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


def count_run(path, status):
    passed, skipped, failed = [], [], []
    if os.path.exists(path):
        try:
            passed, skipped, failed = count(path)
        except ElementTree.ParseError:
            failed = [f"{path}, which is not whole"]
    if not failed and (status != 0 or not passed):
        failed = [f"the build or the run of the tests of {path} (see above)"]
    return passed, skipped, failed


def main(arguments):
    words = arguments[1:]
    if not words or len(words) % 2 != 0:
        print(__doc__, file=sys.stderr)
        return 2
    passed, skipped, failed = [], [], []
    for what, status in zip(words[::2], map(int, words[1::2])):
        if what.endswith(".xml"):
            parts = count_run(what, status)
            passed, skipped, failed = passed + parts[0], skipped + parts[1], failed + parts[2]
        else:
            (failed if status != 0 else passed).append(what)
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
