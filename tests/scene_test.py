#!/usr/bin/env python3
"""scene_test.py: scenes without a program on the command line: failures that are said, bodies lost, runs that go on."""
import json
import tempfile
import unittest
from pathlib import Path

from cli_test import ROOT, CommandLine, snug

SCENES = ROOT.parent / "shared" / "data" / "scenes"

TOP = """name: test
duration: {duration}
materials: [{{name: m}}]
contacts: {{default: {{friction: 0.4, restitution: 0.1}}}}
bodies:
- {{name: floor, kind: static, size: [20, 20, 1], material: m, pose: {{position: [0, 0, -0.5]}}}}
"""


class Scenes(unittest.TestCase):
    assert_refused = CommandLine.assert_refused

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def scene(self, *lines, duration=1.0):
        path = self.folder / "scene.yaml"
        path.write_text(TOP.format(duration=duration) + "\n".join(lines) + "\n")
        return path

    def simulate_failing(self, name):
        scene = SCENES / name
        if not scene.exists():
            self.skipTest("no folder ../shared beside the project: public scenes not run")
        record = self.folder / "run.h5"
        result = snug("simulate", scene, "--json", "-o", record)
        self.assertEqual(result.returncode, 1, result.stderr)
        data = json.loads(result.stdout)
        self.assertIn(data["failure"], result.stderr)
        self.assertIn("deep contact", [event["kind"] for event in data["events"]])
        page = self.folder / "page.html"
        self.assertEqual(snug("report", record, "-o", page).returncode, 0)
        self.assertIn("failed", snug("simulate", scene).stdout)
        return data

    def test_a_crushed_box_is_a_failure_with_a_whole_result(self):
        data = self.simulate_failing("squeeze.yaml")
        self.assertRegex(data["failure"], r"rigid bodies '.*' and '.*' were [\d.]+ mm deep .* t = .*rigid_depth")
        self.assertAlmostEqual(data["duration_s"], 2.0, places=9)
        self.assertEqual([body["name"] for body in data["bodies"]], ["b"])
        self.assertEqual(data["solver"]["worst_compliant_penetration_mm"], 0)

    def test_a_body_that_falls_through_a_soft_floor_is_a_failure(self):
        data = self.simulate_failing("compliant_capsule_through_floor.yaml")
        self.assertIn("'tote'", data["failure"])
        self.assertEqual(data["solver"]["worst_penetration_mm"], 0)
        self.assertGreater(data["solver"]["worst_compliant_penetration_mm"], 20)

    def test_a_compliant_body_starts_at_its_equilibrium(self):
        scene = SCENES / "compliant_equilibrium_rejected.yaml"
        if not scene.exists():
            self.skipTest("no folder ../shared beside the project: public scenes not run")
        result = snug("simulate", scene, "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        body = json.loads(result.stdout)["bodies"][0]
        self.assertAlmostEqual(body["X_WB"]["p"][2], 0.05 - 20 * 9.81 / 12000, places=5)

    def test_a_body_thrown_out_of_the_cell_is_an_outcome(self):
        scene = self.scene(
            "- {name: b, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 0.05]}}",
            "- {name: thrown, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {position: [0, 0, 9]}, "
            "twist: {linear: [990, 0, 30]}}", duration=2.0)
        record = self.folder / "run.h5"
        result = snug("simulate", scene, "--json", "-o", record)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        data = json.loads(result.stdout)
        self.assertEqual([(lost["body"], round(lost["velocity_m_s"][0])) for lost in data["lost"]], [("thrown", 990)])
        self.assertEqual([body["name"] for body in data["bodies"]], ["b"])
        self.assertIn("out of the cell    thrown", snug("simulate", scene).stdout)

    def test_too_many_pairs_leave_a_whole_result(self):
        bodies = [f"- {{name: b{i}, size: [0.1, 0.1, 0.1], mass: 1, material: m, pose: {{position: [0, 0, 1]}}, "
                  f"appears_at: 0.1}}" for i in range(130)]
        result = snug("simulate", self.scene(*bodies), "--json", "-o", self.folder / "run.h5")
        self.assertEqual(result.returncode, 1)
        data = json.loads(result.stdout)
        self.assertIn("too many pairs of bodies", data["failure"])
        self.assertEqual(len(data["bodies"]), 130)
        self.assertAlmostEqual(data["duration_s"], 0.1, delta=0.01)

    def test_a_run_goes_on_from_a_recording(self):
        scene = self.scene(
            "- {name: b, size: [0.1, 0.2, 0.1], mass: 1, material: m, pose: {position: [0, 0, 9]}, "
            "twist: {linear: [1, 0, 3], angular: [2, 0, 1]}}", duration=1.0)
        record = self.folder / "run.h5"
        whole = json.loads(snug("simulate", scene, "--json", "-o", record, "--record-period", 0.1).stdout)
        for words in ([], ["--resume-at", 0.5]):
            until = [] if words else ["--until", 1.5]
            rest = json.loads(snug("simulate", scene, "--resume", record, "--json", *words, *until).stdout)
            self.assertEqual(rest["duration_s"], 1.5 if until else 1.0)
            if words:
                for mine, theirs in zip(rest["bodies"][0]["X_WB"]["p"], whole["bodies"][0]["X_WB"]["p"]):
                    self.assertAlmostEqual(mine, theirs, places=12)
        self.assert_refused(snug("simulate", scene, "--resume", record, "-o", record, "--until", 2), "-o", "continue from")
        self.assert_refused(snug("simulate", scene, "--resume-at", 1), "--resume-at")
        self.assert_refused(snug("simulate", scene, "--resume", record), "before the end of the run")
        self.assert_refused(snug("simulate", scene, "--resume", self.folder / "no.h5", "--until", 2), "no.h5")

    def test_a_conveyor_brings_a_carton_and_a_can_to_a_ramp(self):
        record = self.folder / "run.h5"
        result = snug("simulate", ROOT / "scenarios" / "conveyor.yaml", "--json", "-o", record)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        data = json.loads(result.stdout)
        self.assertEqual((data["warnings"], data["solver"]["not_converged"]), ([], 0))
        for body in data["bodies"]:  # off the belt, at the foot of the ramp
            self.assertLess(body["X_WB"]["p"][1], -0.25, body)
            self.assertLess(body["X_WB"]["p"][2], 0.2, body)
        self.assertEqual(snug("report", record, "-o", self.folder / "page.html").returncode, 0)
        self.assertEqual(snug("export", record, "--format", "mcap", "-o", self.folder / "run.mcap").returncode, 0)

    def test_contact_forces_at_the_end_carry_the_weight(self):
        scene = self.scene("- {name: b, size: [0.1, 0.2, 0.1], mass: 3, material: m, pose: {position: [0, 0, 0.05]}}")
        contacts = json.loads(snug("simulate", scene, "--json").stdout)["contacts"]
        self.assertEqual(len(contacts), 4)
        self.assertEqual({tuple(contact["bodies"]) for contact in contacts}, {("floor", "b")})
        self.assertAlmostEqual(sum(contact["force_N"][2] for contact in contacts), 3 * 9.81, delta=0.05)


class Rolling(unittest.TestCase):
    """A solid cylinder and a ball of 50 mm roll from 0.5 m/s; the cylinder stops after 1.5 v^2 r / (2 g rho)."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "roll.yaml"

    def roll(self, law):
        text = TOP.format(duration=6.0).replace("friction: 0.4, restitution: 0.1", f"friction: 0.4, restitution: 0.1, {law}")
        text += """- {name: roll, shapes: [{cylinder: {length: 0.2, radius: 0.05}}], mass: 0.4, material: m,
   pose: {position: [0, 0, 0.05], rpy_deg: [90, 0, 0]}, twist: {linear: [0.5, 0, 0], angular: [0, 10, 0]}}
- {name: top, shapes: [{capsule: {length: 0, radius: 0.05}}], mass: 0.4, material: m,
   pose: {position: [0, 2, 0.05]}, twist: {angular: [0, 0, 20]}}
"""
        self.path.write_text(text)
        return snug("simulate", self.path, "--json")

    def test_what_rolls_and_what_spins_come_to_rest(self):
        result = self.roll("rolling_resistance: 2.0e-3, torsional_friction: 5.0e-4")
        self.assertEqual(result.returncode, 0, result.stderr)
        roll, top = json.loads(result.stdout)["bodies"]
        self.assertAlmostEqual(roll["X_WB"]["p"][0], 1.5 * 0.5**2 * 0.05 / (2 * 9.81 * 2e-3), delta=1e-4)
        self.assertEqual([roll["speed_m_s"], top["speed_m_s"]], [0, 0])

    def test_without_it_they_go_on(self):
        result = self.roll("rolling_resistance: 0")
        self.assertAlmostEqual(json.loads(result.stdout)["bodies"][0]["X_WB"]["p"][0], 3.0, delta=1e-4)

    def test_negative_lengths_are_refused(self):
        result = self.roll("rolling_resistance: -1.0e-3")
        self.assertEqual(result.returncode, 2)
        self.assertIn("rolling_resistance", result.stderr)


class Plates(unittest.TestCase):
    """Ten plates of 190 x 140 x 8 mm for a tote of 200 x 150 x 60 mm: seven fit."""

    def pack(self, law):
        text = (ROOT / "scenarios" / "init" / "cell.yaml").read_text()
        text = text.replace("inner_size: [0.400, 0.300, 0.200]", "inner_size: [0.200, 0.150, 0.060]")
        text = text.replace("stiffness: 2.5e4, damping: 50.0, full_area: 0.005", law)
        names = [f"P{i}" for i in range(10)]
        plates = "parcel_types:\n  - {name: plate, size: [0.190, 0.140, 0.008], mass: 0.2}\nparcels:\n"
        plates += "".join(f"  - {{id: {name}, type: plate, material: box}}\n" for name in names)
        before, _, after = text.partition("parcel_types:\n")
        text = before + plates + after[after.index("# In which order"):]
        text = text[:text.index("    items:\n")] + "    items:\n" + "".join(f"      - {{parcel: {name}, up: Z}}\n" for name in names)
        text += "uncertainty: {size: 0.0, size_common: 0.0, contact_stiffness: 0.0, clearance: 0.0}\n"
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "plates.yaml"
            path.write_text(text)
            result = snug("pack", path, "--sequence", "first", "--samples", "0", "--json")
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_soft_plates_fill_at_most_what_fits(self):
        data = self.pack("stiffness: 2.5e4, damping: 50.0, full_area: 0.005")
        self.assertEqual(data["executed_boxes"], 7)
        self.assertAlmostEqual(data["executed_percent"], 100 * 7 * 0.190 * 0.140 * 0.008 / (0.200 * 0.150 * 0.060), places=6)
        self.assertEqual(data["items_as_planned"], data["items_sent"])


if __name__ == "__main__":
    unittest.main()
