"""What a worker of bench_peers answers (bench/peers/workers/protocol.py), with an engine that only falls."""

import json
import math
import pathlib
import subprocess
import sys
import unittest

WORKERS = pathlib.Path(__file__).resolve().parent.parent / "bench" / "peers" / "workers"

FALLING = f"""
import sys
sys.path.insert(0, {str(WORKERS)!r})
from protocol import Engine, serve

class Falling(Engine):
    def build(self, scene):
        self.rows = [(list(body["pose"]), [0.0] * 6) for body in scene["bodies"]]
    def step(self):
        print("what packages print")
        for pose, velocity in self.rows:
            velocity[2] += self.scene["dt"] * self.scene["gravity"][2]
            pose[2] += self.scene["dt"] * velocity[2]
    def push(self, body, force, torque):
        self.rows[body][1][0] += force[0] / self.scene["bodies"][body]["mass"] * self.scene["dt"]
    def set_motion(self, body, pose, velocity):
        self.rows[body] = (list(pose), list(velocity))
    def motion(self, body):
        return self.rows[body]

serve(Falling())
"""


def pose(z):
    return [0.0, 0.0, z, 1.0, 0.0, 0.0, 0.0]


SCENE = {
    "dt": 0.1,
    "gravity": [0.0, 0.0, -10.0],
    "bodies": [
        {"mass": 2.0, "pose": pose(1.0), "present": True},
        {"mass": 0.0, "pose": pose(5.0), "present": True},
        {"mass": 2.0, "pose": pose(2.0), "present": False},
    ],
}


class WorkerTest(unittest.TestCase):
    def setUp(self):
        self.worker = subprocess.Popen(
            [sys.executable, "-B", "-c", FALLING],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )

    def tearDown(self):
        self.worker.stdin.close()
        self.assertEqual(self.worker.wait(10), 0)
        self.worker.stdout.close()

    def ask(self, question):
        self.worker.stdin.write(json.dumps(question) + "\n")
        self.worker.stdin.flush()
        return json.loads(self.worker.stdout.readline())

    def test_steps_move_what_is_free_and_hold_what_is_absent(self):
        self.ask({"build": SCENE})
        state = self.ask({"do": [{"steps": 2}]})
        self.assertAlmostEqual(state["poses"][0][2], 1.0 - 0.1 - 0.2)
        self.assertAlmostEqual(state["velocities"][0][2], -2.0)
        self.assertEqual(state["poses"][1], pose(5.0))
        self.assertGreater(state["poses"][2][2], 98.0)  # held where it waits, but for one step of falling
        self.assertFalse(state["failed"])

    def test_a_body_that_is_followed_is_told_after_each_step(self):
        self.ask({"build": SCENE})
        state = self.ask({"do": [{"steps": 1}, {"steps": 2, "follow": 0}]})
        self.assertEqual(len(state["path"]), 2)
        self.assertAlmostEqual(state["path"][0][2], 1.0 - 0.1 - 0.2)
        self.assertEqual(state["path"][1], state["poses"][0])
        self.assertNotIn("path", self.ask({"do": [{"steps": 1}]}))

    def test_a_path_ends_where_numbers_do(self):
        self.ask({"build": SCENE})
        lost = {"set": 0, "pose": pose(1.0), "velocity": [0.0, 0.0, 1e308, 0.0, 0.0, 0.0]}
        state = self.ask({"do": [lost, {"steps": 200, "follow": 0}]})
        self.assertTrue(all(math.isfinite(x) for row in state["path"] for x in row))
        self.assertEqual(len(state["path"]), 17)  # of 1e307 m each: the next is beyond the largest number
        self.assertTrue(state["failed"])

    def test_acts_are_done_in_their_order(self):
        self.ask({"build": SCENE})
        entering = {"insert": 2, "pose": pose(3.0), "velocity": [0.0] * 6}
        push = {"push": 2, "force": [4.0, 0.0, 0.0], "torque": [0.0] * 3}
        state = self.ask({"do": [entering, push, {"steps": 1}]})
        self.assertAlmostEqual(state["poses"][2][2], 2.9)
        self.assertAlmostEqual(state["velocities"][2][0], 0.2)

    def test_bodies_that_are_not_solid_are_refused_where_an_engine_takes_none(self):
        hollow = {**SCENE, "bodies": [{**SCENE["bodies"][0], "moments": [1.0, 1.0, 1.0], "middle": [0.0, 0.0, 0.0]}]}
        self.assertIn("solid bodies alone", self.ask({"build": hollow})["error"])

    def test_time_starts_anew_with_a_scene(self):
        self.ask({"build": SCENE})
        self.assertGreater(self.ask({"do": [{"steps": 50}]})["cpu"], 0.0)
        self.assertEqual(self.ask({"build": SCENE})["cpu"], 0.0)

    def test_what_is_no_number_is_a_failure(self):
        self.ask({"build": SCENE})
        state = self.ask({"do": [{"set": 0, "pose": pose(float("nan")), "velocity": [0.0] * 6}, {"steps": 1}]})
        self.assertTrue(state["failed"])
        self.assertEqual(state["poses"][0], pose(1.0))

    def test_an_engine_need_not_tell_forces(self):
        self.ask({"build": SCENE})
        self.assertEqual(self.ask({"normal_force": [0, 1]}), {"normal_force": None})

    def test_an_error_is_an_answer(self):
        self.assertIn("AttributeError", self.ask({"do": [{"steps": 1}]})["error"])
        self.assertIn("poses", self.ask({"build": SCENE}))


if __name__ == "__main__":
    unittest.main()
