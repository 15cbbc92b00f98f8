#!/usr/bin/env python3
"""theory_pictures.py: draws the pictures of docs/theory that show computed curves, into docs/img. They follow the equations of
these pages, not the program: who changes an equation, a default or a picture draws them again.

  theory_pictures.py [NAME ...]     all of them, some seconds"""
import argparse
import sys
from pathlib import Path

from theory import contact, cup, motion, release

ROOT = Path(__file__).resolve().parent.parent
PICTURES = {**contact.PICTURES, **cup.PICTURES, **release.PICTURES, **motion.PICTURES}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="of " + ", ".join(PICTURES))
    parser.add_argument("--folder", type=Path, default=ROOT / "docs" / "img", help="where to write (default: docs/img)")
    words = parser.parse_args()
    if unknown := [name for name in words.names if name not in PICTURES]:
        parser.error(f"got '{unknown[0]}'; expected {', '.join(PICTURES)}")
    for name in words.names or PICTURES:
        file = words.folder / f"{name}.svg"
        file.write_text(PICTURES[name]().svg(), encoding="utf-8")
        print(file)


if __name__ == "__main__":
    sys.exit(main())
