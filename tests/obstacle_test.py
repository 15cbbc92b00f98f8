#!/usr/bin/env python3
"""obstacle_test.py: something foreign in the container is seen by the camera, planned around, and in every output that tells of a session.
SNUG names the program."""
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"


# Edges of the scenario's boxes, by id, in m.
SIZES = {name: [float(edge) for edge in edges.split(",")]
         for name, edges in re.findall(r"id: (BOX\d+),.*?size: \[([^]]*)\]", CELL.read_text())}


def run(*words):
    return subprocess.run([SNUG, *map(str, words)], text=True, capture_output=True, timeout=1100)


def axes(quat_wxyz):
    """Rows of the rotation matrix of a unit quaternion."""
    w, x, y, z = quat_wxyz
    return ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
            (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
            (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))


def level_extent(pose, size):
    """Low and high corner of the level box around a box."""
    half = [0.5 * sum(abs(a) * edge for a, edge in zip(row, size)) for row in axes(pose["quat_wxyz"])]
    return [p - h for p, h in zip(pose["p"], half)], [p + h for p, h in zip(pose["p"], half)]


def overlap(a, b):
    """How deep two level boxes are in each other, or minus how far apart."""
    return min(min(ah, bh) - max(al, bl) for al, ah, bl, bh in zip(a[0], a[1], b[0], b[1]))


class Obstacle(unittest.TestCase):
    QUICK = ("--robot", "none", "--samples", 2, "--decision-time", 0.05, "--json")

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def pack(self, *words):
        result = run("pack", CELL, *self.QUICK, *words)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def test_a_foreign_object_is_seen_and_packed_around(self):
        recording = self.folder / "run.h5"
        packed = self.pack("--perception", "camera", "--fault", "object@3", "--sequence", 1, "-o", recording)
        self.assertGreaterEqual(packed["executed_boxes"], 8, "it packs on")
        self.assertEqual(len(packed["objects"]), 1)
        truth = packed["objects"][0]
        low, high = level_extent(truth["X_TB"], truth["size"])
        seen = packed["obstacles"][0]
        self.assertEqual((seen["number"], seen["gone"]), (1, None))
        self.assertGreater(seen["seen"], 0.0)
        for axis in range(2):  # whole columns of 5 mm, and points at its edges are lost
            self.assertAlmostEqual(seen["low_T"][axis], low[axis], delta=0.008)
            self.assertAlmostEqual(seen["high_T"][axis], high[axis], delta=0.008)
        self.assertAlmostEqual(seen["high_T"][2], high[2], delta=0.004)
        self.assertAlmostEqual(seen["height_mm"], 1e3 * seen["high_T"][2], delta=0.01)
        self.assertLess(truth["moved_mm"], 2.0)
        # What was planned after it was seen stays beside it or over it, as the boxes in truth do.
        later = [item for item in packed["items"] if item["placed"] and item["sends"][-1]["time"] > seen["seen"]]
        self.assertGreaterEqual(len(later), 3)
        true_poses = {box["id"]: box["X_TP"] for box in packed["boxes"]}
        for item in later:
            size = SIZES[item["box"]]
            planned = {"p": item["planned"]["position"], "quat_wxyz": item["planned"]["quaternion_wxyz"]}
            self.assertLess(overlap(level_extent(planned, size), (low, high)), 0.0, item)
            self.assertLess(overlap(level_extent(true_poses[item["box"]], size), (low, high)), 0.003, item)
        self.expect_frame(recording, packed["duration"])

    def expect_frame(self, recording, duration):
        """Label truth has the object, and the estimator alone reports it."""
        frame = self.folder / "frame.png"
        shot = run("camera", recording, "--time", duration, "-o", frame, "--json")
        self.assertEqual(shot.returncode, 0, shot.stderr)
        bodies = {body["name"]: body for body in json.loads(shot.stdout)["bodies"]}
        self.assertIn("object1", bodies)
        self.assertGreaterEqual(bodies["object1"]["pixels"], 0)
        self.assertTrue((self.folder / "frame-labels.png").exists())

    def test_it_is_forgotten_when_it_is_taken_out(self):
        packed = self.pack("--perception", "camera", "--fault", "object@1,clear@3", "--sequence", 2)
        self.assertFalse(packed["objects"][0]["is_in"])
        seen = packed["obstacles"][0]
        self.assertGreater(seen["gone"], seen["seen"])

    def test_dead_reckoning_does_not_see_it_and_exact_perception_does(self):
        for perception, count in (("dead-reckoning", 0), ("exact", 1), ("noisy", 1)):
            with self.subTest(perception):
                packed = self.pack("--perception", perception, "--fault", "object@1", "--skips", 0, "--sequence", 5)
                self.assertEqual(len(packed["obstacles"]), count)
                self.assertEqual(len(packed["objects"]), 1)


if __name__ == "__main__":
    unittest.main()
