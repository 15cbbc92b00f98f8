#!/usr/bin/env python3
"""plant_test.py: a session packs a cell that another process serves: the same as in one process, and what is said when that fails.
SNUG names the program."""
import json
import os
import re
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
QUICK = ("--samples", 0, "--decision-time", 0.02)
ITEMS = """parcel_types:
  - {name: brick, size: [0.11, 0.12, 0.1], mass: 0.4}
parcels:
  - {id: b1, type: brick, material: box}
  - {id: b2, type: brick, material: box}
sequences:
  - name: two
    items: [{parcel: b1, up: Z}, {parcel: b2, up: X}]
  - name: one
    items: [{parcel: b1, up: Z}]
"""


# What only a plant that is simulated here tells of its motions.
TRUTH = ("hold_factor", "swing_mm", "swing_deg", "joint_speed_share", "joint_acceleration_share")


class ServedPlant(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.items = self.folder / "items.yaml"
        self.items.write_text(ITEMS)

    def serve(self, *words, endpoint="tcp://127.0.0.1:*"):
        """`snug serve` in a process of its own, and the address of the plant in it."""
        said = self.folder / "said.txt"
        with said.open("w") as stderr:
            process = subprocess.Popen([SNUG, "serve", CELL, "--items", self.items, "--click", endpoint, *map(str, words)],
                                       text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=stderr)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        for _ in range(600):
            found = re.search(r" at (tcp|ipc)(://\S+) \(", said.read_text())
            if found:
                return process, {"tcp": "click", "ipc": "click+ipc"}[found[1]] + found[2]
            self.assertIsNone(process.poll(), said.read_text())
            time.sleep(0.05)
        self.fail("it does not serve: " + said.read_text())

    def pack(self, *words, sequence="two"):
        return subprocess.run([SNUG, "pack", CELL, "--items", self.items, "--sequence", sequence, *map(str, QUICK + words), "--json"],
                              text=True, capture_output=True, timeout=1100)

    @staticmethod
    def comparable(packed):
        """Without what tells the plants apart, what only a plant's truth knows, and wall clocks."""
        if isinstance(packed, dict):
            return {key: ServedPlant.comparable(value) for key, value in packed.items()
                    if key not in ("plant", "plant_seed", "state_hash", *TRUTH, "planning_wait", "boxes_per_hour_with_planning")
                    and "seconds" not in key}
        return [ServedPlant.comparable(one) for one in packed] if isinstance(packed, list) else packed

    def test_two_processes_do_what_one_does_to_the_last_bit(self):
        for seed, perception, ipc in ((7, "exact", False), (0, "noisy", True), (3, "camera", True)):
            with self.subTest(seed=seed):
                endpoint = f"ipc://{self.folder}/cell" if ipc else "tcp://127.0.0.1:*"
                process, address = self.serve("--sequence", "two", "--plant-seed", seed, "--once", "--json", endpoint=endpoint)
                plan = self.folder / "plan.json"
                words = ("--perception", perception, "--plant-seed", seed)
                served = self.pack("--plant", address, *words, "--plan", plan)
                self.assertEqual(served.returncode, 0, served.stderr)
                run = json.loads(process.stdout.read())
                alone = self.pack(*words)
                self.assertEqual(alone.returncode, 0, alone.stderr)
                packed, expected = json.loads(served.stdout), json.loads(alone.stdout)
                self.assertEqual(self.comparable(packed), self.comparable(expected))
                self.assertEqual(run["state_hash"], expected["state_hash"], "the served cell is where the other one is")
                self.assertEqual([box["state"] for box in run["boxes"]], ["packed", "packed"])
                self.assertEqual((packed["plant"], packed["plant_seed"], packed["state_hash"]), (address, None, None))
                self.assertEqual(packed["executed_boxes"], 2)
                self.assertEqual(len(json.loads(plan.read_text())["placements"]), 2)

    def test_a_cell_served_for_any_controller_is_packed_too(self):
        process, address = self.serve("--sequence", "one", "--once", "--json")
        served = self.pack("--plant", address, sequence="one")
        self.assertEqual(served.returncode, 0, served.stderr)
        self.assertEqual(json.loads(served.stdout)["executed_boxes"], 1)
        run = json.loads(process.stdout.read())
        self.assertEqual((run["boxes"][0]["state"], run["ended_by"]), ("packed", "reset by the controller"))

    def test_a_server_that_dies_ends_the_session_with_a_reason_and_leaves_a_whole_recording(self):
        recording = self.folder / "run.h5"
        process, address = self.serve("--sequence", "two", "--plant-seed", 7, "--once", "--speed", 4, "-o", recording)
        packing = subprocess.Popen([SNUG, "pack", CELL, "--items", self.items, "--sequence", "two", "--plant", address,
                                    *map(str, QUICK), "--plant-timeout", "1", "--json"], text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(2.0)  # 8 s of simulated time: in the midst of it, or before it on a slow machine
        process.send_signal(signal.SIGINT)
        out, err = packing.communicate(timeout=60)
        self.assertEqual(process.wait(60), 0)
        self.assertEqual(packing.returncode, 2 if not out else 1, err)
        self.assertIn("nobody answers within 1 s", err)
        if out:
            self.assertEqual(json.loads(out)["stop_reason"], "plant fault")
            page = subprocess.run([SNUG, "report", recording, "-o", self.folder / "out.html"], capture_output=True)
            self.assertEqual(page.returncode, 0, page.stderr)

    def test_a_session_that_dies_leaves_the_server_a_whole_run(self):
        recording = self.folder / "run.h5"
        process, address = self.serve("--sequence", "two", "--plant-seed", 7, "--once", "--speed", 4, "--json", "-o", recording)
        packing = subprocess.Popen([SNUG, "pack", CELL, "--items", self.items, "--sequence", "two", "--plant", address,
                                    *map(str, QUICK)], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.assertTrue(packing.stdout.read(1), "it is connected when it prints its head")
        time.sleep(1.5)
        packing.kill()
        packing.communicate()
        run = json.loads(process.communicate(timeout=120)[0])
        self.assertEqual((run["ended_by"], run["failure"]), ("the controller left", ""))
        page = subprocess.run([SNUG, "report", recording, "-o", self.folder / "out.html"], capture_output=True)
        self.assertEqual(page.returncode, 0, page.stderr)

    def test_what_is_no_such_plant_is_refused(self):
        def assert_refused(result, *parts):
            self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
            for part in parts:
                self.assertIn(part, result.stderr)
        assert_refused(self.pack("--plant", "click://127.0.0.1:1", "--plant-timeout", 0.3), "--plant", "nobody answers within 0.3 s")
        for address in ("tcp://127.0.0.1:5555", "click://", "click://host", "elsewhere"):
            assert_refused(self.pack("--plant", address), "--plant", "click://HOST:PORT")
        _, address = self.serve("--sequence", "one", "--plant-seed", 7)
        assert_refused(self.pack("--plant", address), "--plant", "it has no object 'b2'")
        for words in (("--fault", "drop@1"), ("--robot", "none")):
            assert_refused(self.pack("--plant", address, *words), words[0])

    def test_a_camera_packs_what_it_sees_and_has_to_be_there(self):
        packed = json.loads(self.pack("--perception", "camera").stdout)
        self.assertEqual((packed["perception"], packed["executed_boxes"], packed["items_as_planned"]), ("camera", 2, 2))
        self.assertNotEqual(packed["items"][0]["believed"], json.loads(self.pack().stdout)["items"][0]["believed"])
        blind = self.folder / "blind.yaml"
        blind.write_text(re.sub(r"(?ms)^cameras:.*?^(?=#|\w)", "", CELL.read_text())
                         .replace("robots/", f"{CELL.parent}/robots/"))
        result = subprocess.run([SNUG, "pack", blind, "--sequence", "1", "--perception", "camera", "--robot", "none"], text=True,
                                capture_output=True)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("cameras", result.stderr)

    def test_a_cell_that_runs_by_itself_is_no_plant(self):
        process, address = self.serve("--sequence", "one", "--plant-seed", 7, "--async")
        served = self.pack("--plant", address, sequence="one")
        self.assertEqual(served.returncode, 1, served.stderr)
        self.assertIn("--async", served.stderr)


if __name__ == "__main__":
    unittest.main()
