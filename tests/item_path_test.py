#!/usr/bin/env python3
"""item_path_test.py: the paths of an item and of a compared session in docs/architecture.md are what the code calls, and never go against an arrow."""
import re
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import check_modules  # noqa: E402

MOST = {"## The path of one item": 40, "## The path of a compared session": 25}  # functions that are passed


def path_of(heading):
    """(depth, function, file) of each line of the list under the heading."""
    text = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    block = text.split(heading, 1)[1].split("```", 2)[1]
    lines = [re.fullmatch(r"( *)(\S+) +(\S+)", line) for line in block.strip("\n").split("\n")]
    return [(len(line[1]) // 2, line[2], line[3]) for line in lines]


def file_of(name):
    return ROOT / name if name.startswith("apps/") else ROOT / "src/snug" / name


def bodies_of(text, function):
    """From each definition of the function to its closing brace; a declaration where it is virtual."""
    owner, _, own = function.rpartition("::")
    qualified = re.escape(function) if owner and f"{function}(" in text else rf"\b{re.escape(own)}"
    for found in re.finditer(rf"^[ ]*[A-Za-z\[][^;{{}}()=]*?[ *&]{qualified}\(|^[ ]*{qualified}\(", text, re.M):
        rest = text[found.end():]
        end = re.search(r"[{;]", rest)
        if end and end[0] == ";":
            if "virtual" in found[0]:
                yield ""
            continue
        indent = re.match(r" *", found[0])[0]
        closing = re.search(rf"^{indent}}}", rest, re.M)
        if closing:
            yield rest[: closing.start()]


def find_faults(path):
    """What the list says and the code does not."""
    checker, faults, callers = check_modules.Checker(ROOT), [], []
    for depth, function, name in path:
        text = file_of(name).read_text(encoding="utf-8")
        if not list(bodies_of(text, function)):
            faults.append(f"{function} is not defined in {name}")
        del callers[depth:]
        if callers:
            caller, caller_file = callers[-1]
            called = re.compile(rf"\b{re.escape(function.rpartition('::')[2])}\(")
            if not any(called.search(body) for body in bodies_of(file_of(caller_file).read_text(encoding="utf-8"), caller)):
                faults.append(f"{caller} does not call {function}")
            above, below = (checker.unit_of_file(file_of(one)).name for one in (caller_file, name))
            if below not in checker.allowed[above]:
                faults.append(f"{caller} in {above} calls up into {below}")
        callers.append((function, name))
    return faults


class ItemPath(unittest.TestCase):
    def test_path_of_an_item_is_what_the_code_calls(self):
        for heading, most in MOST.items():
            with self.subTest(heading):
                path = path_of(heading)
                self.assertEqual(find_faults(path), [])
                self.assertLessEqual(len(path), most)

    def test_a_wrong_path_is_found(self):
        path = path_of("## The path of one item")
        for was, now in [("take_next_item", "plan_elsewhere"), ("Executor::bring", "Executor::fetch")]:
            changed = [(depth, now if function == was else function, name) for depth, function, name in path]
            self.assertNotEqual(find_faults(changed), [], now)
        up = [(0, "Executor::start", "session/executor.cpp"), (1, "run_trial", "study/trial.cpp")]
        self.assertIn("Executor::start in session calls up into study", find_faults(up))


if __name__ == "__main__":
    unittest.main()
