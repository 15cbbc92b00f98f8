#!/usr/bin/env python3
"""make_examples.py [FOLDER]: writes the example inputs of scenarios/examples that are measurements: made up, with known truths and seeds.

They let every command of the documents run; nothing is learned from them. SNUG names the program, if not build/snug; the arm is the
shipped UR10. The truths stand in scenarios/examples/README.md.
"""
import json
import math
import os
import random
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))
from urscript_robot import Arm, compose, inverse, rotation_of, times, turned  # noqa: E402  # pylint: disable=wrong-import-position

SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
URDF = ROOT / "scenarios" / "robots" / "ur10.urdf"
DOWN = rotation_of([math.pi, 0, 0])
STIFFNESS = (2500.0, 6000.0, 5.0, 3.0)  # lateral, axial, bend, torsion


def vector_of(rotation):
    cosine = max(-1.0, min(1.0, (sum(rotation[i][i] for i in range(3)) - 1) / 2))
    axis = [rotation[2][1] - rotation[1][2], rotation[0][2] - rotation[2][0], rotation[1][0] - rotation[0][1]]
    sine = math.sqrt(sum(x * x for x in axis)) / 2
    angle = math.atan2(sine, cosine)
    return [0.0] * 3 if sine < 1e-9 else [angle * x / (2 * sine) for x in axis]


def quaternion_of(rotation):
    v = vector_of(rotation)
    angle = math.sqrt(sum(x * x for x in v))
    s = math.sin(angle / 2) / angle if angle > 1e-12 else 0.5
    return [math.cos(angle / 2), *(s * x for x in v)]


def stiffness_matrix():
    lateral, axial, bend, torsion = STIFFNESS
    diagonal = [lateral, lateral, axial, bend, bend, torsion]
    return [[diagonal[i] if i == j else 0.0 for j in range(6)] for i in range(6)]


def settle(loads):
    text = "\n".join(json.dumps(load) for load in loads) + "\n"
    out = subprocess.run([SNUG, "cup", "settle", "-"], input=text, capture_output=True, text=True, check=True).stdout
    return [json.loads(line) for line in out.splitlines()]


def frames():
    eye = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    return {"E_H_S2": {"R": eye, "o": [0, 0, 0.025]}, "S_H_S1": {"R": eye, "o": [0, 0, -0.025]}}


def round_all(value, digits=9):
    if isinstance(value, float):
        return round(value, digits)
    if isinstance(value, list):
        return [round_all(x, digits) for x in value]
    if isinstance(value, dict):
        return {key: round_all(x, digits) for key, x in value.items()}
    return value


def static_poses(rng):
    """Boxes that hang from the cup, the gripper tilted: measured with noise."""
    loads = []
    for k in range(60):
        tilt = rotation_of([math.radians(rng.uniform(-80, 80)), math.radians(rng.uniform(-80, 80)), 0])
        turn = rotation_of([0, 0, math.radians(rng.uniform(-180, 180))])
        loads.append({"id": k, "W_R_E": times(times(turn, tilt), DOWN), "mass": rng.choice([0.26, 0.55, 0.95, 1.6]),
                      "com_S": [rng.uniform(-0.02, 0.02), rng.uniform(-0.02, 0.02), rng.uniform(0.04, 0.07)],
                      "K": stiffness_matrix(), **frames()})
    records = []
    for load, rest in zip(loads, settle(loads)):
        if not rest.get("stable") or rest["bend_deg"] > 35:
            continue
        noise = [math.radians(rng.gauss(0, 0.2)) for _ in range(3)]
        records.append({"E_o_S_meas": [x + rng.gauss(0, 5e-4) for x in rest["E_o_S"]],
                        "E_q_S_meas": quaternion_of(times(rest["E_R_S"], rotation_of(noise))),
                        "W_q_E": quaternion_of(load["W_R_E"]), "mass": load["mass"], "com_S": load["com_S"]})
    return records


def deformations():
    lines = []
    for k, (turn, shift) in enumerate((([0, 0, 0], [0.002, 0, 0]), ([0.1, 0, 0], [0, 0, -0.003]), ([0.05, -0.08, 0.1], [0.001, 0.002, 0.001]))):
        lines.append({"id": k, "R": rotation_of(turn), "o": shift, "K": stiffness_matrix(), "S_R_S1": rotation_of([0, 0, 0]), "S_o_S1": [0, 0, -0.025]})
    return lines


def loads():
    tilted = times(rotation_of([math.radians(30), 0, 0]), DOWN)
    return [{"id": "upright", "W_R_E": DOWN, "mass": 0.95, "com_S": [0.01, 0, 0.05], "K": stiffness_matrix(), **frames()},
            {"id": "tilted", "W_R_E": tilted, "mass": 0.55, "com_S": [0, 0, 0.05], "K": stiffness_matrix(), **frames()}]


def tracker(rng, deviation):
    """Poses of tool0 in base, the arm's second and third link longer by 0.4 and shorter by 0.3 mm."""
    arm = Arm(URDF)
    for link, offset in deviation.items():
        parent, (rotation, xyz), moves, axis = arm.joints[link]
        arm.joints[link] = parent, (rotation, [x + d for x, d in zip(xyz, offset)]), moves, axis
    rows = ["q1,q2,q3,q4,q5,q6,x,y,z,rx,ry,rz"]
    for _ in range(40):
        q = [rng.uniform(-2, 2), rng.uniform(-2.2, -0.6), rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2), rng.uniform(-2, 2)]
        rotation, xyz = compose(inverse(arm.pose("base", q)), arm.pose("tool0", q))
        measured = times(rotation, rotation_of([rng.gauss(0, 1e-4) for _ in range(3)]))
        numbers = [*q, *(x + rng.gauss(0, 5e-5) for x in xyz), *vector_of(measured)]
        rows.append(",".join(f"{x:.7f}" for x in numbers))
    return "\n".join(rows) + "\n"


def touches(rng, tip, point):
    rows = ["x,y,z,rx,ry,rz"]
    for k in range(8):
        rotation = times(rotation_of([0, 0, rng.uniform(-3, 3)]), times(rotation_of([rng.uniform(-0.6, 0.6), rng.uniform(-0.6, 0.6), 0]), DOWN))
        xyz = [p - x + rng.gauss(0, 5e-5) for p, x in zip(point, turned(rotation, tip))]
        rows.append(",".join(f"{x:.7f}" for x in [*xyz, *vector_of(rotation)]))
    return "\n".join(rows) + "\n"


def readings(rng, mass, com, offset):
    rows = ["rx,ry,rz,fx,fy,fz,tx,ty,tz"]
    for k in range(12):
        rotation = rotation_of([[math.pi, 0, 0], [0, 0, 0], [math.pi / 2, 0, 0], [-math.pi / 2, 0, 0], [0, math.pi / 2, 0], [0, -math.pi / 2, 0]][k % 6])
        rotation = times(rotation, rotation_of([rng.uniform(-0.2, 0.2) for _ in range(3)]))
        force = turned([list(c) for c in zip(*rotation)], [0, 0, -9.81 * mass])
        torque = [com[1] * force[2] - com[2] * force[1], com[2] * force[0] - com[0] * force[2], com[0] * force[1] - com[1] * force[0]]
        wrench = [w + o + rng.gauss(0, s) for w, o, s in zip(force + torque, offset, [0.05] * 3 + [0.003] * 3)]
        rows.append(",".join(f"{x:.6f}" for x in [*vector_of(rotation), *wrench]))
    return "\n".join(rows) + "\n"


def releases(rng):
    """Boxes of four masses leave a vertical cup: they hang until the pressure no longer carries them, and fall with a push that dies away."""
    rows = ["mass_kg,rep,t_s,E_z_m,B_z_m"]
    for mass in (0.4, 0.8, 1.2, 1.6):
        opens = 0.003 + 0.016 * math.log(160.0 / (9.81 * mass))
        for rep in (1, 2):
            drop, speed, step = 0.050 + 9.81 * mass / 6000.0, 0.0, 1 / 3600
            for i in range(501):
                if i % 10 == 0:
                    rows.append(f"{mass},{rep},{i * step:.6f},0.1700000,{0.17 - drop + rng.gauss(0, 3e-5):.7f}")
                after = i * step - opens
                speed += step * (9.81 + 4.0 / mass * math.exp(-after / 0.01)) if after > 0.0 else 0.0
                drop += step * speed
    return "\n".join(rows) + "\n"


def lift(rng, mass, com, inertia):
    """A box on a lip that does not give, 75 mm below the gripper's end, moved to and fro and tilted for two seconds."""
    def tilt(t):
        return [0.25 * math.sin(5.0 * t), 0.2 * math.sin(7.0 * t), 0.3 * math.sin(4.0 * t)]

    def pose(t):
        return times(DOWN, rotation_of(tilt(t))), [0.15 * math.sin(4.0 * t), 0.1 * math.sin(6.0 * t), 0.3 + 0.1 * math.sin(3.0 * t)]

    def centre(t):
        rotation, xyz = pose(t)
        return [x + c for x, c in zip(xyz, turned(rotation, com))]

    def turning(t, h=1e-4):
        before, after = pose(t - h)[0], pose(t + h)[0]
        return [x / (2 * h) for x in vector_of(times(after, [list(c) for c in zip(*before)]))]

    def momentum(t):
        rotation = pose(t)[0]
        inside = turned([list(c) for c in zip(*rotation)], turning(t))
        return turned(rotation, [i * w for i, w in zip(inertia, inside)])

    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    rows, h = ["t,x,y,z,qw,qx,qy,qz,fx,fy,fz,tx,ty,tz"], 1e-3
    for i in range(201):
        t = 0.01 * i
        rotation, xyz = pose(t)
        back = [list(c) for c in zip(*rotation)]
        acceleration = [(a - 2 * b + c) / h ** 2 for a, b, c in zip(centre(t + h), centre(t), centre(t - h))]
        force = [mass * a for a in acceleration[:2]] + [mass * (acceleration[2] + 9.81)]
        change = [(a - b) / (2 * h) for a, b in zip(momentum(t + h), momentum(t - h))]
        torque = [a + b for a, b in zip(change, cross([c - x for c, x in zip(centre(t), xyz)], force))]
        wrench = [w + rng.gauss(0, s) for w, s in zip(turned(back, force) + turned(back, torque), [0.1] * 3 + [0.005] * 3)]
        w, x, y, z = quaternion_of(rotation_of(tilt(t)))  # behind half a turn about x
        rows.append(",".join(f"{number:.7f}" for number in [t, *xyz, -x, w, -z, y, *wrench]))
    return "\n".join(rows) + "\n"


def board(rng):
    """A board that the tool holds 0.1 m below it, 1 m under the scenario's camera; noise 0.3 mm, 0.5 mrad."""
    camera = rotation_of([math.pi, 0, math.pi / 2]), [0.505, -0.350, 0.720]
    held = rotation_of([0.02, -0.03, 0.5]), [0.01, -0.02, 0.1]
    rows = ["x,y,z,rx,ry,rz,cx,cy,cz,crx,cry,crz"]
    for _ in range(16):
        tool = times(rotation_of([rng.gauss(0, 0.3) for _ in range(3)]), DOWN), [0.5 + rng.gauss(0, 0.08), -0.35 + rng.gauss(0, 0.08), -0.1 + rng.gauss(0, 0.05)]
        rotation, xyz = compose(inverse(camera), compose(tool, held))
        seen = times(rotation, rotation_of([rng.gauss(0, 5e-4) for _ in range(3)]))
        numbers = [*tool[1], *vector_of(tool[0]), *(x + rng.gauss(0, 3e-4) for x in xyz), *vector_of(seen)]
        rows.append(",".join(f"{x:.7f}" for x in numbers))
    return "\n".join(rows) + "\n"


def deltas(rng):
    """As a UR controller stores them: a tenth of a millimetre and a milliradian; the last length and twist are not used."""
    draw = lambda sigma, last: [rng.gauss(0, sigma) for _ in range(5)] + [last]
    rows = {"delta_theta": draw(1e-3, 1e-4), "delta_a": draw(2e-4, 0), "delta_d": draw(2e-4, 1e-5), "delta_alpha": draw(1e-3, 0)}
    return "[mounting]\n" + "".join(f"{key} = [{', '.join(f'{x:.9g}' for x in row)}]\n" for key, row in rows.items())


def orders(rng):
    """Two orders in the BED-BPP form."""
    articles = {"jars": (290, 190, 120, 4.1), "flour": (380, 250, 180, 8.2), "tins": (400, 300, 110, 9.0), "crisps": (390, 290, 250, 1.6)}
    made = {}
    for number, count in (("1001", 30), ("1002", 40)):
        names = [rng.choice(list(articles)) for _ in range(count)]
        made[number] = {"item_sequence": {str(k + 1): {"id": name, "article": name, "length/mm": articles[name][0], "width/mm": articles[name][1],
                                                       "height/mm": articles[name][2], "weight/kg": articles[name][3]} for k, name in enumerate(names)}}
    return json.dumps(made, indent=1) + "\n"


CONTAINERS = """ 2
 1 1
 600 400 400
 3
 1 150 1 100 1 90 1 60
 2 200 1 120 0 80 1 40
 3 110 1 95 1 70 1 50
 2 2
 400 300 200
 2
 1 120 1 100 1 90 1 12
 2 190 1 140 1 90 1 10
"""


def lifted(time):
    """How far a box is lifted that rises from 0.3 s to 0.7 s, of its whole way."""
    share = min(1.0, max(0.0, (time - 0.3) / 0.4))
    return 3 * share**2 - 2 * share**3


def take():
    """A robot's base and a crate as Motive exports them, y up; the crate is lost for 50 ms."""
    row = lambda label, cells: f",{label}," + ",".join(cells) + "\n"
    text = ("Format Version,1.23,Take Name,crate,Take Notes,,Capture Frame Rate,100.000000,Export Frame Rate,100.000000,Rotation Type,Quaternion,"
            "Length Units,Meters,Coordinate Space,Global\n\n")
    text += row("Type", ["Rigid Body"] * 14) + row("Name", ["Robot base"] * 7 + ["Crate"] * 7) + row("ID", ["1"] * 7 + ["2"] * 7)
    text += row("", (["Rotation"] * 4 + ["Position"] * 3) * 2) + "Frame,Time (Seconds)" + ",X,Y,Z,W,X,Y,Z" * 2 + "\n"
    for i in range(100):
        crate = ",,,,,," if 55 <= i < 60 else f"0,0,0,1,0.6,{0.15 + 0.2 * lifted(i / 100):.6f},-0.1"
        text += f"{i},{i / 100:.6f},0,0,0,1,0,0,0,{crate}\n"
    return text


def rtde():
    """What record.py of the maker's client writes of such a lift."""
    names = ["timestamp", *(f"actual_q_{i}" for i in range(6)), *(f"actual_TCP_pose_{i}" for i in range(6)), "actual_digital_output_bits"]
    text = " ".join(names) + "\n"
    for i in range(125):
        up = lifted(i * 0.008)
        joints = [-3.14, -1.57 - 0.2 * up, -1.57 + 0.2 * up, -1.57, 1.57, 0]
        text += " ".join([f"{812.4 + i * 0.008:.3f}", *(f"{q:.5f}" for q in joints), "0.6", "0.1", f"{0.3 + 0.2 * up:.6f}", "0", "3.14159", "0",
                          "1" if i * 0.008 > 0.2 else "0"]) + "\n"
    return text


def main(arguments):
    folder = Path(arguments[1]) if len(arguments) > 1 else ROOT / "scenarios" / "examples"
    rng = random.Random(7)
    as_lines = lambda things: "".join(json.dumps(round_all(thing)) + "\n" for thing in things)
    (folder / "deformations.jsonl").write_text(as_lines(deformations()))
    (folder / "loads.jsonl").write_text(as_lines(loads()))
    records = round_all(static_poses(rng), 7)
    (folder / "poses.json").write_text('{"records": [\n' + ",\n".join(json.dumps(record) for record in records) + "\n]}\n")
    (folder / "tracker.csv").write_text(tracker(rng, {"forearm_link": [-4e-4, 0, 0], "wrist_1_link": [3e-4, 0, 0]}))
    (folder / "touches.csv").write_text(touches(rng, [0.002, -0.001, 0.334], [0.6, 0.1, 0.05]))
    (folder / "readings.csv").write_text(readings(rng, 1.02, [0.001, 0.0, 0.16], [2.0, -1.0, 4.0, 0.05, -0.02, 0.01]))
    (folder / "calibration.conf").write_text(deltas(rng))
    subprocess.run([SNUG, "calibrate", "kinematics", "--deltas", folder / "calibration.conf", "--angles", "euler-xyz", "-o",
                    str(folder / "calibrated.urdf"), "--write-yaml", str(folder / "calibration.yaml"), "--json"], check=True, stdout=subprocess.DEVNULL)
    (folder / "calibrated.urdf").unlink()
    (folder / "orders.json").write_text(orders(rng))
    (folder / "containers.txt").write_text(CONTAINERS)
    (folder / "board.csv").write_text(board(random.Random(8)))
    (folder / "releases.csv").write_text(releases(random.Random(9)))
    (folder / "take.csv").write_text(take())
    (folder / "rtde.csv").write_text(rtde())
    (folder / "lift.csv").write_text(lift(random.Random(10), 1.1, [0.01, -0.015, 0.125], [0.003, 0.004, 0.005]))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv))
