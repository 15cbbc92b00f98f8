#!/usr/bin/env python3
"""arms_test.py: arms of other kinds pack: one that turns its tool about the vertical alone, boxes that hang askew; and those of makers, placed by
`snug cell place`, ten boxes each. SNUG names the program, SNUG_URDF_FOLDER a folder of public URDF files with their meshes; without it
arms of makers are skipped, and said so."""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "init" / "cell.yaml"


def link(name, mass=0.0):
    inertia = f'<inertial><mass value="{mass}"/><inertia ixx="0.3" iyy="0.3" izz="0.3"/></inertial>' if mass else ""
    return f'<link name="{name}">{inertia}</link>'


def joint(name, kind, parent, child, axis="0 0 1", limit="", origin=""):
    return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/>'
            + (f"<limit {limit}/>" if limit else "") + (f"<origin {origin}/>" if origin else "") + "</joint>")


SLIDE = 'lower="-1.5" upper="1.5" effort="3000" velocity="2"'
GANTRY = "\n".join([
    '<robot name="gantry">', link("frame"), link("bridge", 20), link("carriage", 10), link("mast", 8), link("flange", 2),
    link("ft_sensor"), link("gripper", 1), link("E"), link("suction_cup"),
    joint("x", "prismatic", "frame", "bridge", "1 0 0", SLIDE), joint("y", "prismatic", "bridge", "carriage", "0 1 0", SLIDE),
    joint("z", "prismatic", "carriage", "mast", "0 0 1", SLIDE),
    joint("yaw", "revolute", "mast", "flange", "0 0 1", 'lower="-6.28" upper="6.28" effort="300" velocity="4"'),
    joint("turned", "fixed", "flange", "ft_sensor", origin='rpy="3.141592653589793 0 0"'),
    joint("rod", "fixed", "ft_sensor", "gripper"), joint("tip", "fixed", "gripper", "E", origin='xyz="0 0 0.3"'),
    joint("cup", "fixed", "E", "suction_cup"), "</robot>"])
ROBOT = """
robot:
  urdf: gantry.urdf
  pose: {position: [0.0, 0.0, 1.2]}
  posture: [0.0, 0.0, -0.5, 0.0]
  velocity_fraction: 0.5
  max_joint_acceleration: 5.0
  contact_stiffness: 5.0e+4
  collision_damping: 10.0
  tasks: {tool_weight: 5.0e+6, posture_weight: 10.0, posture_stiffness: 1.0}
"""


def follower(name, leader, parent, child, origin):
    """A joint about y that turns back what `leader` turns."""
    text = joint(name, "revolute", parent, child, "0 1 0", limit='lower="-2.5" upper="2.5" effort="200" velocity="4"', origin=origin)
    return text.replace("</joint>", f'<mimic joint="{leader}" multiplier="-1"/></joint>')


def joints_of(name, links, *joints):
    return "\n".join([f'<robot name="{name}">', *links, *joints, "</robot>"])


# Both end at a flange whose z points down. Two joints of the palletiser follow others, as its rods keep the flange level.
SCARA = joints_of(
    "scara", [link("base_link"), link("inner", 6), link("outer", 4), link("quill", 1.5), link("shaft", 0.5), link("tool0")],
    joint("j1", "revolute", "base_link", "inner", limit='lower="-2.4" upper="2.4" effort="200" velocity="6"', origin='xyz="0 0 0.2"'),
    joint("j2", "revolute", "inner", "outer", limit='lower="-2.5" upper="2.5" effort="100" velocity="8"', origin='xyz="0.5 0 0"'),
    joint("j3", "prismatic", "outer", "quill", limit='lower="-0.45" upper="0.0" effort="400" velocity="1.5"', origin='xyz="0.4 0 0"'),
    joint("j4", "revolute", "quill", "shaft", limit='lower="-6.2" upper="6.2" effort="30" velocity="15"'),
    joint("tip", "fixed", "shaft", "tool0", origin='rpy="3.141592653589793 0 0"'))
PALLETISER = joints_of(
    "palletiser", [link("base_link"), link("column", 20), link("lower", 15), link("upper", 10), link("rods", 1), link("wrist", 4), link("flange", 1), link("tool0")],
    joint("j1", "revolute", "base_link", "column", limit='lower="-3" upper="3" effort="900" velocity="3"', origin='xyz="0 0 0.4"'),
    joint("j2", "revolute", "column", "lower", "0 1 0", limit='lower="-0.9" upper="1.4" effort="900" velocity="3"', origin='xyz="0.15 0 0"'),
    joint("j3", "revolute", "lower", "upper", "0 1 0", limit='lower="-1.0" upper="2.3" effort="700" velocity="3"', origin='xyz="0 0 0.6"'),
    follower("level_j3", "j3", "upper", "rods", 'xyz="0.6 0 0"'), follower("level_j2", "j2", "rods", "wrist", 'xyz="0 0 0"'),
    joint("j4", "revolute", "wrist", "flange", limit='lower="-6.2" upper="6.2" effort="100" velocity="6"', origin='xyz="0.1 0 -0.1"'),
    joint("tip", "fixed", "flange", "tool0", origin='rpy="3.141592653589793 0 0"'))


class Arms(unittest.TestCase):
    def pack_one_box(self, cell, urdf, name):
        """`cell` without all boxes but L1, with the arm `urdf`."""
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "cell.yaml").write_text(re.sub(r"      - {parcel: (?!L1).*\n", "", cell))
            (Path(folder) / f"{name}.urdf").write_text(urdf)
            words = ["pack", "cell.yaml", "--sequence", "first", "--samples", "0", "--decision-time", "0.05", "--json"]
            done = subprocess.run([SNUG, *words], cwd=folder, text=True, capture_output=True, timeout=600, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads(done.stdout)
        self.assertEqual(result["robot"], name)
        self.assertEqual((result["executed_boxes"], result["boxes_lost"]), (1, 0), result["stopped"])

    def test_a_gantry_packs_a_box_whose_centre_of_mass_is_beside_the_cup(self):
        cell = CELL.read_text().replace("{id: L1, type: large,", "{id: L1, type: large, com: [0.03, 0.01, 0.0],")
        self.pack_one_box(cell + ROBOT, GANTRY, "gantry")

    def test_arms_whose_tool_stays_upright_pack(self):
        """Where `snug cell place` puts them."""
        for name, urdf, aligner, start, robot in (
                ("scara", SCARA, "position: [0.4, 0.25, 0.0]", "0.440763, 0.150974, 0.42", """
  pose: {position: [1.05, 0.0, 0.6], yaw_deg: -136.0}
  posture: [-0.3206, -1.6109, -0.09, 1.1635]"""),
                ("palletiser", PALLETISER, "yaw_deg: 180.0, position: [0.5, -0.25, 0.0]", "0.459237, -0.150974, 0.42", """
  pose: {position: [0.59, 0.69, 0.0], yaw_deg: -103.0}
  posture: [0.0469, 0.0616, 0.2586, -1.3908]""")):
            with self.subTest(arm=name):
                cell = CELL.read_text().replace("position: [-0.40, -0.10, 0.0]", aligner).replace("0.0, -0.35, 0.40", start)
                self.assertIn(aligner, cell)
                self.assertIn(start, cell)
                mounted = f"""
robot:
  urdf: {name}.urdf{robot}
  tool_frame: tool0
  tool_pose: {{position: [0.0, 0.0, 0.290]}}
"""
                self.pack_one_box(cell + mounted, urdf, name)


class Places(unittest.TestCase):
    def snug(self, *words, code=0):
        done = subprocess.run([SNUG, *map(str, words)], cwd=self.folder.name, text=True, capture_output=True, timeout=600, check=False)
        self.assertEqual(done.returncode, code, done.stdout[-2000:] + done.stderr[-2000:])
        return done

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        path = Path(self.folder.name)
        text = re.sub(r"      - {parcel: (?!L1).*\n", "", CELL.read_text())
        (path / "cell.yaml").write_text(text)
        # As a maker publishes it: without what is behind the flange.
        arm = (ROOT / "scenarios" / "robots" / "ur5e.urdf").read_text()
        for name in ("ft_sensor", "gripper", "E", "suction_cup"):
            arm = re.sub(rf'<link name="{name}"(/>|.*?</link>)', "", arm, flags=re.DOTALL)
            arm = re.sub(rf'<joint(?:(?!</joint>).)*<child link="{name}"/>.*?</joint>', "", arm, flags=re.DOTALL)
        (path / "arm.urdf").write_text(arm)

    def test_an_arm_without_gripper_is_placed_and_packs(self):
        self.snug("cell", "place", "cell.yaml", "--arm", "arm.urdf", "--tool-link", "tool0", "-o", "placed.yaml", "--page", "places.html")
        placed = (Path(self.folder.name) / "placed.yaml").read_text()
        self.assertIn("tool_pose: {position: [0.0, 0.0, 0.290]}", placed)
        self.assertIn("# What is packed into", placed)
        self.assertIn("<svg", (Path(self.folder.name) / "places.html").read_text())
        search = json.loads(self.snug("cell", "place", "placed.yaml", "--json").stdout)
        self.assertEqual(search["before"]["reached"], search["asked"])
        words = ("--sequence", "first", "--samples", "0", "--decision-time", "0.05", "--json")
        self.assertEqual(json.loads(self.snug("pack", "placed.yaml", *words).stdout)["executed_boxes"], 1)

    def test_what_cannot_be_is_refused_by_name(self):
        (Path(self.folder.name) / "other").mkdir()
        for words, name in ((("--tool-link", "tool0"), "--tool-link"), (("--arm", "arm.urdf", "--tool-link", "tool1"), "tool0"),
                            (("--arm", "none.urdf"), "none.urdf"), (("--arm", "arm.urdf", "--with", "bensh"), "bench"),
                            (("--arm", "arm.urdf", "-o", "other/placed.yaml"), "in the folder of"), (("--arm", "arm.urdf", "-o", "cell.yaml"), "-o"),
                            ((), "robot"), (("--keep", "all"), "aligner")):
            said = self.snug("cell", "place", "cell.yaml", *words, code=2).stderr
            self.assertIn(name, said)
        self.assertFalse((Path(self.folder.name) / "other" / "placed.yaml").exists())


# Of nine makers; a file is found by the end of its path, wherever it is in the folder.
MAKERS = {"UR10e": "universalUR10e.urdf", "UR5": "universalUR5.urdf", "KUKA KR 10 R1420": "kr10r1420.urdf", "ABB IRB 1600": "irb1600_6_12.urdf",
          "ABB IRB 2600": "irb2600_12_165.urdf", "FANUC LR Mate 200iD": "lrmate200id.urdf", "FANUC M-10iA": "m10ia.urdf",
          "Yaskawa MH5": "yaskawaMotomanMH5.urdf", "Staubli TX2-90": "tx2_90.urdf", "Doosan M1013": "m1013.white.urdf", "xArm 7": "xarm7.urdf",
          "KUKA LBR iiwa 14": "kukaIiwa14.urdf", "Franka FR3": "robots/fr3/fr3.urdf", "Franka Panda": "robots/panda/panda.urdf"}


def ten_boxes():
    """The shipped cell with three large boxes and seven small ones."""
    boxes = [("L" if number in (1, 4, 7) else "S", number) for number in range(1, 11)]
    types = {"L": "large", "S": "small"}
    text = CELL.read_text()
    return text[:text.index("parcels:")] + "\n".join(
        ["parcels:", *(f"  - {{id: {kind}{number}, type: {types[kind]}, material: box}}" for kind, number in boxes),
         "sequences:", "  - name: first", "    items:", *(f"      - {{parcel: {kind}{number}, up: Z}}" for kind, number in boxes)]) + "\n"


class Makers(unittest.TestCase):
    def test_arms_of_makers_are_placed_and_pack_nine_of_ten_boxes(self):
        if not os.environ.get("SNUG_URDF_FOLDER"):
            self.skipTest("SNUG_URDF_FOLDER does not name a folder of public URDF files")
        files = sorted(Path(os.environ["SNUG_URDF_FOLDER"]).rglob("*.urdf"))
        for name, file in MAKERS.items():
            with self.subTest(arm=name), tempfile.TemporaryDirectory() as folder:
                found = next((path for path in files if str(path).endswith("/" + file)), None)
                if found is None:
                    print(f"arms_test.py: {name}: no {file} in SNUG_URDF_FOLDER", flush=True)
                    continue
                (Path(folder) / "cell.yaml").write_text(ten_boxes())
                place = ["cell", "place", "cell.yaml", "--arm", str(found), "-o", "placed.yaml"]
                pack = ["pack", "placed.yaml", "--sequence", "first", "--samples", "0", "--json"]
                for words in (place, pack):
                    done = subprocess.run([SNUG, *words], cwd=folder, text=True, capture_output=True, timeout=1200, check=False)
                    self.assertEqual(done.returncode, 0, done.stdout[-1000:] + done.stderr[-1000:])
                result = json.loads(done.stdout)
                print(f"arms_test.py: {name}: {result['executed_boxes']} of 10 boxes", flush=True)
                self.assertGreaterEqual(result["executed_boxes"], 9)
                self.assertEqual(result["boxes_lost"], 0)


if __name__ == "__main__":
    unittest.main()
