#!/usr/bin/env python3
"""mcap_test.py: MCAP files whose messages are protocol buffers say the same, to the last bit, as those whose messages are JSON. Read by the
protobuf library of Debian (python3-protobuf) with nothing but the schemas in the file; skipped without it. SNUG names the program."""
import json
import os
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

try:
    from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
except ImportError:
    descriptor_pb2 = None

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
PUBLIC = ["foxglove.FrameTransforms", "foxglove.JointStates", "foxglove.Log", "foxglove.PoseInFrame", "foxglove.SceneUpdate"]
OWN = ["snug.CupState", "snug.Event", "snug.ProgramState", "snug.SolverState", "snug.TwistStamped", "snug.WrenchStamped"]


def snug(*words, code=0):
    done = subprocess.run([SNUG, *map(str, words)], text=True, capture_output=True, timeout=600, check=False)
    assert done.returncode == code, (words, done.returncode, done.stderr)
    return done


def text_at(data, at):
    size = struct.unpack_from("<I", data, at)[0]
    return data[at + 4:at + 4 + size], at + 4 + size


def records(data):
    at = 0
    while at < len(data):
        op, size = struct.unpack_from("<BQ", data, at)
        yield op, data[at + 9:at + 9 + size]
        at += 9 + size


def read(path):
    """Schemas by name, (encoding, bytes); messages by topic, (time, message encoding, name of the schema, bytes). Uncompressed files."""
    schemas, names, channels, messages = {}, {0: ""}, {}, {}
    for op, content in records(path.read_bytes()[8:-8]):
        if op != 0x06:
            continue
        _, at = text_at(content, 28)
        for inner, record in records(content[at + 8:]):
            if inner == 0x03:
                name, at = text_at(record, 2)
                encoding, at = text_at(record, at)
                names[struct.unpack_from("<H", record)[0]] = name.decode()
                schemas[name.decode()] = (encoding.decode(), text_at(record, at)[0])
            elif inner == 0x04:
                topic, at = text_at(record, 4)
                number, schema = struct.unpack_from("<HH", record)
                channels[number] = (topic.decode(), text_at(record, at)[0].decode(), names[schema])
            elif inner == 0x05:
                topic, encoding, schema = channels[struct.unpack_from("<H", record)[0]]
                messages.setdefault(topic, []).append((struct.unpack_from("<Q", record, 6)[0], encoding, schema, record[22:]))
    return schemas, messages


def decoder_of(schemas):
    """A function (schema, bytes) -> message; each schema with a pool of its own, as readers have it."""
    classes = {}
    for name, (encoding, data) in schemas.items():
        if encoding != "protobuf":
            continue
        pool = descriptor_pool.DescriptorPool()
        for file in descriptor_pb2.FileDescriptorSet.FromString(data).file:
            pool.Add(file)
        type_ = pool.FindMessageTypeByName(name)
        make = getattr(message_factory, "GetMessageClass", None)
        classes[name] = make(type_) if make else message_factory.MessageFactory(pool).GetPrototype(type_)
    return lambda schema, data: classes[schema].FromString(data)


@unittest.skipIf(descriptor_pb2 is None, "python3-protobuf is not installed")
class ProtobufInMcap(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        program = cls.folder / "p.csv"
        snug("program", CELL, ROOT / "scenarios" / "demo-placements.yaml", "--sequence", "1", "-o", program)
        cls.run_file = cls.folder / "run.h5"
        snug("simulate", CELL, "--program", program, "--sequence", "1", "--robot", "ur10", "--until", "9", "-o", cls.run_file)
        cls.files = {}
        for encoding in ("protobuf", "json"):
            cls.files[encoding] = cls.folder / f"{encoding}.mcap"
            snug("export", cls.run_file, "--format", "mcap", "--compression", "none", "--encoding", encoding, "-o", cls.files[encoding])
        cls.schemas, cls.messages = read(cls.files["protobuf"])
        cls.json = {topic: [(time, json.loads(data)) for time, _, _, data in found] for topic, found in read(cls.files["json"])[1].items()}
        cls.decode = staticmethod(decoder_of(cls.schemas))

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_messages_are_those_of_json(self):
        """One test: what all of it reads takes seconds to make."""
        for check in (self.check_every_message_is_that_of_json, self.check_cup_that_holds_nothing_has_no_length, self.check_joints_and_events, self.check_schemas_have_what_they_import_and_no_more, self.check_field_numbers_are_the_public_ones, self.check_file_is_smaller_and_the_same_again):
            with self.subTest(check.__name__):
                check()

    def expect_same(self, message, value, where):
        for key, expected in value.items():
            key = {"sec": "seconds", "nsec": "nanos"}.get(key, key)
            self.assertIn(key, message.DESCRIPTOR.fields_by_name, where)
            got = getattr(message, key)
            if isinstance(expected, dict):
                self.expect_same(got, expected, f"{where}.{key}")
            elif isinstance(expected, list):
                self.assertEqual(len(got), len(expected), f"{where}.{key}")
                for item, wanted in zip(got, expected):
                    if isinstance(wanted, dict):
                        self.expect_same(item, wanted, f"{where}.{key}[]")
                    else:
                        self.assertEqual(item, wanted, f"{where}.{key}[]")
            else:
                self.assertEqual(got, expected, f"{where}.{key}")

    def check_every_message_is_that_of_json(self):
        compared = 0
        for topic, found in self.messages.items():
            if topic in ("/joint_states", "/events", "/events/data", "/robot_description"):
                continue
            self.assertEqual(len(found), len(self.json[topic]), topic)
            for (time, encoding, schema, data), (wanted_time, wanted) in zip(found, self.json[topic]):
                self.assertEqual((time, encoding), (wanted_time, "protobuf"), topic)
                self.expect_same(self.decode(schema, data), wanted, topic)
                compared += 1
        self.assertGreater(compared, 5000)
        self.assertEqual(set(self.messages) - set(self.json), {"/events/data"})

    def check_cup_that_holds_nothing_has_no_length(self):
        states = [self.decode(schema, data) for _, _, schema, data in self.messages["/cup/state"]]
        self.assertEqual({bool(state.attached_body) for state in states}, {True, False})
        for state in states:
            self.assertEqual(state.HasField("length_m"), bool(state.attached_body))

    def check_joints_and_events(self):
        for (_, _, schema, data), (_, wanted) in zip(self.messages["/joint_states"], self.json["/joint_states"]):
            self.assertEqual(schema, "foxglove.JointStates")
            joints = self.decode(schema, data).joints
            self.assertEqual([joint.name for joint in joints], wanted["name"])
            for key in ("position", "velocity", "effort"):
                self.assertEqual([getattr(joint, key) for joint in joints], wanted[key])
            self.assertFalse(joints[0].HasField("acceleration"))
        self.assertGreater(len(self.messages["/events"]), 1)
        for log, event, (_, wanted) in zip(self.messages["/events"], self.messages["/events/data"], self.json["/events"]):
            told, more = self.decode(log[2], log[3]), self.decode(event[2], event[3])
            self.assertEqual((told.level, told.message, told.name), (wanted["level"], wanted["message"], wanted["name"]))
            self.assertEqual(more.kind, wanted["kind"])
            self.assertEqual({number.name: number.value for number in more.numbers}, wanted["numbers"])
        self.assertEqual(self.messages["/robot_description"][0][1], "json")

    def check_schemas_have_what_they_import_and_no_more(self):
        self.assertEqual(sorted(name for name in self.schemas if self.schemas[name][0] == "protobuf"), PUBLIC + OWN)
        for name in PUBLIC + OWN:
            files = descriptor_pb2.FileDescriptorSet.FromString(self.schemas[name][1]).file
            self.assertEqual(files[-1].name, name.replace(".", "/") + ".proto")
            seen = set()
            for file in files:
                self.assertLessEqual(set(file.dependency), seen, name)
                seen.add(file.name)
        self.assertEqual(len(descriptor_pb2.FileDescriptorSet.FromString(self.schemas["foxglove.PoseInFrame"][1]).file), 5)

    def check_field_numbers_are_the_public_ones(self):
        """Which readers with code of their own for these messages rely on: some of each kind, from the published schemas."""
        known = {"foxglove.SceneEntity": {"timestamp": 1, "frame_id": 2, "id": 3, "lifetime": 4, "frame_locked": 5, "metadata": 6, "arrows": 7,
                                          "cubes": 8, "spheres": 9, "cylinders": 10, "lines": 11, "triangles": 12, "texts": 13, "models": 14},
                 "foxglove.CylinderPrimitive": {"pose": 1, "size": 2, "bottom_scale": 3, "top_scale": 4, "color": 5},
                 "foxglove.TriangleListPrimitive": {"pose": 1, "points": 2, "color": 3, "colors": 4, "indices": 5},
                 "foxglove.FrameTransform": {"timestamp": 1, "parent_frame_id": 2, "child_frame_id": 3, "translation": 4, "rotation": 5},
                 "foxglove.Log": {"timestamp": 1, "level": 2, "message": 3, "name": 4, "file": 5, "line": 6},
                 "foxglove.JointState": {"name": 1, "position": 2, "velocity": 3, "acceleration": 4, "effort": 5}}
        pool = descriptor_pool.DescriptorPool()
        added = set()
        for name in PUBLIC:
            for file in descriptor_pb2.FileDescriptorSet.FromString(self.schemas[name][1]).file:
                if file.name not in added:
                    pool.Add(file)
                added.add(file.name)
        for name, fields in known.items():
            self.assertEqual({field.name: field.number for field in pool.FindMessageTypeByName(name).fields}, fields)

    def check_file_is_smaller_and_the_same_again(self):
        sizes = {encoding: path.stat().st_size for encoding, path in self.files.items()}
        self.assertLess(sizes["protobuf"], 0.5 * sizes["json"])
        snug("export", self.run_file, "--format", "mcap", "--compression", "none", "-o", self.folder / "again.mcap")
        self.assertEqual((self.folder / "again.mcap").read_bytes(), self.files["protobuf"].read_bytes())


if __name__ == "__main__":
    unittest.main()
