#!/usr/bin/env python3
"""ui_test.py: `snug ui` by its interface, with a robot behind it. SNUG names the program."""
import http.client
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from urllib.parse import urlparse

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
sys.path.insert(0, str(ROOT / "tests"))
sys.dont_write_bytecode = True
import cut_robot  # noqa: E402
import ur_test  # noqa: E402

SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
ORDERS = "order,length_mm,width_mm,height_mm,mass_kg,count\none,110,120,100,0.4,2\n"


class Page:
    """`snug ui` in a folder, asked as its page asks."""

    def __init__(self, folder):
        self.process = subprocess.Popen([SNUG, "ui", str(folder), "--no-open"], text=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        self.address = None
        for line in self.process.stderr:
            found = re.search(r"showing at (\S+)", line)
            if found:
                self.address = urlparse(found.group(1))
                break

    def ask(self, method, path, body=None):
        connection = http.client.HTTPConnection(self.address.hostname, self.address.port, timeout=60)
        headers = {"X-Snug": "1", "Content-Type": "text/plain"}
        text = body if isinstance(body, str) else json.dumps(body)
        connection.request(method, f"/api/1/{path}?{self.address.query}", body=None if body is None else text.encode(), headers=headers)
        answer = connection.getresponse()
        said = json.loads(answer.read())
        connection.close()
        return answer.status, said

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(60)
        self.process.stderr.close()


class StopAtOnce(unittest.TestCase):
    def test_stop_at_once_leaves_a_moving_robot_that_stands(self):
        with tempfile.TemporaryDirectory() as name:
            folder, boxes = Path(name), f"ipc://{name}/boxes"
            (folder / "mine.csv").write_text(ORDERS, encoding="utf-8")
            page = Page(folder)
            self.addCleanup(page.end)
            begun = page.ask("GET", "templates/demonstrator")[1]
            self.assertEqual(page.ask("PUT", f"files/{begun['arm']['name']}", begun["arm"]["text"])[0], 200)
            self.assertEqual(page.ask("PUT", "files/cell.yaml", begun["text"])[0], 200)
            with ur_test.Served("--items", folder / "mine.csv", "--sequence", "one", "--plant-seed", 7, "--observers", boxes) as served:
                watch = cut_robot.Watch(served.offset)
                status, started = page.ask("POST", "runs", {"name": "r", "scenario": "cell.yaml", "items": "mine.csv", "sequence": "one", "plants": 1,
                                                            "plant": f"ur://127.0.0.1:{served.offset}", "observe": boxes})
                self.assertEqual(status, 201, started)
                self.assertTrue(watch.wait(lambda now: now[1] > 0.05, 120), "the robot moves")
                moving = watch.now()
                self.assertEqual(page.ask("POST", "runs/r/stop-now")[0], 200)
                self.assertTrue(watch.wait(lambda now: now[1] < cut_robot.STILL, 30), "the robot stands")
                stood = watch.now()
                # The answer takes its way too: what is held to 0.2 s of the robot's time is cut_robot.py's.
                self.assertLess(stood[0] - moving[0], 2.0)
                self.assertEqual(stood[2] & 1, moving[2] & 1, "the vacuum is as it was")
                end = time.monotonic() + 30
                while page.ask("GET", "runs/r")[1]["state"] != "ended early" and time.monotonic() < end:
                    time.sleep(0.1)
                self.assertEqual(page.ask("GET", "runs/r")[1]["state"], "ended early")
                self.assertTrue(all(watch.now()[1] < cut_robot.STILL for _ in range(5)), "it stays where it is")
                self.assertEqual(page.ask("POST", "runs/r/stop-now")[0], 409)
                watch.close()


if __name__ == "__main__":
    unittest.main()
