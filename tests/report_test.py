"""The demonstrator's form of the errors between a simulation and its experiment, beside an independent port of its rules (report_rules.py)."""
import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import report_rules

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ["SNUG"]
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
# Boxes of the items below, with the time in which each is handled.
WINDOWS = {"BOX027": (0.5, 5.8), "BOX013": (5.8, 11.3), "BOX017": (11.3, 14.3)}
UNITS = {"rest_position": ("rest_position_mm", 1e3), "rest_rotation": ("rest_rotation_deg", 180.0 / math.pi), "rms_position": ("rms_position_mm", 1e3),
         "rms_rotation": ("rms_rotation_deg", 180.0 / math.pi), "rms_force": ("rms_force_N", 1.0), "rms_torque": ("rms_torque_Nm", 1.0)}
# Noise and losses of the demonstrator's sensors; clocks and bias are known, as its analysis sets them by hand.
SENSORS = """motion_capture: {rate: 360.0, position_noise: 1.0e-4, rotation_noise_deg: 0.1, position_error: 3.0e-4, rotation_error_deg: 0.15, dropout_rate: 0.1,
  dropout_duration: 0.15, when_lost: WHEN}
force_torque: {rate: 500.0, force_noise: 0.3, torque_noise: 0.01}
encoders: {rate: 125.0, position_noise: 2.0e-5, velocity_noise: 1.0e-3, tool_position_noise: 3.0e-5, tool_rotation_noise_deg: 0.003}
"""


class ReportForm(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.path = Path(scratch.name)

    def run_snug(self, *words):
        done = subprocess.run([SNUG, *map(str, words)], capture_output=True, text=True, check=False, timeout=600)
        self.assertEqual(done.returncode, 0, f"{words}: {done.stderr[-2000:]}")
        return done.stdout

    def measured(self, when_lost):
        """What the program says of its report form, and the tables of both sides."""
        folder = self.path / when_lost
        (folder / "sensors.yaml").parent.mkdir()
        (folder / "sensors.yaml").write_text(SENSORS.replace("WHEN", when_lost), encoding="utf-8")
        (folder / "windows.csv").write_text("body,start_s,end_s\n" + "".join(f"{body},{start},{end}\n" for body, (start, end) in WINDOWS.items()), encoding="utf-8")
        self.run_snug("measure", self.path / "real.h5", "--sensors", folder / "sensors.yaml", "--seed", 3, "-o", folder / "measured.h5")
        self.run_snug("archive", "convert", folder / "measured.h5", "-o", folder / "tables")
        said = json.loads(self.run_snug("validate", "--simulated", self.path / "simulated.h5", "--measured", folder / "measured.h5", "--windows", folder / "windows.csv",
                                        "--shift", "mocap=0", "--shift", "ft=0", "--shift", "robot=0", "--json"))
        tables = {kind: report_rules.read_table(next((folder / "tables").glob(f"*-{kind}.csv"))) for kind in ("mocap", "ft")}
        return {body["body"]: body["report"] for body in said["bodies"]}, tables

    def test_report_form_of_three_boxes_is_that_of_an_independent_port_within_one_percent(self):
        items = "".join(f"      - {{parcel: {box}, up: {'X' if box == 'BOX013' else 'Z'}}}\n" for box in WINDOWS)
        cell = self.path / "cell.yaml"
        text = CELL.read_text(encoding="utf-8").replace("urdf: robots/", f"urdf: {CELL.parent}/robots/")
        cell.write_text(text.replace("\nsequences:\n", f"\nsequences:\n  - name: three\n    items:\n{items}", 1), encoding="utf-8")
        words = ("--sequence", "three")
        self.run_snug("pack", cell, *words, "--robot", "none", "--plant-seed", 0, "--samples", 0, "--decision-time", 0.2, "--program", self.path / "program.csv")
        words = ("simulate", cell, "--program", self.path / "program.csv", "--controller", "fast", *words)
        self.run_snug(*words, "-o", self.path / "simulated.h5")
        self.run_snug(*words, "--set", "cup.stiffness.lateral=1900", "--set", "cup.stiffness.bend=3.5", "--set", "contacts.pairs.box/container.friction=0.35",
                      "-o", self.path / "real.h5")
        self.run_snug("export", self.path / "simulated.h5", "--format", "csv", "-o", self.path / "simulated.csv")
        simulation = report_rules.read_table(self.path / "simulated.csv")
        for when_lost in ("missing", "held"):
            said, tables = self.measured(when_lost)
            for body, (start, end) in WINDOWS.items():
                port = report_rules.compare(simulation, tables["mocap"], tables["ft"], body.lower(), f"Box{body[3:]}", start, end)
                for name, (key, unit) in UNITS.items():
                    with self.subTest(when_lost=when_lost, body=body, error=name):
                        found, expected = said[body][key]["mean"], unit * port[name]
                        self.assertLess(abs(found - expected), 0.01 * expected, f"{found} of {expected}")


if __name__ == "__main__":
    unittest.main()
