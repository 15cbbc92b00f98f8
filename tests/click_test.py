#!/usr/bin/env python3
"""click_test.py: the served cell as clients of other makes meet it: python3-zmq and python3-protobuf. SNUG names the program."""
import importlib
import json
import math
import os
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

try:
    import zmq
    import google.protobuf  # noqa: F401
except ImportError:
    zmq = None

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
FOLDER = tempfile.TemporaryDirectory()


def messages():
    """The module that protoc makes of our text of the protocol."""
    if not Path(FOLDER.name, "click_pb2.py").exists():
        subprocess.run(["protoc", f"--proto_path={ROOT / 'src/snug/click'}", f"--python_out={FOLDER.name}", "click.proto"],
                       check=True)
        sys.path.insert(0, FOLDER.name)
    return importlib.import_module("click_pb2")


class Served:
    """`snug serve` in a process of its own, until it is left."""

    def __init__(self, *words, endpoint="tcp://127.0.0.1:*"):
        self.process = subprocess.Popen([SNUG, "serve", str(CELL), "--click", endpoint, *map(str, words)], text=True,
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.said = []
        for line in self.process.stderr:
            self.said.append(line)
            if " at " in line and "serving" in line:
                break
        self.endpoint = self.said[-1].split(" at ")[-1].split()[0] if self.said else ""
        self.reader = threading.Thread(target=lambda: self.said.extend(self.process.stderr), daemon=True)
        self.reader.start()
        self.stdout = None

    def end(self):
        if self.stdout is None:
            self.process.send_signal(signal.SIGINT)
            self.stdout = self.process.stdout.read()
            self.process.wait(60)
            self.reader.join(10)
            for pipe in (self.process.stdin, self.process.stdout, self.process.stderr):
                pipe.close()
        return self.process.returncode

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end()


class Peer:
    """A client, by the description of the protocol."""

    def __init__(self, endpoint, kind=None, name=None):
        self.pb = messages()
        self.context = zmq.Context()
        self.socket = self.context.socket(kind or zmq.REQ)
        self.socket.linger = 0
        if name:
            self.socket.setsockopt(zmq.IDENTITY, name)
        self.socket.rcvtimeo = 60000
        self.socket.connect(endpoint)

    def close(self):
        self.context.destroy(linger=0)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def raw(self, frame):
        self.socket.send(frame)
        self.bytes = answer = self.socket.recv()
        kinds = {self.pb.MessageType.Handshake: self.pb.HandshakeMessage, self.pb.MessageType.Sensor: self.pb.SensorMessage,
                 self.pb.MessageType.Reset: self.pb.ResetMessage, self.pb.MessageType.Error: self.pb.ErrorMessage}
        message = kinds[self.pb.Message.FromString(answer).messageType]()
        message.ParseFromString(answer)
        return message

    def handshake(self, version=1):
        init = self.pb.HandshakeInitMessage(messageType=self.pb.MessageType.HandshakeInit, version=version)
        return self.raw(init.SerializeToString())

    def sense(self):
        return self.raw(self.pb.SensorRequestMessage(messageType=self.pb.MessageType.SensorRequest).SerializeToString())

    def reset(self):
        return self.raw(self.pb.ResetMessage(messageType=self.pb.MessageType.Reset).SerializeToString())

    def command(self, values, **events):
        control = self.pb.ControlMessage(messageType=self.pb.MessageType.Control)
        robot = control.objects["ur10"]
        robot.values.extend(values)
        for name, is_on in events.items():
            robot.controlEvents[name] = is_on
        return control

    def control(self, values, **events):
        return self.raw(self.command(values, **events).SerializeToString())


STILL = [0.0] * 6


@unittest.skipIf(zmq is None, "python3-zmq and python3-protobuf are not installed")
class Click(unittest.TestCase):
    def assert_error(self, answer, *texts):
        self.assertEqual(answer.messageType, messages().MessageType.Error, answer)
        for text in texts:
            self.assertIn(text, answer.errormessage)

    def test_all_pairs_of_messages(self):
        with Served() as served, Peer(served.endpoint) as peer:
            kind = peer.pb.MessageType
            shake = peer.handshake()
            self.assertEqual((shake.messageType, shake.version), (kind.Handshake, peer.pb.Version.CURRENT_VERSION))
            self.assertAlmostEqual(shake.simSettings.timeStep, 0.008)
            robot = shake.objects["ur10"]
            self.assertEqual(len(robot.controlsInOrder), 6)
            self.assertEqual(list(robot.controlTypesInOrder), [peer.pb.ValueType.AngularVelocity1D] * 6)
            self.assertEqual(list(robot.jointSensorsInOrder), list(robot.controlsInOrder))
            self.assertEqual(robot.controlEvents["vacuum"], peer.pb.ValueType.Activated)
            self.assertEqual(list(robot.sensors["UR10FTSensor"].types),
                             [peer.pb.ValueType.Force3D, peer.pb.ValueType.Torque3D])
            before = peer.sense()
            self.assertEqual((before.messageType, before.simVars.simulatedTime), (kind.Sensor, 0.0))
            for i in range(1, 26):
                after = peer.control([0.0, 0.0, 0.0, 0.0, 0.0, 0.1])
                self.assertEqual(after.messageType, kind.Sensor)
                self.assertAlmostEqual(after.simVars.simulatedTime, 0.008 * i)
            turned = after.objects["ur10"].angleSensors[5] - before.objects["ur10"].angleSensors[5]
            self.assertAlmostEqual(turned, 0.1 * (25 * 0.008 - 0.004), places=9)  # one tick to get to speed
            self.assertEqual(peer.sense(), after)
            self.assertEqual(peer.reset().messageType, kind.Reset)
            self.assertEqual(peer.sense(), before)

    def test_bad_messages_get_an_error_and_move_nothing(self):
        with Served() as served, Peer(served.endpoint) as peer:
            self.assert_error(peer.handshake(version=7), "version 7 is not supported")
            peer.handshake()
            before = peer.control(STILL)
            self.assert_error(peer.raw(b"\xff\x00garbage"), "cannot be read")
            self.assert_error(peer.raw(b"\x08\x63"), "type 99")
            self.assert_error(peer.control([]), "0 values")
            self.assert_error(peer.control([1.0] * 5), "5 values")
            self.assert_error(peer.control([0, math.nan, 0, 0, 0, 0]), "not a finite number")
            self.assert_error(peer.control(STILL, suction=True), "no event 'suction'")
            stray = peer.command(STILL)
            stray.objects["box999"].controlEvents["feed"] = True
            self.assert_error(peer.raw(stray.SerializeToString()), "'box999' is unknown")
            self.assert_error(peer.raw(bytes(64 << 20)), "are the most")
            self.assertEqual(peer.sense(), before)
            self.assertEqual(peer.control(STILL).messageType, peer.pb.MessageType.Sensor)

    def test_sensors_have_the_bytes_that_protobuf_makes(self):
        with Served("--plant-seed", 1, "--joint-forces", "--box-velocities", "--sequence", 1) as served:
            with Peer(served.endpoint) as peer:
                peer.handshake()
                for ask in (peer.sense, lambda: peer.control([0.1] + STILL[1:], vacuum=True)):
                    message = ask()
                    self.assertEqual(message.messageType, peer.pb.MessageType.Sensor)
                    self.assertEqual(peer.bytes, message.SerializeToString(deterministic=True))
                self.assertTrue(message.objects["ur10"].sensors["load"].sensor[0].HasField("force3d"))

    def test_who_only_looks_is_answered_beside_the_controller(self):
        with Served("--json") as served, Peer(served.endpoint) as peer, Peer(served.endpoint, name=b"watch-me") as other:
            peer.handshake()
            after = peer.control([0.2] + STILL[1:])
            self.assertEqual(other.handshake().messageType, other.pb.MessageType.Handshake)
            self.assertEqual(other.sense(), after)
            self.assert_error(other.control(STILL), "is an observer")
            self.assert_error(other.reset(), "is an observer")
            other.close()
            self.assertEqual(peer.sense(), after)
            self.assertAlmostEqual(peer.control(STILL).simVars.simulatedTime, 0.016)

    def test_a_second_client_is_refused_and_comes_in_when_the_first_has_died(self):
        with Served("--json") as served:
            first = Peer(served.endpoint)
            first.handshake()
            first.control([0.2] + STILL[1:])
            with Peer(served.endpoint) as second:
                self.assertEqual(second.handshake().messageType, second.pb.MessageType.Handshake)  # it may look
                self.assert_error(second.control([1.0] * 6), "another controller")
                self.assertAlmostEqual(first.sense().simVars.simulatedTime, 0.008)
                first.close()
                self.assertEqual(second.handshake().messageType, second.pb.MessageType.Handshake)
                self.assertEqual(second.sense().simVars.simulatedTime, 0.0)
            served.end()
            self.assertEqual(json.loads(served.stdout.splitlines()[0])["ended_by"], "the controller left")

    def test_a_client_that_does_not_wait_for_answers(self):
        with Served() as served:
            with Peer(served.endpoint, zmq.DEALER) as flood:
                for _ in range(200):
                    flood.socket.send_multipart([b"", os.urandom(50)])
                flood.socket.send_multipart([b"", b"a", b"b"])
                flood.socket.send_multipart([b"x"] * 1000)
                flood.socket.send(b"")
                time.sleep(0.2)
            with Peer(served.endpoint) as peer:
                self.assertEqual(peer.handshake().messageType, peer.pb.MessageType.Handshake)
                self.assertEqual(peer.control(STILL).messageType, peer.pb.MessageType.Sensor)

    def test_answers_carry_the_envelope_of_the_question(self):
        with Served() as served, Peer(served.endpoint, zmq.DEALER) as peer:
            init = peer.pb.HandshakeInitMessage(version=1).SerializeToString()
            for envelope in ([b"number 1", b""], [b""], []):
                peer.socket.send_multipart([*envelope, init])
                answer = peer.socket.recv_multipart()
                self.assertEqual(answer[:-1], envelope)
                self.assertEqual(peer.pb.Message.FromString(answer[-1]).messageType, peer.pb.MessageType.Handshake)

    def test_bytes_that_are_no_zeromq(self):
        with Served() as served:
            host, port = served.endpoint[len("tcp://"):].rsplit(":", 1)
            for noise in (b"GET / HTTP/1.1\r\n\r\n", os.urandom(4096), b""):
                with socket.create_connection((host, int(port))) as stranger:
                    stranger.sendall(noise)
            with Peer(served.endpoint) as peer:
                self.assertEqual(peer.handshake().messageType, peer.pb.MessageType.Handshake)

    def test_runs_are_recorded_whole_and_reported(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "run.h5")
            with Served("--record", path, "--batch", 0.4, "--json") as served, Peer(served.endpoint) as peer:
                peer.handshake()
                for _ in range(50):
                    peer.control([0.0, 0.0, 0.0, 0.0, 0.0, 0.5], vacuum=True)
                self.assertEqual(peer.control(STILL).messageType, peer.pb.MessageType.Reset)
                for _ in range(10):
                    peer.control(STILL)
                self.assertEqual(served.end(), 0)
                runs = [json.loads(line) for line in served.stdout.splitlines()]
            self.assertEqual([round(run["duration_s"], 6) for run in runs], [0.4, 0.08])
            self.assertEqual(runs[1]["ended_by"], "the server was stopped")
            self.assertEqual(sorted(p.name for p in Path(folder).iterdir()), ["run-2.h5", "run.h5"])
            table = Path(folder, "run.csv")
            subprocess.run([SNUG, "export", str(path), "--format", "csv", "-o", str(table)], check=True, timeout=120)
            lines = table.read_text().splitlines()
            self.assertEqual(len(lines), 51)
            for name in ("box027_FloatingBase_position_z", "UR10FTSensor_fz", "qIn_5", "alphaIn_0"):
                self.assertIn(name, lines[0].split(";"))
            report = Path(folder, "run.html")
            result = subprocess.run([SNUG, "report", str(path), "-o", str(report)], capture_output=True, text=True,
                                    check=False, timeout=120)
            self.assertEqual(result.returncode, 0, result.stderr)

    def test_sync_does_not_depend_on_the_pace_of_the_client(self):
        hashes = []
        for pause in (0.0, 0.003):
            with Served("--json", "--once") as served, Peer(served.endpoint) as peer:
                peer.handshake()
                for i in range(60):
                    peer.control([0.3 * math.sin(0.1 * i), -0.1, 0.1, 0.0, 0.0, 0.2], vacuum=i > 30)
                    time.sleep(pause)
                peer.reset()
                self.assertEqual(peer.sense().simVars.simulatedTime, 0.0)  # a reset does not end it
                peer.close()
                served.process.wait(60)
                served.end()
                hashes.append(json.loads(served.stdout)["state_hash"])
        self.assertEqual(hashes[0], hashes[1])

    def test_async_runs_by_itself_and_brakes_without_a_client(self):
        with Served("--async") as served, Peer(served.endpoint) as peer:
            peer.handshake()
            self.assertEqual(peer.sense().simVars.simulatedTime, 0.0)
            peer.control([0.0, 0.0, 0.0, 0.0, 0.0, 0.2])
            deadline = time.monotonic() + 30
            sensor = peer.sense()
            while sensor.simVars.simulatedTime < 0.6 and time.monotonic() < deadline:
                time.sleep(0.05)
                sensor = peer.sense()
            self.assertGreaterEqual(sensor.simVars.simulatedTime, 0.6)
            self.assertEqual(sensor.objects["ur10"].angularVelocitySensors[5], 0.0)
            served.end()
        self.assertIn("real time:", "".join(served.said))

    def test_a_client_that_shakes_no_hands_and_observers_of_any_name(self):
        with Served("--stop-after", 0.08, "--json") as served, Peer(served.endpoint) as peer:
            with Peer(served.endpoint) as one, Peer(served.endpoint, name=b"somebody") as other:
                self.assertEqual(one.handshake().messageType, one.pb.MessageType.Handshake)
                first = peer.control(STILL)
                self.assertAlmostEqual(first.simVars.simulatedTime, 0.008)
                other.handshake()
                self.assertEqual(other.sense(), first)
                self.assertEqual(one.sense(), first)
                self.assert_error(one.control(STILL), "another controller")
                self.assertEqual(first.objects["ur10"].sensors["pressure_force"].sensor[0].WhichOneof("sensor"), "force3d")
                self.assertEqual([s.WhichOneof("sensor") for s in first.objects["ur10"].objectSensors], ["position", "rpy"])
            for _ in range(9):
                peer.control(STILL)
            served.process.wait(60)
            served.end()
        self.assertEqual(json.loads(served.stdout)["ended_by"], "0.08 s are over")

    def test_runs_at_once_and_stops_by_itself(self):
        with Served("--async", "--run-at-once", "--stop-after", 0.1, "--json") as served:
            served.process.wait(60)
            served.end()
        self.assertAlmostEqual(json.loads(served.stdout)["duration_s"], 0.104, delta=0.01)

    def test_step_by_step_waits_for_the_user(self):
        with Served("--step-by-step") as served, Peer(served.endpoint) as peer:
            peer.handshake()
            peer.socket.send(peer.command(STILL).SerializeToString())
            self.assertEqual(peer.socket.poll(300), 0, "answered without a step")
            served.process.stdin.write("\n")
            served.process.stdin.flush()
            self.assertEqual(peer.socket.poll(30000), zmq.POLLIN)
            peer.socket.recv()
            served.process.stdin.write("3\n")
            served.process.stdin.flush()
            for _ in range(3):
                self.assertEqual(peer.control(STILL).messageType, peer.pb.MessageType.Sensor)
            served.process.stdin.write("r\n")
            served.process.stdin.flush()
            time.sleep(0.3)
            self.assertEqual(peer.sense().messageType, peer.pb.MessageType.Reset)
            self.assertEqual(peer.sense().simVars.simulatedTime, 0.0)

    def test_addresses_that_others_can_reach_must_be_asked_for(self):
        result = subprocess.run([SNUG, "serve", str(CELL), "--click", "tcp://*:5555"], capture_output=True, text=True,
                                check=False, timeout=60)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("--keys", result.stderr)

    def test_control_does_a_program_as_simulate_does(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder, "program.csv")
            rows = ["-0.6,0.1,0.3,0,3.14159,0,home,0,0,0,0,0,0", "-0.6,-0.2,0.25,0,3.14159,0,PrePick027,0,0,0,0,0,0"]
            program.write_text("\n".join(rows))
            self.assert_same_as_simulated(program, folder)

    def test_control_moves_a_fast_program_by_what_the_served_cell_feels(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder, "program.csv")
            packed = subprocess.run([SNUG, "pack", str(CELL), "--sequence", "1", "--plant-seed", "4", "--samples", "0", "--agent", "margin",
                                     "--decision-time", "0.01", "--program", str(program)], capture_output=True, text=True, check=False, timeout=1100)
            self.assertEqual(packed.returncode, 0, packed.stderr)
            lines = program.read_text().splitlines(keepends=True)
            last = next(i for i, line in enumerate(lines) if "PrePick(BOX028)" in line)  # the first item's rows
            program.write_text("".join(lines[:last]))
            self.assert_same_as_simulated(program, folder)

    def assert_same_as_simulated(self, program, folder):
        words = [str(program), "--sequence", "1", "--json"]
        simulated = subprocess.run([SNUG, "simulate", str(CELL), "--program", words[0], *words[1:], "--robot", "ur10"],
                                   capture_output=True, text=True, check=False, timeout=1100)
        self.assertEqual(simulated.returncode, 0, simulated.stderr)
        endpoint = f"ipc://{folder}/cell"
        with Served("--sequence", "1", "--json", endpoint=endpoint) as served:
            controlled = subprocess.run([SNUG, "control", *words, "--click", endpoint], capture_output=True, text=True,
                                        check=False, timeout=1100)
            self.assertEqual(controlled.returncode, 0, controlled.stderr)
            served.end()
        self.assertEqual(json.loads(served.stdout)["state_hash"], json.loads(simulated.stdout)["state_hash"])
        self.assertEqual(json.loads(controlled.stdout)["duration_s"], json.loads(simulated.stdout)["duration_s"])

    def test_control_says_that_nobody_is_there(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder, "program.csv")
            program.write_text("-0.6,0.1,0.3,0,3.14159,0,home,0,0,0,0,0,0")
            result = subprocess.run([SNUG, "control", str(program), "--click", f"ipc://{folder}/nobody", "--timeout", "0.2"],
                                    capture_output=True, text=True, check=False, timeout=60)
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertIn("nobody answers", result.stderr)


if __name__ == "__main__":
    unittest.main()
