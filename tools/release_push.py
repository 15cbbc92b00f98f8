#!/usr/bin/env python3
"""release_push.py FOLDER [DRAWS]: what the demonstrator's own programs tell of `cup.release_push`, and what its uncertainty does to them.

Runs the programs of the real cell in FOLDER (see acceptance.py) with pushes from 0.4 to 1. A flipped box is picked again where the
authors found it; the offset of the cup from the middle of its face is the residual. Least squares over kinds of flips: boxes that
are flipped by the same waypoints are one kind. The standard error is that of the jackknife over kinds; the interval is Student's, of
95 %, with one degree of freedom less than there are kinds. Then each program runs in DRAWS (20) cells drawn from the scenario's `uncertainty`, with two seeds.
SNUG names the program, if not build/snug. Exit code 2: nothing to run.
"""
import sys
from pathlib import Path

import acceptance

PUSHES = [round(0.4 + 0.05 * i, 2) for i in range(13)]
SAME_WAYPOINTS = ("BOX023", "BOX024", "BOX025", "BOX026")
STUDENT = {2: 12.71, 3: 4.30, 4: 3.18, 5: 2.78}  # 97.5 % quantile, by the number of kinds
SEEDS = (21, 22)  # no number was chosen on these draws


def kind_of(box):
    return "BOX023 to 026" if box in SAME_WAYPOINTS else box


def lowest(sums):
    """Where a parabola through the least of the sums and its neighbours is lowest."""
    i = min(range(1, len(sums) - 1), key=lambda k: sums[k])
    a, b, c = sums[i - 1], sums[i], sums[i + 1]
    return PUSHES[i] + 0.5 * (PUSHES[1] - PUSHES[0]) * (a - c) / (a - 2.0 * b + c)


def simulate(program, sequence, *more):
    document, problem = acceptance.run(program, sequence, *more)
    if document is None:
        raise SystemExit(f"release_push.py: {program.name}: {problem}")
    return document


def offsets(programs):
    """{kind: mean square of the offsets at each push, mm^2}"""
    squares = {}
    for number, push in enumerate(PUSHES):
        for sequence, program in programs.items():
            for repick in simulate(program, sequence, "--set", f"cup.release_push={push}")["repicks"]:
                squares.setdefault(kind_of(repick["id"]), [[] for _ in PUSHES])[number].append(repick["offset_mm"] ** 2)
    return {kind: [sum(rows) / max(1, len(rows)) for rows in each] for kind, each in squares.items()}


def main(arguments):
    if len(arguments) not in (2, 3) or arguments[1].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    folder, draws = Path(arguments[1]), arguments[2] if len(arguments) == 3 else "20"
    programs = {n: acceptance.find_program(folder, n, True) for n in acceptance.SEQUENCES}
    programs = {n: program for n, program in programs.items() if program}
    if not programs:
        print(f"release_push.py: no poses1real.csv or another program of the real cell in '{folder}'", file=sys.stderr)
        return 2
    squares = offsets(programs)
    print("| offset of re-picks, rms, mm | " + " | ".join(f"{push:.2f}" for push in PUSHES) + " | least at |")
    print("|---|" + "---|" * (len(PUSHES) + 1))
    for kind, rows in squares.items():
        print(f"| {kind} | " + " | ".join(f"{row ** 0.5:.1f}" for row in rows) + " | |")

    def total(kinds):
        return [sum(squares[kind][i] for kind in kinds) for i in range(len(PUSHES))]

    best, without = lowest(total(squares)), []
    for kind in squares:
        without.append(lowest(total([other for other in squares if other != kind])))
        print(f"| all but {kind} | " + " | ".join("" for _ in PUSHES) + f" | {without[-1]:.3f} |")
    n, mean = len(without), sum(without) / len(without)
    error = ((n - 1) / n * sum((one - mean) ** 2 for one in without)) ** 0.5
    print("| all | " + " | ".join(f"{(row / n) ** 0.5:.1f}" for row in total(squares)) + f" | {best:.3f} +- {error:.3f} |\n")
    print(f"interval: {best:.2f} +- {STUDENT.get(n, 2.5) * error:.2f}\n")
    print("| boxes packed, % | " + " | ".join(f"sequence {n}" for n in programs) + " |\n|---|" + "---|" * len(programs))
    for seed in SEEDS:
        shares = [simulate(program, n, "--monte-carlo", draws, "--seed", str(seed))["mean_packed_percent"] for n, program in programs.items()]
        print(f"| {draws} cells, seed {seed} | " + " | ".join(f"{share:.1f}" for share in shares) + " |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
