#!/usr/bin/env python3
"""figures.py: makes the numbers that README and the documents state, and writes them where they stand: between `<!-- figures: NAME -->` and
`<!-- end -->`.

  figures.py                 all of them: hours on two cores; a second call goes on where one was ended
  figures.py NAME ...        these
  figures.py --quick         those that take seconds
  figures.py --list          their names, what each is, and the documents that state it
  figures.py --check NAME    nothing is written: exit code 1 where a document says something else

The same commit gives the same text on every machine; beneath each table stands the commit that last changed the program, and what it was made on. Times are measured: a table with
times is written again where something else in it changed, or a time by more than a factor of 1.5. Tables from data of others need these (--data, --programs)."""
import argparse
import re
import sys
from pathlib import Path

from figure_makers import identification, packing, physics, ur
from figure_makers.common import ROOT, CannotMake, Timed

MAKERS = {**packing.MAKERS, **physics.MAKERS, **identification.MAKERS, **ur.MAKERS}
QUICK = ("cup", "turning", "calibration", "identification", "releases", "tosses", "durations", "first-run")  # seconds each, and no times in them
BLOCK = re.compile(r"(<!-- figures: ([\w-]+) -->)(.*?)(<!-- end -->)", re.S)
TIME = re.compile(r"\d+(?:\.\d+)?(?= (?:us|ms|s)\b)")
SAME_TIME = 1.5  # a factor: neighbours of a virtual machine cost as much


def documents():
    """README, the pages of docs/ but the records of decisions, and the modules' own."""
    pages = [path for pattern in ("docs/*.md", "docs/theory/*.md", "docs/cookbook/*.md", "src/snug/*/README.md", "bench/README.md") for path in ROOT.glob(pattern)]
    return [ROOT / "README.md", *sorted(pages)]


def without_origin(text):
    return re.sub(r"; commit \S+ .*?\(`make figures`\)", "", text).strip()


def is_same(old, new):
    """Whether a document may keep what it states."""
    if not isinstance(new, Timed) or without_origin(old) == without_origin(new):
        return without_origin(old) == without_origin(new)
    if TIME.sub("", without_origin(old)) != TIME.sub("", without_origin(new)):
        return False
    pairs = [sorted(map(float, pair)) for pair in zip(TIME.findall(without_origin(old)), TIME.findall(without_origin(new)))]
    return all(more <= SAME_TIME * less for less, more in pairs)


def put(texts, is_check):
    """Writes the blocks; what differs, as lines."""
    different, found = [], set()
    for path in documents():
        def replace(match, path=path):
            name = match[2]
            if name not in texts:
                return match[0]
            found.add(name)
            old = match[3]
            new = f"\n{texts[name]}\n" if "\n" in texts[name] else texts[name]
            if is_same(old, texts[name]):
                return match[0] if isinstance(texts[name], Timed) else match[1] + new + match[4]
            different.append(f"{path.relative_to(ROOT)}: {name}: stands:\n{old.strip()}\nmade:\n{new.strip()}")
            return match[1] + new + match[4]
        text = path.read_text(encoding="utf-8")
        changed = BLOCK.sub(replace, text)
        if not is_check and changed != text:
            beside = path.with_name(path.name + ".new")
            beside.write_text(changed, encoding="utf-8")
            beside.rename(path)
    if missing := set(texts) - found:
        raise CannotMake(f"no document has a block <!-- figures: {sorted(missing)[0]} -->")
    return different


def list_figures():
    places = {}
    for path in documents():
        for match in BLOCK.finditer(path.read_text(encoding="utf-8")):
            places.setdefault(match[2].split("-by-")[0], []).append(str(path.relative_to(ROOT)))
    for name, make in MAKERS.items():
        print(f"{name:<16}{make.__doc__.splitlines()[0]} [{', '.join(places.get(name, ['nowhere']))}]")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--quick", action="store_true", help="those that take seconds")
    parser.add_argument("--list", action="store_true", help="print the names and make nothing")
    parser.add_argument("--check", action="store_true", help="write nothing, exit code 1 where something differs")
    parser.add_argument("--snug", type=Path, default=ROOT / "build" / "snug", help="the program (default: build/snug)")
    parser.add_argument("--data", type=Path, default=ROOT.parent / "shared" / "data", help="folder of the data that others made")
    parser.add_argument("--programs", type=Path, default=ROOT.parent / "shared" / "data" / "waypoints", help="folder of the demonstrator's programs")
    parser.add_argument("--folder", type=Path, default=ROOT / "build" / "figures", help="where rows are kept (default: build/figures)")
    words = parser.parse_args()
    if unknown := [name for name in words.names if name not in MAKERS]:
        parser.error(f"got '{unknown[0]}'; expected {', '.join(MAKERS)}")
    if words.list:
        list_figures()
        return
    words.folder.mkdir(parents=True, exist_ok=True)
    code = 0
    for name in words.names or (QUICK if words.quick else MAKERS):
        try:
            different = put(MAKERS[name](words), words.check)
        except CannotMake as why:
            print(f"figures.py: {why}", file=sys.stderr)
            code = 2
            continue
        print(f"{name}: {'as it stands' if not different else 'differs' if words.check else 'written'}", flush=True)
        if words.check and different:
            print("\n".join(different))
            code = code or 1
    sys.exit(code)


if __name__ == "__main__":
    main()
