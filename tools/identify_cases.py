#!/usr/bin/env python3
"""identify_cases.py: whether numbers that `snug identify scene` calls identified are true, where parts of the task cannot be told or are wrong.

  identify_cases.py [--count 50] [--seed 1] [--kind KIND] [--rate HZ] [--folder DIR]

Draws tasks whose truth is known: a box that slides against a wall, or is pushed by another, or falls. In some the start values do not reach the wall, or the
truth does not; two numbers do the same (friction and gravity; a mass that nothing depends on); the recorded world is shifted, turned, late or runs at
another rate, which nothing in the recordings shows: the task says how well its clock is known; noise is larger than declared; samples jump. `--kind pusher`
draws none of these, but a box that a recorded body pushes off centre, both with the demonstrator's noise, in one recording with so many samples a second.
Prints a line for each task, and for each kind how many numbers were called identified, and how far off they are in their standard errors. Exit code 1 where
one called identified is more than three of them off."""
import argparse
import bisect
import collections
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
RECORDINGS = 5
ERRORS = 3.0  # standard errors that a number called identified may be off

SCENE = """name: case
duration: {duration}
gravity: [0, 0, {gravity}]
materials: [{{name: box}}, {{name: floor}}, {{name: wall}}, {{name: block}}]
contacts:
  pairs:
    - {{between: [box, floor], friction: {friction}, restitution: 0.0}}
    - {{between: [box, wall], friction: 0.1, restitution: {restitution}}}
    - {{between: [box, block], friction: 0.2, restitution: {block_restitution}}}
    - {{between: [block, floor], friction: {block_friction}, restitution: 0.0}}
    - {{between: [block, wall], friction: 0.2, restitution: 0.0}}
bodies:
  - {{name: floor, kind: static, size: [8, 4, 0.1], material: floor, pose: {{position: [0, 0, -0.05]}}}}
  - {{name: wall, kind: static, size: [0.1, 2, 0.4], material: wall, pose: {{position: [{wall}, 0, 0.21]}}}}
  - {{name: parcel, size: [0.2, 0.16, 0.1], mass: {mass}, material: box, pose: {{position: [0, 0, 0.05]}}, twist: {{linear: [{speed}, 0, 0]}}}}
{block}"""
BLOCK = """  - {{name: block, size: [0.15, 0.2, 0.1], mass: {block_mass}, material: block, pose: {{position: [{block_at}, 0, 0.05]}}}}
"""
# What a task may open: path in the scenario, bounds.
NUMBERS = {
    "friction": ("contacts.pairs[0].friction", 0.05, 0.6),
    "speed": ("bodies.parcel.twist.linear[0]", 0.8, 2.6),
    "restitution": ("contacts.pairs[1].restitution", 0.0, 0.9),
    "wall": ("bodies.wall.pose.position[0]", None, None),
    "gravity": ("gravity[2]", -10.8, -8.8),
    "mass": ("bodies.parcel.mass", 0.3, 1.2),
    "block_friction": ("contacts.pairs[3].friction", 0.05, 0.6),
    "block_restitution": ("contacts.pairs[2].restitution", 0.0, 0.9),
    "block_mass": ("bodies.block.mass", 0.3, 1.2),
}
PUSHED = """name: pushed
time_step: 0.001
duration: 1.6
record_period: 0.001
materials: [{{name: box}}, {{name: floor}}, {{name: steel}}]
contacts:
  pairs:
    - {{between: [box, floor], friction: {friction}, restitution: 0.0}}
    - {{between: [box, steel], friction: 0.2, restitution: 0.0}}
bodies:
  - {{name: floor, kind: static, size: [4, 2, 0.1], material: floor, pose: {{position: [0, 0, -0.05]}}}}
  - {{name: pusher, kind: kinematic, size: [0.05, 0.05, 0.05], material: steel, {where}}}
  - {{name: parcel, size: [0.2, 0.16, 0.1], mass: 0.6, material: box, pose: {{position: [0, 0, 0.05]}}}}
"""
PLAIN = ("friction", "speed", "wall", "restitution")
KINDS = ("plain", "start misses the wall", "truth misses the wall", "friction and gravity", "mass of a sliding box", "pushed block", "shifted world", "turned world",
         "late clock", "clock rate", "more noise", "jumps")
PUSHER = "pusher"


def run(*words):
    done = subprocess.run([SNUG, *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(f"identify_cases.py: {' '.join(map(str, words))}: {done.stderr[-500:]}")
    return done


def draw_truth(kind, draw):
    truth = {"friction": draw.uniform(0.12, 0.4), "restitution": draw.uniform(0.2, 0.7), "block_friction": draw.uniform(0.15, 0.4),
             "block_restitution": draw.uniform(0.1, 0.6), "mass": draw.uniform(0.4, 1.0), "block_mass": draw.uniform(0.4, 1.0), "gravity": -9.81}
    truth["speed"] = draw.uniform(1.4, 2.0)
    stop = truth["speed"] ** 2 / (2 * truth["friction"] * 9.81)  # where it would come to rest
    reached = draw.uniform(0.4, 0.75) * stop if kind != "truth misses the wall" else 1.3 * stop
    truth["wall"] = reached + 0.15  # the middle of the wall: 0.05 and half the box before it
    truth["block_at"] = 0.4 * stop + 0.175
    return truth


def start_values(kind, names, truth, draw):
    values = {}
    for name in names:
        _, low, high = NUMBERS[name]
        if low is None:
            low, high = truth[name] - 0.05, truth[name] + 0.05
        values[name] = min(max(truth[name] + draw.uniform(-0.15, 0.15) * (high - low), low + 0.02 * (high - low)), high - 0.02 * (high - low))
    if kind == "start misses the wall":
        values["friction"], values["speed"] = min(0.55, 1.7 * truth["friction"]), max(0.85, 0.75 * truth["speed"])
    return values


def recorded(path):
    """t, position and quaternion of the bodies from the table of a run."""
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file, delimiter=";"))


def write_recordings(kind, rows, bodies, columns, noise, path, draw):
    """With noise, and with what the kind does to them."""
    shift, turn = draw.uniform(2e-3, 5e-3) * draw.choice([-1, 1]), math.radians(draw.uniform(0.5, 1.5))
    late, rate = draw.uniform(4e-3, 2e-2), 1.0 + draw.uniform(2e-3, 6e-3) * draw.choice([-1, 1])
    factor = draw.uniform(3.0, 6.0) if kind == "more noise" else 1.0
    with open(path, "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["rec", "t", *(f"{body}_{axis}" for body in bodies for axis in ("x", "y", "z", "qw", "qx", "qy", "qz"))])
        for number in range(RECORDINGS):
            for row in rows:
                t = float(row["t"])
                t = t * rate if kind == "clock rate" else t + late if kind == "late clock" else t
                cells = []
                for body in bodies:
                    x, y, z = (float(row[column]) for column in columns[body][:3])
                    w, i, j, k = (float(row[column]) for column in columns[body][3:])
                    q = [w, -i, -j, -k]  # the table has the rotation from the world to the body
                    if kind == "shifted world":
                        x += shift
                    if kind == "turned world":
                        x, y = x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)
                        c, s = math.cos(turn / 2), math.sin(turn / 2)
                        q = [c * q[0] - s * q[3], c * q[1] - s * q[2], c * q[2] + s * q[1], c * q[3] + s * q[0]]
                    jump = draw.uniform(0.02, 0.1) if kind == "jumps" and draw.random() < 0.01 else 0.0
                    x, y, z = (value + draw.gauss(0.0, factor * noise) + jump for value in (x, y, z))
                    cells += [f"{value:.6f}" for value in (x, y, z, *turned(q, factor * math.radians(0.3), draw))]
                table.writerow([number, f"{t:.6f}", *cells])


def turned(q, noise, draw):
    """A quaternion with noise, rad, about each axis."""
    w, i, j, k = q
    a, b, c = (draw.gauss(0.0, noise) / 2 for _ in range(3))
    q = [w - i * a - j * b - k * c, i + w * a + j * c - k * b, j + w * b + k * a - i * c, k + w * c + i * b - j * a]
    length = math.sqrt(sum(value * value for value in q))
    return [value / length for value in q]


def make_pushed(folder, draw, rate):
    """A body that speeds up, pushes a box off centre and brakes, so that the box slides on."""
    noise, rotation_noise = 1e-4, math.radians(0.1)
    truth, speed, aside = draw.uniform(0.2, 0.35), draw.uniform(0.35, 0.5), draw.uniform(-0.04, 0.04)

    def ramp(s):
        return 0.0 if s <= 0.0 else s - 0.5 if s >= 1.0 else s**3 - 0.5 * s**4

    def pusher(t):
        return [-0.135 + speed * (0.2 * ramp((t - 0.15) / 0.2) - 0.08 * ramp((t - 0.75) / 0.08)), aside, 0.05]

    axes = ("x", "y", "z", "qw", "qx", "qy", "qz")
    with open(folder / "path.csv", "w", encoding="utf-8") as file:
        file.write("time,x,y,z,qw,qx,qy,qz\n")
        for k in range(1601):
            file.write(f"{1e-3 * k:.3f}," + ",".join(f"{value:.9f}" for value in pusher(1e-3 * k)) + ",1,0,0,0\n")
    (folder / "truth.yaml").write_text(PUSHED.format(friction=truth, where="path: {file: path.csv}"), encoding="utf-8")
    (folder / "start.yaml").write_text(PUSHED.format(friction=0.22, where=f"pose: {{position: [-0.135, {aside}, 0.05]}}"), encoding="utf-8")
    run("simulate", folder / "truth.yaml", "--csv", folder / "truth.csv")
    rows = recorded(folder / "truth.csv")
    columns = columns_of(rows[0], "parcel")
    times = [float(row["t"]) for row in rows]
    poses = [[float(row[column]) for column in columns] for row in rows]
    with open(folder / "recorded.csv", "w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(["t", *(f"{body}_{axis}" for body in ("pusher", "parcel") for axis in axes)])
        for k in range(1, int(times[-1] * rate) + 1):
            t = k / rate
            at = min(max(bisect.bisect_left(times, t), 1), len(times) - 1)
            share = (t - times[at - 1]) / (times[at] - times[at - 1])
            box = [a + (b - a) * share for a, b in zip(poses[at - 1], poses[at])]
            cells = []
            for p, q in ((pusher(t), [1.0, 0.0, 0.0, 0.0]), (box[:3], [box[3], *(-value for value in box[4:])])):
                cells += [value + draw.gauss(0.0, noise) for value in p] + turned(q, rotation_noise, draw)
            table.writerow([f"{t:.7f}", *(f"{value:.7f}" for value in cells)])
    task = {"scenario": "start.yaml", "recordings": ["recorded.csv"], "tracked_objects": [{"body": "parcel", "columns": [f"parcel_{axis}" for axis in axes]}],
            "kinematic_bodies": [{"body": "pusher", "columns": [f"pusher_{axis}" for axis in axes]}], "start": {"from": "scenario"},
            "noise": {"position": noise, "rotation_deg": 0.1}, "search": {"local": 30},
            "parameters": [{"name": "friction", "path": "contacts.pairs[0].friction", "value": 0.22, "bounds": [0.05, 0.8]}]}
    (folder / "task.yaml").write_text(json.dumps(task, indent=1), encoding="utf-8")
    return {"friction": truth}


def columns_of(header, body):
    """Of the run's table: x, y, z, qw, qx, qy, qz."""
    found = [name for axis in ("position_x", "position_y", "position_z", "orientation_w", "orientation_x", "orientation_y", "orientation_z")
             for name in header if name == f"{body}_FloatingBase_{axis}"]
    if len(found) != 7:
        raise SystemExit(f"identify_cases.py: no pose of {body} among {[name for name in header if body in name]}")
    return found


def make_case(kind, folder, draw):
    """Writes a task; its parameters and their truth."""
    truth = draw_truth(kind, draw)
    names = {"friction and gravity": ("friction", "gravity", "speed"), "mass of a sliding box": ("friction", "mass", "speed"),
             "pushed block": ("friction", "speed", "block_friction", "block_restitution", "block_mass")}.get(kind, PLAIN)
    has_block = kind == "pushed block"
    if kind in ("friction and gravity", "mass of a sliding box", "pushed block"):
        truth["wall"] = 3.5
    scene = SCENE.format(**truth, duration=1.2, block=BLOCK.format(**truth) if has_block else "")
    (folder / "truth.yaml").write_text(scene, encoding="utf-8")
    run("simulate", folder / "truth.yaml", "--until", 1.2, "--csv", folder / "truth.csv")
    rows = recorded(folder / "truth.csv")
    bodies = ["parcel", "block"] if has_block else ["parcel"]
    noise = draw.choice([0.0003, 0.001])
    write_recordings(kind, rows, bodies, {body: columns_of(rows[0], body) for body in bodies}, noise, folder / "recorded.csv", draw)
    values = start_values(kind, names, truth, draw)
    (folder / "start.yaml").write_text(SCENE.format(**{**truth, **values}, duration=1.2, block=BLOCK.format(**{**truth, **values}) if has_block else ""),
                                       encoding="utf-8")
    task = {"scenario": "start.yaml", "recordings": ["recorded.csv"], "input_columns": {"recording": "rec", "time": "t"},
            "tracked_objects": [{"body": body, "columns": [f"{body}_{axis}" for axis in ("x", "y", "z", "qw", "qx", "qy", "qz")]} for body in bodies],
            "noise": {"position": noise, "rotation_deg": 0.3}, "start": {"from": "scenario"}, "search": {"local": 100, "held_back": 5},
            "clock_rate": 4e-3 if kind == "clock rate" else 1e-4,
            "parameters": [{"name": name, "path": NUMBERS[name][0], "value": values[name],
                            "bounds": list(NUMBERS[name][1:]) if NUMBERS[name][1] is not None else [truth[name] - 0.05, truth[name] + 0.05]} for name in names]}
    (folder / "task.yaml").write_text(json.dumps(task, indent=1), encoding="utf-8")
    return {name: truth[name] for name in names}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1, help="of the first task; the others follow")
    parser.add_argument("--kind", choices=(*KINDS, PUSHER), help="all tasks are of this kind")
    parser.add_argument("--rate", type=float, default=360.0, help="samples a second of a pusher's recording")
    parser.add_argument("--folder", type=Path, help="keep the tasks here")
    words = parser.parse_args()
    identified, off, wrong = collections.Counter(), collections.defaultdict(list), []
    with tempfile.TemporaryDirectory() as name:
        base = words.folder or Path(name)
        for seed in range(words.seed, words.seed + words.count):
            kind = words.kind or KINDS[seed % len(KINDS)]
            folder = base / f"case-{seed}"
            folder.mkdir(parents=True, exist_ok=True)
            draw = random.Random(seed)
            truth = make_pushed(folder, draw, words.rate) if kind == PUSHER else make_case(kind, folder, draw)
            found = json.loads(run("identify", "scene", folder / "task.yaml", "--json").stdout)
            told = []
            for one in found["parameters"]:
                error = abs(one["value"] - truth[one["name"]])
                deviations = error / one["standard_error"] if one.get("standard_error") else math.inf
                told.append(f"{one['name']} {one['verdict']} {deviations:.1f}" + (f" ({error:.4f})" if kind == PUSHER else ""))
                if one["verdict"] == "identified":
                    identified[kind] += 1
                    off[kind].append(deviations)
                    if deviations > ERRORS:
                        wrong.append(f"case {seed}, {kind}: {one['name']} {one['value']:.5g} +- {one['standard_error']:.2g} is called identified; true is "
                                     f"{truth[one['name']]:.5g}, {deviations:.1f} errors off")
            print(f"{seed:4} {kind:24} chi2 {found['chi2_per_dof']:8.2f}  " + ", ".join(told), flush=True)
    print()
    for kind in [words.kind] if words.kind else KINDS:
        worst = max(off[kind], default=0.0)
        print(f"{kind:24} {identified[kind]:4} identified, at most {worst:.1f} errors off")
    print("\n".join(wrong) or f"no number called identified is more than {ERRORS:.0f} errors off")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
