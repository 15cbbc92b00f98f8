#!/usr/bin/env python3
"""identify_packed.py: whether `snug identify scene` finds what was planted in the plant of a packed program.

  identify_packed.py [--seed 1] [--count 10] [--boxes 3] [--robot none,ur10] [--numbers LIST] [--repetitions 1] [--sensors FILE] [--folder DIR] [--threads N]
                     [--evaluate]

For each seed: five numbers of the demonstrator's cell are drawn (friction and stiffness of box and container, lateral, axial and bending stiffness of the cup)
and `snug pack` packs boxes, drawn as well, with the fast controller in a plant that has them; its planner does not know them. `snug measure` turns the run into
an archive with the demonstrator's noise, losses and clocks, and `snug identify scene` gets the archive, the program, and a scenario that has none of the five.
Seeds take the robots in turn. Prints a line for each seed, with the misfit at the truth (rms of the means that are compared, beside what the sensors' noise sets
for them), and for each number how far off it is in its standard errors. Exit code 1 where a number was not found, is more than three standard errors off, or the
misfit at the truth exceeds the noise of the sensors; with ten seeds or more, also where the root mean square of all those errors is not 0.7 to 1.3.
--numbers: only these are drawn and searched, separated by commas. --evaluate: only the misfit at the truth, nothing is searched."""
import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
SENSORS = ROOT / "scenarios" / "sensors" / "demonstrator.yaml"
MOST_ERRORS = 3.0  # standard errors that a number may be off
SPREAD = (0.7, 1.3)  # root mean square of errors over their standard errors
ENOUGH = 10  # seeds from which the spread is judged
POSITION_NOISE, ROTATION_NOISE_DEG = 1e-4, 0.1  # of a sample and axis: scenarios/sensors/demonstrator.yaml
# name: key of the task, key of --plant-set, where the search starts (the cell's own value), bounds, what is planted
NUMBERS = {
    "friction": ("contacts.pairs[1].friction", "contacts.pairs.box/container.friction", 0.24, (0.1, 0.5), (0.16, 0.34)),
    "contact_stiffness": ("contacts.pairs[1].stiffness", "contacts.pairs.box/container.stiffness", 1.5e4, (5e3, 4e4), (1.1e4, 2.2e4)),
    "cup_lateral": ("cup.stiffness.lateral", "cup.stiffness.lateral", 2500.0, (1500.0, 5000.0), (1900.0, 3300.0)),
    "cup_axial": ("cup.stiffness.axial", "cup.stiffness.axial", 6000.0, (4000.0, 10000.0), (4900.0, 7400.0)),
    "cup_bend": ("cup.stiffness.bend", "cup.stiffness.bend", 5.0, (2.0, 10.0), (3.8, 6.4)),
}
BOXES = [f"BOX{number:03d}" for number in range(13, 31)]


def run(*words):
    done = subprocess.run([SNUG, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(f"identify_packed.py: {' '.join(map(str, words))}: {done.stderr[-500:]}")
    return done.stdout


def write_cell(folder, boxes):
    """The demonstrator's cell with a sequence of these boxes, the robot's files by their absolute path."""
    text = CELL.read_text(encoding="utf-8").replace("urdf: robots/", f"urdf: {CELL.parent}/robots/")
    items = "".join(f"      - {{parcel: {box}, up: Z}}\n" for box in boxes)
    (folder / "cell.yaml").write_text(text.replace("\nsequences:\n", f"\nsequences:\n  - name: packed\n    items:\n{items}", 1), encoding="utf-8")


def write_task(folder, boxes, numbers, values, name):
    task = {"scenario": "cell.yaml", "program": {"file": "program.csv", "sequence": "packed"}, "recordings": ["measured.h5"],
            "tracked_objects": [{"body": box} for box in boxes], "noise": {"position": POSITION_NOISE, "rotation_deg": ROTATION_NOISE_DEG},
            "start": {"from": "scenario"}, "own": {"delay": 5e-4, "frame_position": 3e-4, "frame_rotation_deg": 0.15}, "search": {"local": 100, "held_back": 0},
            "parameters": [{"name": key, "path": number[0], "value": values[key], "bounds": list(number[3])} for key, number in numbers.items()]}
    (folder / name).write_text(json.dumps(task, indent=1), encoding="utf-8")
    return folder / name


def make_experiment(folder, seed, robot, words):
    """Packs, measures and writes the tasks; what was planted, and the tasks that start at the cell's values and at the truth."""
    draw = random.Random(seed)
    numbers = {name: number for name, number in NUMBERS.items() if name in words.numbers}
    truth = {name: draw.uniform(*number[4]) for name, number in NUMBERS.items()}  # the same, however many are used
    truth = {name: truth[name] for name in numbers}
    boxes = draw.sample(BOXES, words.boxes)
    write_cell(folder, boxes)
    planted = [word for name, number in numbers.items() for word in ("--plant-set", f"{number[1]}={truth[name]:.6g}")]
    run("pack", folder / "cell.yaml", "--sequence", "packed", "--robot", robot, "--plant-seed", 0, "--seed", seed, "--samples", 1,
                            "--decision-time", 0.2, "--program", folder / "program.csv", "-o", folder / "run.h5", *planted)
    run("measure", folder / "run.h5", "--sensors", words.sensors, "--repetitions", words.repetitions, "--seed", seed, "-o", folder / "measured.h5",
        "--truth", folder / "sensors-truth.json")
    start = write_task(folder, boxes, numbers, {name: number[2] for name, number in numbers.items()}, "task.yaml")
    return truth, start, write_task(folder, boxes, numbers, truth, "truth.yaml")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1, help="of the first experiment; the others follow")
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--boxes", type=int, default=3)
    parser.add_argument("--robot", default="none,ur10", help="none, ur10, or both in turn")
    parser.add_argument("--numbers", type=lambda text: text.split(","), default=list(NUMBERS), help=", ".join(NUMBERS))
    parser.add_argument("--repetitions", type=int, default=1)
    parser.add_argument("--sensors", type=Path, default=SENSORS)
    parser.add_argument("--folder", type=Path, help="keep the experiments here")
    parser.add_argument("--threads", type=int)
    parser.add_argument("--evaluate", action="store_true", help="only the misfit at the truth")
    words = parser.parse_args()
    if not set(words.numbers) <= set(NUMBERS):
        parser.error(f"--numbers: {', '.join(NUMBERS)}")
    robots, wrong, off = words.robot.split(","), [], []
    threads = () if words.threads is None else ("--threads", words.threads)
    with tempfile.TemporaryDirectory() as name:
        for seed in range(words.seed, words.seed + words.count):
            folder = (words.folder or Path(name)) / f"packed-{seed}"
            folder.mkdir(parents=True, exist_ok=True)
            robot = robots[seed % len(robots)]
            truth, task, true_task = make_experiment(folder, seed, robot, words)
            at_truth = json.loads(run("identify", "scene", true_task, "--evaluate", "--json", *threads))
            if at_truth["position_mm"] > 1e3 * POSITION_NOISE or at_truth["rotation_deg"] > ROTATION_NOISE_DEG:
                wrong.append(f"seed {seed}: at the truth {at_truth['position_mm']:.3f} mm and {at_truth['rotation_deg']:.3f} degrees are missed, more than noise")
            line = f"{seed:4} {robot:5} misfit at the truth {at_truth['position_mm']:.3f} mm {at_truth['rotation_deg']:.3f} deg"
            if words.evaluate:
                print(line, flush=True)
                continue
            began = time.monotonic()
            found = json.loads(run("identify", "scene", task, "--json", *threads))
            (folder / "found.json").write_text(json.dumps({"found": found, "truth": truth}, indent=1), encoding="utf-8")
            told = []
            for one in found["parameters"]:
                error = one["value"] - truth[one["name"]]
                deviations = error / one["standard_error"] if one.get("standard_error") else math.inf
                told.append(f"{one['name']} {one['verdict']} {one['value']:.4g} of {truth[one['name']]:.4g} ({deviations:+.1f})")
                off.append(deviations)
                if one["verdict"] != "identified" or abs(deviations) > MOST_ERRORS:
                    wrong.append(f"seed {seed}: {told[-1]}")
            print(f"{line}, chi2 {found['chi2_per_dof']:.2f}, {time.monotonic() - began:.0f} s: " + ", ".join(told), flush=True)
    if off:
        spread = math.sqrt(sum(one**2 for one in off) / len(off))
        print(f"errors over their standard errors: root mean square {spread:.2f} of {len(off)}, at most {max(map(abs, off)):.1f}")
        if words.count >= ENOUGH and not SPREAD[0] <= spread <= SPREAD[1]:
            wrong.append(f"the root mean square is not {SPREAD[0]} to {SPREAD[1]}")
    print("\n".join(wrong) or "all found")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
