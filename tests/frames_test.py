#!/usr/bin/env python3
"""frames_test.py: a served cell, its camera and who packs it, each a program of its own. SNUG names the program."""
import json
import os
import re
import shlex
import subprocess
import tempfile
import threading
import time
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = str(ROOT / "scenarios" / "box-demonstrator.yaml")
ORDERS = ("order,article,length_mm,width_mm,height_mm,mass_kg,count,upright_only,no_stack,max_load_kg\n"
          "two,cup,120,110,105,0.5,1,0,0,\ntwo,tray,180,150,60,0.6,1,0,0,\none,cup,120,110,105,0.5,1,0,0,\n")
QUICK = ("--samples", "0", "--decision-time", "0.02")


def snug(*words, timeout=300):
    return subprocess.run([SNUG, *map(str, words)], text=True, capture_output=True, timeout=timeout, check=False)


class Frames(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.items = self.folder / "orders.csv"
        self.items.write_text(ORDERS)
        self.cell = (CELL, "--items", self.items, "--sequence", "one")

    def serve(self, *words):
        endpoint = f"ipc://{self.folder}/cell"
        said = open(self.folder / "said", "w+", encoding="utf-8")
        self.addCleanup(said.close)
        process = subprocess.Popen([SNUG, "serve", *map(str, self.cell), "--click", endpoint, "--once", "--json", *words], text=True,
                                   stdout=subprocess.PIPE, stderr=said)
        self.addCleanup(process.stdout.close)
        self.addCleanup(lambda: process.poll() is not None or (process.terminate(), process.wait(60)))
        deadline = time.monotonic() + 60
        while not Path(self.folder, "cell").exists():
            self.assertTrue(process.poll() is None and time.monotonic() < deadline, Path(said.name).read_text())
            time.sleep(0.02)
        return process, endpoint

    def camera(self, endpoint, *words):
        """The command of a camera that is `snug` itself."""
        return " ".join(shlex.quote(str(word)) for word in (SNUG, "camera", *self.cell, "--click", endpoint, *words))

    def pack(self, frames, *words):
        return snug("pack", *self.cell, "--plant", f"click+ipc://{self.folder}/cell", *QUICK, "--perception", "frames",
                    "--frames", frames, "--json", *words)

    def test_three_programs_pack_the_cell(self):
        self.cell = (CELL, "--items", self.items, "--sequence", "two")
        process, endpoint = self.serve("--plant-seed", "7")
        packed = self.pack(self.camera(endpoint, "--shot", "{look}", "-o", "{frame}.png"), "--log", self.folder / "log")
        self.assertEqual(packed.returncode, 0, packed.stderr)
        result, run = json.loads(packed.stdout), json.loads(process.stdout.read())
        self.assertEqual((result["executed_boxes"], result["perception"]), (2, "frames"))
        self.assertEqual([box["state"] for box in run["boxes"]], ["packed", "packed"])
        looks = [json.loads(line) for line in (self.folder / "log").read_text().splitlines() if '"perceived"' in line.lower()]
        self.assertGreater(len(looks), 4)
        self.assertEqual(process.wait(60), 0)

    def test_frames_in_a_folder_are_taken_with_what_lies_beside_them(self):
        process, endpoint = self.serve("--plant-seed", "7")
        place, stop = self.folder / "frames", threading.Event()
        place.mkdir()
        done, codes = set(), []

        def shoot():
            while not stop.is_set():
                request = place / "look.json"
                look = json.loads(request.read_text())["look"] if request.exists() else 0
                if look == 0 or look in done:
                    time.sleep(0.01)
                    continue
                done.add(look)
                # .ply in the world, .h5: names of their own, put there whole by `snug camera` itself
                ending = (".ply", ".h5")[look % 2]
                codes.append(subprocess.run(shlex.split(self.camera(endpoint, "--shot", look, "-o", place / f"{look:04}{ending}")),
                                            capture_output=True, check=False).returncode)

        thread = threading.Thread(target=shoot)
        thread.start()
        packed = self.pack(place)
        stop.set()
        thread.join()
        self.assertEqual(packed.returncode, 0, packed.stderr)
        self.assertEqual(json.loads(packed.stdout)["executed_boxes"], 1)
        self.assertEqual(set(codes), {0})
        self.assertEqual(process.wait(60), 0)

    def test_a_camera_that_gives_no_frame_ends_the_session_with_its_reason(self):
        process, _ = self.serve()
        packed = self.pack("sh -c 'echo \"\\033[1mno light\" >&2; exit 4'")
        self.assertEqual(packed.returncode, 1, packed.stderr)
        self.assertIn("no frame: the command ended with exit code 4: \\x1b[1mno light", packed.stderr)
        self.assertNotIn("\033", packed.stderr)
        self.assertEqual(json.loads(packed.stdout)["stop_reason"], "no frame")
        self.assertEqual(process.wait(60), 0)

    def test_words_that_cannot_be_are_refused_before_anything_moves(self):
        for words, part in ((("--perception", "frames"), "--frames"),
                            (("--perception", "frames", "--frames", "true"), "a cell that a camera can see"),
                            (("--frames", "true"), "--perception frames"),
                            (("--plant", "click://127.0.0.1:9", "--perception", "frames", "--frames", "no-such-program x"),
                             "no program 'no-such-program'"),
                            (("--plant", "click://127.0.0.1:9", "--perception", "frames", "--frames", "cat x | y"), "no shell")):
            with self.subTest(words=words):
                result = snug("pack", *self.cell, *words)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertTrue(re.search(re.escape(part), result.stderr), result.stderr)


if __name__ == "__main__":
    unittest.main()
