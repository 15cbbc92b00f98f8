#!/usr/bin/env python3
"""arms_test.py: robots that turn their tool about the vertical alone pack boxes that hang askew. SNUG names the program."""
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


class Arms(unittest.TestCase):
    def test_a_gantry_packs_a_box_whose_centre_of_mass_is_beside_the_cup(self):
        with tempfile.TemporaryDirectory() as folder:
            cell = Path(folder) / "cell.yaml"
            text = CELL.read_text().replace("{id: L1, type: large,", "{id: L1, type: large, com: [0.03, 0.01, 0.0],")
            text = re.sub(r"      - {parcel: (?!L1).*\n", "", text)
            cell.write_text(text + ROBOT)
            (Path(folder) / "gantry.urdf").write_text(GANTRY)
            words = ["pack", str(cell), "--sequence", "first", "--samples", "0", "--decision-time", "0.05", "--json"]
            done = subprocess.run([SNUG, *words], text=True, capture_output=True, timeout=600, check=False)
            self.assertEqual(done.returncode, 0, done.stderr)
            result = json.loads(done.stdout)
            self.assertEqual(result["robot"], "gantry")
            self.assertEqual((result["executed_boxes"], result["boxes_lost"]), (1, 0), result["stopped"])


if __name__ == "__main__":
    unittest.main()
