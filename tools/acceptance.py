#!/usr/bin/env python3
"""acceptance.py FOLDER: runs the demonstrator's own packing programs and prints the table of docs/trust.md of how far to trust the simulation.

FOLDER holds the files of src/states/BoxPoses in the public repository MaartenJongeneel/FSM-Bin-Packing: posesNreal.csv ran on
the real cell, posesNsim.csv (sequence 1: poses.csv) was made for simulation. SNUG names the program, if not build/snug.
Exit code: 0 when every program ran to its end, 1 when one did not, 2 when there is none or an argument cannot be used.
"""
import json
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
SEQUENCES = ("1", "2", "3", "4", "5")
DURATION = {"1": 248.0, "2": 232.0, "3": 292.0}  # s, of the real cell
SOURCE = "https://github.com/MaartenJongeneel/FSM-Bin-Packing, src/states/BoxPoses"


def find_program(folder, sequence, is_real):
    names = [f"poses{sequence}real.csv"] if is_real else [f"poses{sequence}sim.csv"]
    if not is_real and sequence == "1":
        names += ["poses1.csv", "poses.csv"]
    return next((folder / name for name in names if (folder / name).is_file()), None)


def run(program, sequence, *more):
    """What `snug simulate --json` says of a program, or an explanation why there is nothing."""
    words = [SNUG, "simulate", str(ROOT / "scenarios" / "box-demonstrator.yaml"), "--program", str(program),
             "--sequence", sequence, "--json", *more]
    result = subprocess.run(words, capture_output=True, text=True, check=False)
    if not result.stdout:
        return None, result.stderr.strip().splitlines()[-1] if result.stderr.strip() else f"exit code {result.returncode}"
    document = json.loads(result.stdout)
    return document, document["failure"] if result.returncode != 0 else ""


def remark(runs):
    """Flips and durations over the runs {sequence: document} that there are."""
    repicks = [repick for document in runs.values() for repick in document["repicks"]]
    flipped = sum(repick["up_after"] == repick["up_intended"] for repick in repicks)
    parts = [f"{flipped} of {len(repicks)} re-picks on the intended face"]
    deviations = [abs(runs[n]["duration_s"] / DURATION[n] - 1.0) for n in runs if n in DURATION]
    if deviations:
        parts.append(f"durations within {100.0 * max(deviations):.1f} %")
    if repicks:
        offsets = [repick["offset_mm"] for repick in repicks]
        parts.append(f"re-picks off by {sum(offsets) / len(offsets):.1f} mm on average, by {max(offsets):.0f} at most")
    return ", ".join(parts)


def main(arguments):
    if len(arguments) != 2 or arguments[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    folder = Path(arguments[1])
    found = {(n, real): find_program(folder, n, real) for n in SEQUENCES for real in (True, False)}
    sequences = [n for n in SEQUENCES if found[n, True] or found[n, False]]
    if not sequences:
        print(f"acceptance.py: no poses1real.csv or another program of the demonstrator in '{folder}'; "
              f"they are at {SOURCE}", file=sys.stderr)
        return 2
    if not os.access(SNUG, os.X_OK):
        print(f"acceptance.py: no program '{SNUG}': run `make build`, or name another in SNUG", file=sys.stderr)
        return 2
    print("| programs | " + " | ".join(f"sequence {n}" for n in sequences) + " | |")
    print("|---|" + "---|" * len(sequences) + "---|")
    problems = []
    for is_real, title in ((True, "run on the real cell"), (False, "made for simulation")):
        cells, runs = [], {}
        for n in sequences:
            program = found[n, is_real]
            if program is None:
                cells.append("-")
                continue
            document, problem = run(program, n)
            if problem:
                problems.append(f"{program.name}: {problem}")
            if document is None:
                cells.append("failed")
                continue
            runs[n] = document
            packed = sum(box["state"] == "packed" for box in document["boxes"])
            cells.append(f"{packed} of {len(document['boxes'])}")
        print(f"| {title} | " + " | ".join(cells) + f" | {remark(runs)} |", flush=True)
    for problem in problems:
        print(f"acceptance.py: {problem}", file=sys.stderr)
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
