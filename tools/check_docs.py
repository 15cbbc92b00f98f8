#!/usr/bin/env python3
"""check_docs.py [ROOT]: every relative link and picture of the Markdown files leads to a file and, with #, to a heading;
every page of docs/ is in a list of docs/index.md, from which the documentation site is made.

Prints `file:line: what is wrong` and exits with 1. Addresses on the net are not visited.
"""
import os
import re
import sys
from pathlib import Path
from urllib.parse import unquote

LINK = re.compile(r"!?\[[^\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
SKIPPED = {".git", "out", "node_modules"}


def markdown_files(root):
    for folder, folders, names in os.walk(root):
        folders[:] = sorted(name for name in folders if name not in SKIPPED and not re.match(r"build(-|$)", name))
        for name in sorted(names):
            if name.endswith(".md"):
                yield Path(folder) / name


def prose_lines(path):
    """(number, line) outside fenced code, with `code` spans taken out."""
    fenced = False
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield number, re.sub(r"`[^`]*`", "", line)


def anchors(path):
    """The names that GitHub gives to the headings of a file."""
    found = set()
    for line in path.read_text(encoding="utf-8").splitlines():
        heading = re.match(r"#+\s+(.*)", line)
        if heading:
            text = re.sub(r"[^\w\- ]", "", heading.group(1).strip().lower()).replace(" ", "-")
            name, copy = text, 0
            while name in found:
                copy += 1
                name = f"{text}-{copy}"
            found.add(name)
    return found


def pages_not_listed(root):
    """Pages of docs/ that no list (toctree) of its index names: the site cannot be made without them."""
    index = root / "docs" / "index.md"
    if not index.exists():
        return []
    lists = re.findall(r"^```{toctree}\n(.*?)^```", index.read_text(encoding="utf-8"), re.S | re.M)
    entries = [line.strip() for text in lists for line in text.splitlines() if line.strip() and not line.startswith(":")]
    listed = {file.resolve() for entry in entries for file in index.parent.glob(entry + ".md") if not entry.startswith("..")}
    return [f"{path}:1: in no list of docs/index.md" for path in sorted((root / "docs").rglob("*.md")) if path != index and path.resolve() not in listed]


def check(root):
    problems, count = pages_not_listed(root), 0
    for path in markdown_files(root):
        for number, line in prose_lines(path):
            for target in LINK.findall(line):
                if re.match(r"[a-z][a-z0-9+.-]*:", target):
                    continue
                count += 1
                name, _, anchor = target.partition("#")
                file = (path.parent / unquote(name)) if name else path
                if not file.exists():
                    problems.append(f"{path}:{number}: no file '{target}'")
                elif anchor and file.suffix == ".md" and anchor not in anchors(file):
                    problems.append(f"{path}:{number}: no heading '#{anchor}' in {file.name}")
    return problems, count


def main(arguments):
    root = Path(arguments[1]) if len(arguments) > 1 else Path(__file__).resolve().parent.parent
    problems, count = check(root)
    print("\n".join(problems) if problems else f"{count} links lead somewhere")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
