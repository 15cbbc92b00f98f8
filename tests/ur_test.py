#!/usr/bin/env python3
"""ur_test.py: the served UR as its clients meet it: RTDE, dashboard and primary written by hand, and the wheel ur_rtde where it can be
imported. SNUG names the program."""
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

try:
    import rtde_control
    import rtde_io
    import rtde_receive
except ImportError:
    rtde_control = None

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True
import cut_robot  # noqa: E402

SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
DASHBOARD, PRIMARY, SECONDARY, REAL_TIME, RTDE = 29999, 30001, 30002, 30003, 30004


class Served:
    """`snug serve --ur` in a process of its own, at ports of its own, until it is left."""

    def __init__(self, *words, offset=None, address="127.0.0.1"):
        for self.offset in [offset] if offset is not None else range(2000 + os.getpid() % 200 * 100, 30000, 10):
            sequence = () if "--sequence" in words else ("--sequence", "1")
            self.process = subprocess.Popen([SNUG, "serve", str(CELL), *sequence, "--ur", address, "--ur-port-offset",
                                             str(self.offset), *map(str, words)], text=True,
                                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.said = []
            for line in self.process.stderr:
                self.said.append(line)
                if "serving" in line:
                    break
            if not any("in use" in line for line in self.said):
                break
            self.process.communicate()
        self.reader = threading.Thread(target=lambda: self.said.extend(self.process.stderr), daemon=True)
        self.reader.start()

    def connect(self, port):
        return socket.create_connection(("127.0.0.1", port + self.offset), timeout=10)

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        out = self.process.stdout.read()
        self.process.wait(60)
        self.reader.join(10)
        self.process.stdout.close()
        self.process.stderr.close()
        return out

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if not self.process.stdout.closed:
            self.end()


def receive(connection, count):
    data = b""
    while len(data) < count:
        more = connection.recv(count - len(data))
        if not more:
            raise ConnectionError("closed")
        data += more
    return data


class Rtde:
    """A client of RTDE, version 2."""

    def __init__(self, served):
        self.socket = served.connect(RTDE)
        assert self.ask(b"V", struct.pack(">H", 2)) == b"\x01"

    def send(self, kind, payload=b""):
        self.socket.sendall(struct.pack(">H", len(payload) + 3) + kind + payload)

    def frame(self):
        size, kind = struct.unpack(">Hc", receive(self.socket, 3))
        return kind, receive(self.socket, size - 3)

    def ask(self, kind, payload=b""):
        self.send(kind, payload)
        while True:
            got, answer = self.frame()
            if got == kind:
                return answer

    def outputs(self, names, frequency=0.0):
        return self.ask(b"O", struct.pack(">d", frequency) + names.encode())

    def inputs(self, names):
        return self.ask(b"I", names.encode())

    def close(self):
        self.socket.close()


class Dashboard:
    def __init__(self, served):
        with served.connect(DASHBOARD) as connection:
            self.file = connection.makefile("rw", newline="\n")
        self.greeting = self.file.readline()

    def close(self):
        self.file.close()

    def ask(self, line):
        self.file.write(line + "\n")
        self.file.flush()
        return self.file.readline().strip()

    def wait_for(self, question, answer, seconds=10):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if self.ask(question).startswith(answer):
                return True
            time.sleep(0.02)
        return False


class ServedUr(unittest.TestCase):
    def test_clients_by_hand_read_and_switch_the_robot(self):
        with Served() as served:
            rtde = Rtde(served)
            self.assertEqual(rtde.outputs("timestamp,actual_q,actual_digital_input_bits,actual_digital_output_bits,"),
                             b"\x01DOUBLE,VECTOR6D,UINT64,UINT64")
            self.assertEqual(rtde.inputs("standard_digital_output_mask,standard_digital_output"), b"\x01UINT8,UINT8")
            self.assertEqual(rtde.ask(b"S"), b"\x01")
            stamps = []
            rtde.send(b"U", b"\x01\x03\x01")
            while len(stamps) < 60:
                kind, payload = rtde.frame()
                self.assertEqual(kind, b"U")
                values = struct.unpack(">B7d2Q", payload)
                stamps.append(values[1])
            for before, after in zip(stamps, stamps[1:]):
                self.assertAlmostEqual(after - before, 0.008, places=9)  # no package is lost
            self.assertEqual(values[-1], 1)  # vacuum on
            self.assertEqual(values[-2], 2)  # a part is present
            other = Rtde(served)
            self.assertEqual(other.inputs("standard_digital_output"), b"\x00IN_USE")
            self.assertEqual(other.outputs("nothing"), b"\x00NOT_FOUND")
            rtde.close()
            other.close()
            dashboard = Dashboard(served)
            self.assertTrue(dashboard.greeting.startswith("Connected: "))
            self.assertEqual(dashboard.ask("power off"), "Powering off")
            self.assertTrue(dashboard.wait_for("robotmode", "Robotmode: POWER_OFF"))
            self.assertEqual(dashboard.ask("brake release"), "Brake releasing")
            self.assertTrue(dashboard.wait_for("robotmode", "Robotmode: RUNNING"))
            dashboard.close()
            primary = served.connect(PRIMARY)
            size, kind = struct.unpack(">iB", receive(primary, 5))
            self.assertEqual(kind, 20)
            receive(primary, size - 5)
            size, kind = struct.unpack(">iB", receive(primary, 5))
            self.assertEqual(kind, 16)
            self.assertLess(size, 2000)
            primary.close()
            self.assertIn("packed", served.end())

    def test_a_page_in_a_browser_moves_nothing(self):
        with Served() as served:
            for port in (DASHBOARD, PRIMARY, SECONDARY, REAL_TIME, RTDE):
                page = served.connect(port)
                page.sendall(b"POST / HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: text/plain\r\n\r\npower off\n")
                try:
                    while page.recv(4096):
                        pass
                except ConnectionError:
                    pass
                page.close()
            dashboard = Dashboard(served)
            self.assertEqual(dashboard.ask("robotmode"), "Robotmode: RUNNING")
            dashboard.close()

    def test_check_reads_a_robot_and_says_what_does_not_fit(self):
        for model, version in (("ur10", "3.15."), ("ur10e", "5.9.")):
            with Served("--model", model) as served:
                address = f"127.0.0.1:{served.offset}"
                check = [SNUG, "ur", "check", address, "--scenario", str(CELL)]
                fitting = subprocess.run([*check, "--json"], capture_output=True, text=True)
                self.assertEqual(fitting.returncode, 0, fitting.stdout + fitting.stderr)
                report = json.loads(fitting.stdout)
                self.assertTrue(report["fits"])
                self.assertTrue(report["version"].startswith(version))
                self.assertEqual({finding["verdict"] for finding in report["findings"]}, {"fits"})
                dashboard = Dashboard(served)
                dashboard.ask("power off")
                dashboard.close()
                time.sleep(0.3)
                off = subprocess.run(check, capture_output=True, text=True)
                self.assertEqual(off.returncode, 1, off.stderr)
                self.assertIn("POWER_OFF; needed: RUNNING", off.stdout)
                self.assertIn("release the brakes", off.stdout)
                whole = subprocess.run([SNUG, "ur", "check", "ur://" + address, "--scenario", str(CELL)], capture_output=True, text=True)
                self.assertEqual((whole.returncode, whole.stdout), (off.returncode, off.stdout))
            gone = subprocess.run([*check, "--timeout", "1"], capture_output=True, text=True)
            self.assertEqual(gone.returncode, 2)
        for address in ("127.0.0.1:", "127.0.0.1:x", "ur://", "127.0.0.1:99999"):
            refused = subprocess.run([SNUG, "ur", "check", address], capture_output=True, text=True)
            self.assertEqual((refused.returncode, refused.stdout), (2, ""))
            self.assertIn(address, refused.stderr)
            self.assertIn("HOST:N", refused.stderr)
            self.assertIn(f"127.0.0.1 port {30001 + served.offset}", gone.stderr)

    def test_dashboard_plays_the_programs_of_a_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "hold.script").write_text("def hold():\n  while True:\n    sync()\n  end\nend\n")
            with Served("--ur-programs", folder, "--model", "ur20") as served:
                dashboard = Dashboard(served)
                self.assertEqual(dashboard.ask("get robot model"), "UR20")
                self.assertEqual(dashboard.ask("load other.urp"), "File not found: other.urp")
                self.assertEqual(dashboard.ask("load hold.urp"), "Loading program: hold.urp")
                self.assertEqual(dashboard.ask("play"), "Starting program")
                self.assertTrue(dashboard.wait_for("programState", "PLAYING hold.urp"))
                self.assertEqual(dashboard.ask("stop"), "Stopped")
                self.assertTrue(dashboard.wait_for("programState", "STOPPED hold.urp"))
                dashboard.close()
            with Served("--ur-programs", f"{folder}/none", offset=40) as served:
                self.assertEqual(served.process.wait(20), 2)
                self.assertIn("--ur-programs", "".join(served.said))

    def test_addresses_of_others_need_consent(self):
        with Served(offset=40, address="0.0.0.0") as served:
            self.assertEqual(served.process.wait(20), 2)
            self.assertIn("--ur-clients", "".join(served.said))


@unittest.skipUnless(rtde_control, "the wheel ur_rtde is not installed: its clients are not tried")
class UrRtde(unittest.TestCase):
    """It knows no other ports than the real ones."""

    def test_wheel_ur_rtde_receives_and_switches(self):
        with Served("--model", "ur10e", offset=0):
            receiver = rtde_receive.RTDEReceiveInterface("127.0.0.1")
            io = rtde_io.RTDEIOInterface("127.0.0.1")
            self.assertEqual(receiver.getRobotMode(), 7)
            self.assertTrue(io.setStandardDigitalOut(0, True))
            time.sleep(0.3)
            self.assertTrue(receiver.getDigitalOutState(0))
            self.assertTrue(io.setSpeedSlider(0.5))
            time.sleep(0.3)
            self.assertAlmostEqual(receiver.getTargetSpeedFraction(), 0.5)
            io.disconnect()
            receiver.disconnect()

    def test_wheel_ur_rtde_moves_the_arm(self):
        with Served("--model", "ur10e", offset=0):
            receiver = rtde_receive.RTDEReceiveInterface("127.0.0.1")
            control = rtde_control.RTDEControlInterface("127.0.0.1")
            joints = receiver.getActualQ()
            joints[5] += 0.2
            self.assertTrue(control.moveJ(joints, 1.0, 1.0))
            self.assertLess(max(abs(a - b) for a, b in zip(receiver.getActualQ(), joints)), 1e-6)
            pose = receiver.getActualTCPPose()
            pose[2] += 0.03
            self.assertTrue(control.moveL(pose, 0.2, 0.3))
            self.assertLess(max(abs(a - b) for a, b in zip(receiver.getActualTCPPose()[:3], pose)), 1e-4)
            self.assertTrue(control.speedL([0, 0, -0.05, 0, 0, 0], 0.5, 0.1))
            self.assertTrue(control.speedStop())
            self.assertTrue(control.forceMode([0] * 6, [0, 0, 1, 0, 0, 0], [0, 0, -5, 0, 0, 0], 2, [0.1] * 6))
            self.assertTrue(control.forceModeStop())
            target = receiver.getTargetQ()
            for step in range(50):
                begin = control.initPeriod()
                self.assertTrue(control.servoJ([target[0] + 0.001 * step, *target[1:]], 0.5, 0.5, 0.002, 0.1, 300))
                control.waitPeriod(begin)
            self.assertTrue(control.servoStop())
            control.stopScript()


class Run(unittest.TestCase):
    """`snug run`: an exported program on the cell, by the interpreter, against `simulate`."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.script = Path(cls.folder.name) / "small.script"
        program = Path(cls.folder.name) / "small.csv"
        cls.cell = [str(CELL), "--container", "400x300x200", "--sequence", "1"]
        cls.call("pack", *cls.cell, "--samples", "0", "--program", program)
        cls.call("export", program, "--scenario", *cls.cell, "--format", "urscript", "-o", cls.script)
        simulated = json.loads(cls.call("simulate", *cls.cell, "--program", program, "--robot", "ur10", "--json").stdout)
        cls.packed = {box["id"] for box in simulated["boxes"] if box["state"] == "packed"}

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @staticmethod
    def call(*words, code=0):
        done = subprocess.run([SNUG, *map(str, words)], capture_output=True, text=True)
        assert done.returncode == code, (words, done.returncode, done.stderr)
        return done

    def test_exported_program_packs_the_same_boxes_at_either_period(self):
        self.assertGreater(len(self.packed), 2)
        for model in ("ur10", "ur10e"):
            result = json.loads(self.call("run", self.script, *self.cell, "--model", model, "--json").stdout)
            self.assertEqual({box["id"] for box in result["boxes"] if box["state"] == "packed"}, self.packed)

    def test_every_form_of_an_export_is_run_to_its_end(self):
        program, script = Path(self.folder.name) / "small.csv", Path(self.folder.name) / "form.script"
        first, second = list(dict.fromkeys(re.findall(r"\bBox\(?_?(BOX\d+)", program.read_text())))[:2]
        for words, skip in ((["--payload-inertia"], []), (["--dry-run"], []), (["--from-box", second], ["--skip", first])):
            self.call("export", program, "--scenario", *self.cell, "--format", "urscript", "-o", script, *words)
            result = json.loads(self.call("run", script, *self.cell, *skip, "--json").stdout)
            packed = {box["id"] for box in result["boxes"] if box["state"] == "packed"}
            if words == ["--dry-run"]:
                self.assertEqual(packed, set())
            elif not skip:
                self.assertEqual(packed, self.packed)
            else:  # what stood on the first box may lie elsewhere
                self.assertIn(second, packed)

    def test_a_line_that_is_asked_too_fast_is_made_slower(self):
        fast = Path(self.folder.name) / "fast.script"
        fast.write_text("def fast():\n  set_tcp(p[0, 0, 0, 0, 0, 0])\n  movej([-1.57, -1.6, 1.6, -0.7, 0.7, 0.2], a=3, v=1.5)\n"
                        "  movel(p[-0.203, 0.263, 0.559, 0.68, -1.083, -2.076], a=1.4, v=1.04, t=0.1)\nend\n")
        self.call("run", fast, *self.cell, "--model", "ur10e")

    def test_mistakes_are_told_with_their_place(self):
        broken = Path(self.folder.name) / "broken.script"
        broken.write_text("def p():\n  mvoej([0, 0, 0, 0, 0, 0])\nend\n")
        self.assertIn("broken.script:2:3: got unknown function 'mvoej', nearest is 'movej'",
                      self.call("run", broken, *self.cell, code=2).stderr)
        broken.write_text("def p():\n  sleep(0.1)\n  x = [1][3]\nend\n")
        self.assertIn("3:", self.call("run", broken, *self.cell, code=1).stderr)
        broken.write_text("def p():\n  halt\nend\n")
        self.assertIn("halted", self.call("run", broken, *self.cell, code=1).stderr)
        broken.write_text("def p():\n  servoj([0, 0, 0, 0, 0, 0], t=0.008)\n  sleep(1)\nend\n")
        self.assertIn("beyond its limit of position or speed", self.call("run", broken, *self.cell, code=1).stderr)
        broken.write_text("def p():\n  rtde_set_watchdog(\"input_int_register_0\", 10)\n  sleep(9)\nend\n")
        self.assertIn("no client sets the input", self.call("run", broken, *self.cell, code=1).stderr)
        self.assertIn("BOX027", self.call("run", self.script, *self.cell, "--skip", "BOX02", code=2).stderr)


class PackedUr(unittest.TestCase):
    """`snug pack --plant ur://` in a process of its own, through the ports of a served UR, boxes told by its observers."""

    ITEMS = """parcel_types:
  - {name: brick, size: [0.11, 0.12, 0.1], mass: 0.4}
parcels:
  - {id: b1, type: brick, material: box}
  - {id: b2, type: brick, material: box}
  - {id: b3, type: brick, material: box}
sequences:
  - name: one
    items: [{parcel: b1, up: Z}]
  - name: three
    items: [{parcel: b1, up: Z}, {parcel: b2, up: Z}, {parcel: b3, up: Z}]
"""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.items = self.folder / "items.yaml"
        self.items.write_text(self.ITEMS, encoding="utf-8")

    def words(self, address, *more, sequence="one"):
        return [SNUG, "pack", CELL, "--items", self.items, "--sequence", sequence, "--samples", "0", "--decision-time", "0.02",
                "--plant", address, *map(str, more), "--json"]

    def pack(self, address, *more, sequence="one"):
        return subprocess.run(self.words(address, *more, sequence=sequence), text=True, capture_output=True, timeout=300)

    def serve(self, sequence="one"):
        return Served("--items", self.items, "--sequence", sequence, "--plant-seed", 7, "--observers", f"ipc://{self.folder}/boxes", "--json")

    def test_a_box_is_packed_through_the_robot(self):
        boxes = f"ipc://{self.folder}/boxes"
        program = self.folder / "program.csv"
        with Served("--items", self.items, "--sequence", "one", "--plant-seed", 7, "--observers", boxes, "--json") as served:
            address = f"ur://127.0.0.1:{served.offset}"
            packed = self.pack(address, "--observe", boxes, "--program", program)
            self.assertEqual(packed.returncode, 0, packed.stderr)
            result = json.loads(packed.stdout)
            self.assertEqual((result["plant"], result["executed_boxes"], result["boxes_lost"]), (address, 1, 0))
            self.assertIn("Place(b1)", program.read_text(encoding="utf-8"))
            dashboard = Dashboard(served)
            self.assertTrue(dashboard.wait_for("running", "Program running: false"), "nothing runs on the robot any more")
            dashboard.close()
            run = json.loads(served.end())
        self.assertEqual([box["state"] for box in run["boxes"]], ["packed"])

    def test_in_lockstep_what_a_robot_did_is_the_same_each_time_and_recorded(self):
        boxes, programs = f"ipc://{self.folder}/boxes", []
        for name in ("first", "second"):
            run, program = self.folder / f"{name}.h5", self.folder / f"{name}.csv"
            with self.serve("three") as served:
                packed = self.pack(f"ur://127.0.0.1:{served.offset}", "--observe", boxes, "--lockstep", "-o", run, "--program", program, sequence="three")
                self.assertEqual(packed.returncode, 0, packed.stderr)
                result = json.loads(packed.stdout)
                states = [box["state"] for box in json.loads(served.end())["boxes"]]
            self.assertEqual((result["executed_boxes"], result["boxes_lost"], states), (3, 0, ["packed"] * 3))
            programs.append(program.read_bytes())
        self.assertEqual(*programs)
        for words in (("report", run, "-o", self.folder / "page.html"), ("export", run, "--format", "csv", "-o", self.folder / "run.csv")):
            done = subprocess.run([SNUG, *map(str, words)], text=True, capture_output=True)
            self.assertEqual(done.returncode, 0, done.stderr)
        lines = (self.folder / "run.csv").read_text(encoding="utf-8").splitlines()
        self.assertGreater(len(lines), 1000)
        self.assertIn("b3", lines[0])

    def test_three_programs_pack_through_a_robot_and_a_camera(self):
        boxes = f"ipc://{self.folder}/boxes"
        camera = f"{SNUG} camera {CELL} --items {self.items} --sequence three --click {boxes} --shot {{look}} -o {{frame}}.h5"
        with self.serve("three") as served:
            packed = self.pack(f"ur://127.0.0.1:{served.offset}", "--observe", boxes, "--lockstep", "--perception", "frames", "--frames", camera, sequence="three")
            self.assertEqual(packed.returncode, 0, packed.stderr)
            states = [box["state"] for box in json.loads(served.end())["boxes"]]
        result = json.loads(packed.stdout)
        self.assertEqual((result["perception"], result["executed_boxes"], states), ("frames", 3, ["packed"] * 3))

    def test_who_interrupts_is_told_so_and_the_session_goes_on(self):
        boxes = f"ipc://{self.folder}/boxes"
        with self.serve() as served:
            address, watch = f"ur://127.0.0.1:{served.offset}", cut_robot.Watch(served.offset)
            packing = subprocess.Popen(self.words(address, "--observe", boxes, "--log", self.folder / "log"), text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertTrue(watch.wait(lambda now: now[1] > 0.05 and now[2] & 1, 60), "the robot goes with its vacuum on")
            packing.send_signal(signal.SIGINT)
            out, said = packing.communicate(timeout=60)
            self.assertEqual((packing.returncode, json.loads(out)["stop_reason"], json.loads(out)["failure"]), (1, "interrupted", ""), said)
            self.assertIn("interrupted after", said)
            self.assertNotIn("plant fault", said)
            self.assertEqual(watch.now()[2] & 1, 1, "the vacuum is as it was")
            watch.close()
            resumed = self.pack(address, "--observe", boxes, "--lockstep", "--resume", self.folder / "log")
            self.assertEqual(resumed.returncode, 0, resumed.stderr)
            self.assertEqual(json.loads(resumed.stdout)["executed_boxes"], 1)

    def test_a_client_that_is_killed_or_cut_off_leaves_a_robot_that_stands(self):
        said = []
        cut_robot.cut_robot(SNUG, (CELL, "--items", self.items, "--sequence", "three"), 1, ("killed", "cut"), 7, said.append)
        self.assertEqual(len(said), 3, said)

    def test_what_cannot_be_is_refused_before_anything_moves(self):
        def assert_refused(result, *parts):
            self.assertEqual((result.returncode, result.stdout), (2, ""), result.stderr)
            for part in parts:
                self.assertIn(part, result.stderr)
        assert_refused(self.pack("ur://192.0.2.1"), "--yes-this-moves-a-robot")
        assert_refused(self.pack("ur://"), "ur://HOST")
        assert_refused(self.pack("ur://127.0.0.1:9000", "--perception", "exact"), "--observe")
        assert_refused(self.pack("ur://127.0.0.1:9000", "--perception", "dead-reckoning", "--plant-timeout", 0.5), "39001")
        assert_refused(self.pack("simulated", "--dry-run"), "--dry-run", "ur://HOST")
        assert_refused(self.pack("simulated", "--lockstep"), "--lockstep", "ur://HOST")
        for words in (("--fault", "drop@1"), ("--robot", "none")):
            assert_refused(self.pack("ur://127.0.0.1:9000", *words), words[0])
        with Served() as served:
            dashboard = Dashboard(served)
            dashboard.ask("power off")
            self.assertTrue(dashboard.wait_for("robotmode", "Robotmode: POWER_OFF"))
            dashboard.close()
            assert_refused(self.pack(f"ur://127.0.0.1:{served.offset}", "--perception", "dead-reckoning"), "robot mode", "release the brakes")


if __name__ == "__main__":
    unittest.main()
