#!/usr/bin/env python3
"""coverage.py BUILD: which lines of src, apps and bench/figures the tests reached, by module, from the counts that gcov reads.

BUILD is a folder built with --coverage in which the tests ran. A line counts as reached when any object that holds it
(a header is in many) ran it. Prints one row for each module, and the ten files with the most lines missed.
"""
import collections
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def reached_lines(build):
    """{file: {line: was reached}} over all objects."""
    lines = collections.defaultdict(dict)
    for notes in sorted(build.rglob("*.gcda")):
        result = subprocess.run(["gcov", "--json-format", "--stdout", notes.resolve()], cwd=build, capture_output=True,
                                text=True, check=True)
        for document in result.stdout.splitlines():
            if not document.startswith("{"):
                continue
            for file in json.loads(document)["files"]:
                path = (build / file["file"]).resolve()
                for line in file["lines"]:
                    number = line["line_number"]
                    lines[path][number] = lines[path].get(number, False) or line["count"] > 0
    return lines


def module_of(path):
    """Name of the module, or None for what is not ours or is a test."""
    try:
        parts = path.relative_to(ROOT).parts
    except ValueError:
        return None
    if "test" in parts:
        return None
    if parts[:2] == ("src", "snug"):
        return parts[2]
    return "/".join(parts[:2]) if parts[:1] == ("apps",) or parts[:2] == ("bench", "figures") else None


def main(arguments):
    lines = {path: found for path, found in reached_lines(Path(arguments[1])).items() if module_of(path)}
    if not lines:
        print("coverage.py: no counts found; build with the preset 'coverage' and run the tests", file=sys.stderr)
        return 1
    modules = collections.defaultdict(lambda: [0, 0])
    for path, found in lines.items():
        for name in (module_of(path), "all"):
            modules[name][0] += sum(found.values())
            modules[name][1] += len(found)
    for name in sorted(modules, key=lambda key: (key == "all", key)):
        reached, total = modules[name]
        print(f"{name:12} {100.0 * reached / total:6.1f} % of {total} lines")
    print("\nmost lines missed:")
    for path in sorted(lines, key=lambda key: sum(lines[key].values()) - len(lines[key]))[:10]:
        found = lines[path]
        print(f"{len(found) - sum(found.values()):6} {path.relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
