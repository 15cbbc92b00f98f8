#!/usr/bin/env python3
"""check_commits.py BASE [PROJECT]: subjects of the commits since BASE have at most 60 characters and name module and effect,
as in "session: plan ahead on a belief snapshot" (CONTRIBUTING.md).

Before the colon stand modules, folders of the project or both, with commas between them. Prints `commit: what is wrong`
and exits with 1."""
import re
import subprocess
import sys
from pathlib import Path

LONGEST = 60
OTHER_NAMES = {"apps", "bench", "build", "cmake", "docs", "examples", "python", "scenarios", "tests", "tools", "viewer"}


def names_of(project):
    """What may stand before the colon: modules, verbs and folders."""
    folders = [*project.glob("src/snug/*/"), *project.glob("apps/*/"), *project.glob("apps/snug/*/")]
    return OTHER_NAMES | {folder.name for folder in folders}


def find_fault(subject, names):
    """What is wrong with a subject, or None."""
    if len(subject) > LONGEST:
        return f"{len(subject)} characters, at most {LONGEST}"
    match = re.fullmatch(r"([a-z0-9_, ]+): (\S.*)", subject)
    if not match:
        return "expected 'module: effect'"
    unknown = [word for word in re.split(r", *", match.group(1)) if word not in names]
    if unknown:
        return f"no module or folder '{unknown[0]}'"
    return "ends with a full stop" if subject.endswith(".") else None


def main(words):
    if not 2 <= len(words) <= 3:
        sys.exit(__doc__.splitlines()[0])
    project = Path(words[2]) if len(words) > 2 else Path(__file__).resolve().parent.parent
    log = subprocess.run(["git", "-C", project, "log", "--no-merges", "--format=%h %s", f"{words[1]}..HEAD"], capture_output=True,
                         text=True, check=False)
    if log.returncode != 0:
        sys.exit(f"check_commits.py: {log.stderr.strip()}")
    names = names_of(project)
    faults = 0
    for line in log.stdout.splitlines():
        commit, _, subject = line.partition(" ")
        fault = find_fault(subject, names)
        if fault:
            faults += 1
            print(f"{commit}: {fault}: {subject}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
