#!/usr/bin/env python3
"""imports_test.py: bags that the readers' own packages write become archives: the same numbers, whichever of their formats they are in.
scripts/test-exports.sh runs it, with packages from PyPI. SNUG names the program."""
import csv
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
from rosbags.rosbag1 import Writer as Writer1
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as Writer2
from rosbags.typesys import Stores, get_typestore

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
BEGIN = 1_700_000_000_000_000_000  # ns
PERIOD = 10_000_000
FRAMES = 50
JOINTS = ["elbow_joint", "shoulder_lift_joint", "shoulder_pan_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
FORCE, TOUCHED = "/force_torque_sensor_broadcaster/wrench", "/rosout"


def turn(angle):
    """About z: x, y, z, w."""
    return (0.0, 0.0, math.sin(angle / 2), math.cos(angle / 2))


class Messages:
    """What is in the bag, at index i, of a store of types of ROS 1 or 2."""

    def __init__(self, store, is_ros1):
        self.store, self.is_ros1 = store, is_ros1

    def make(self, kind, **values):
        return self.store.types[kind](**values)

    def header(self, i, frame):
        time = BEGIN + i * PERIOD
        stamp = self.make("builtin_interfaces/msg/Time", sec=time // 10**9, nanosec=time % 10**9)
        return self.make("std_msgs/msg/Header", stamp=stamp, frame_id=frame, **({"seq": i} if self.is_ros1 else {}))

    def vector(self, x, y, z, kind="Vector3"):
        return self.make(f"geometry_msgs/msg/{kind}", x=float(x), y=float(y), z=float(z))

    def quaternion(self, q):
        return self.make("geometry_msgs/msg/Quaternion", x=q[0], y=q[1], z=q[2], w=q[3])

    def pose(self, p, q):
        return self.make("geometry_msgs/msg/Pose", position=self.vector(*p, kind="Point"), orientation=self.quaternion(q))

    def transform(self, i, parent, child, p, q):
        inner = self.make("geometry_msgs/msg/Transform", translation=self.vector(*p), rotation=self.quaternion(q))
        return self.make("geometry_msgs/msg/TransformStamped", header=self.header(i, parent), child_frame_id=child, transform=inner)

    def all_at(self, i):
        """(topic, kind, message): a crate on a table that turns, two bodies on one topic of transforms, one that the tracker loses."""
        if i == 0:
            static = [self.transform(0, "world", "base", (1.0, 0.0, 0.5), turn(0.0))]
            yield "/tf_static", "tf2_msgs/msg/TFMessage", self.make("tf2_msgs/msg/TFMessage", transforms=static)
        moving = [self.transform(i, "base", "table", (0.0, 0.0, 0.0), turn(0.02 * i)),
                  self.transform(i, "table", "crate", (0.25, 0.0, 0.125), turn(0.0))]
        yield "/tf", "tf2_msgs/msg/TFMessage", self.make("tf2_msgs/msg/TFMessage", transforms=moving)
        for child, x in (("vicon/tote/tote", 0.001), ("vicon/collar/collar", -0.001)):
            yield "/vicon/all", "geometry_msgs/msg/TransformStamped", self.transform(i, "/world", child, (x * i, 2.0, 3.0), turn(0.5))
        lost = 20 <= i < 30
        pose = self.pose((0.0, 0.0, 0.0) if lost else (0.5, 0.01 * i, 0.75), (0.0, 0.0, 0.0, 0.0) if lost else turn(-0.01 * i))
        yield "/mocap/box7/pose", "geometry_msgs/msg/PoseStamped", self.make(
            "geometry_msgs/msg/PoseStamped", header=self.header(i, "world"), pose=pose)
        values = np.array([3.0, 2.0, 1.0, 4.0, 5.0, 6.0]) + 0.001 * i
        yield "/joint_states", "sensor_msgs/msg/JointState", self.make(
            "sensor_msgs/msg/JointState", header=self.header(i, ""), name=JOINTS, position=values, velocity=10 * values,
            effort=np.zeros(0))
        yield FORCE, "geometry_msgs/msg/WrenchStamped", self.make(
            "geometry_msgs/msg/WrenchStamped", header=self.header(i, "tool0"),
            wrench=self.make("geometry_msgs/msg/Wrench", force=self.vector(1, 2, -30 - i), torque=self.vector(0.1, 0.2, 0.3)))
        yield TOUCHED, "std_msgs/msg/String", self.make("std_msgs/msg/String", data=f"{i}")


def write_bag(path, plugin):
    """A bag of ROS 2 in one of its storages, or of ROS 1 for no plugin."""
    store = get_typestore(Stores.ROS1_NOETIC if plugin is None else Stores.ROS2_HUMBLE)
    if plugin is None:  # ROS 1 keeps these kinds in a package of its own
        from rosbags.typesys import get_types_from_msg
        if "tf2_msgs/msg/TFMessage" not in store.types:
            store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", "tf2_msgs/msg/TFMessage"))
    messages = Messages(store, plugin is None)
    writer = Writer1(path) if plugin is None else Writer2(path, version=9, storage_plugin=plugin)
    connections = {}
    with writer:
        for i in range(FRAMES):
            for topic, kind, message in messages.all_at(i):
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=store)
                raw = store.serialize_ros1(message, kind) if plugin is None else store.serialize_cdr(message, kind)
                writer.write(connections[topic], BEGIN + i * PERIOD + 1_000_000, raw)


class Bags(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(scratch.cleanup)
        cls.folder = Path(scratch.name)
        write_bag(cls.folder / "one.bag", None)
        write_bag(cls.folder / "sqlite", StoragePlugin.SQLITE3)
        write_bag(cls.folder / "mcap", StoragePlugin.MCAP)
        cls.expected = None

    def snug(self, *words, code=0):
        environment = {**os.environ, "SNUG_PYTHON": sys.executable}
        environment.pop("PYTHONPATH", None)
        done = subprocess.run([SNUG, *map(str, words)], cwd=self.folder, capture_output=True, text=True, check=False, timeout=300,
                              env=environment)
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def tables(self, bag, *words):
        """What the archive of a bag says, by the name of the source; what was said of it."""
        said = self.snug("archive", "convert", bag, "--name", "bag", "-o", self.folder / "out.h5", *words).stderr
        shutil.rmtree(self.folder / "tables", ignore_errors=True)
        self.snug("archive", "convert", "out.h5", "-o", "tables")
        return {path.stem[4:]: path.read_text(encoding="utf-8") for path in (self.folder / "tables").iterdir()}, said

    def test_bag_becomes_an_archive_with_its_numbers(self):
        tables, said = self.tables("sqlite", "--tool", "table")
        rows = {name: list(csv.DictReader(text.splitlines(), delimiter=";")) for name, text in tables.items()}
        self.assertEqual({name: len(found) for name, found in rows.items()}, {"mocap": FRAMES, "ft": FRAMES, "robot": FRAMES})
        for i in (0, FRAMES - 1):
            row = rows["mocap"][i]
            numbers = [float(row[f"crate_FloatingBase_{part}"]) for part in ("position_x", "position_y", "position_z", "orientation_z")]
            angle = 0.02 * i  # tables turn the world into the body
            expected = [1.0 + 0.25 * math.cos(angle), 0.25 * math.sin(angle), 0.625, -math.sin(angle / 2)]
            np.testing.assert_allclose(numbers, expected, atol=1e-6)
            np.testing.assert_allclose(float(row["tote_FloatingBase_position_x"]), 0.001 * i, atol=1e-8)
            np.testing.assert_allclose(float(row["collar_FloatingBase_position_x"]), -0.001 * i, atol=1e-8)
            self.assertAlmostEqual(float(rows["ft"][i]["UR10FTSensor_fz"]), -30 - i)
            for joint, start in enumerate((1.0, 2.0, 3.0, 4.0, 5.0, 6.0)):
                self.assertAlmostEqual(float(rows["robot"][i][f"actual_q_{joint}"]), start + 0.001 * i)
        lost = [i for i, row in enumerate(rows["mocap"]) if row["box7_FloatingBase_position_x"] == ""]
        self.assertEqual(lost, list(range(20, 30)), "a quaternion of zeros is a body that was lost")
        self.assertIn("left out: /rosout (std_msgs/String)", said)
        self.assertIn("poses whose quaternion is (0, 0, 0, 0) count as lost: 10", said)
        self.assertIn("poses of topics are in 'world'", said)

    def expect_the_same(self, *bags):
        """As the first bag that was asked for: the bags have the same messages."""
        for bag in bags:
            with self.subTest(bag=bag):
                found = self.tables(bag)[0]
                type(self).expected = self.expected or found
                self.assertEqual(found, self.expected)

    def test_every_format_gives_the_same(self):
        self.expect_the_same("sqlite", "mcap", "mcap/mcap.mcap", "sqlite/sqlite.db3", "one.bag")

    def test_folders_that_do_not_fit_their_files_are_told(self):
        renamed = self.folder / "renamed"
        shutil.copytree(self.folder / "mcap", renamed)
        (renamed / "mcap.mcap").rename(renamed / "take.mcap")
        tables, said = self.tables(renamed)
        self.assertIn("read from take.mcap: the folder has no metadata.yaml that names it", said)
        self.assertIn("crate_FloatingBase_position_x", tables["mocap"])
        shutil.copy(renamed / "take.mcap", renamed / "another.mcap")
        said = self.snug("archive", "convert", renamed, "-o", "none.h5", code=2).stderr
        self.assertIn("metadata.yaml names none of the files of the folder; give a bag itself: another.mcap, take.mcap", said)
        empty = self.folder / "empty"
        empty.mkdir()
        said = self.snug("archive", "convert", empty, "-o", "none.h5", code=2).stderr
        self.assertIn("there is no bag in the folder", said)
        # A file beside the metadata of another bag is opened alone.
        other = self.folder / "other"
        shutil.copytree(self.folder / "mcap", other)
        shutil.copy(self.folder / "sqlite" / "sqlite.db3", other / "alone.db3")
        self.expect_the_same("renamed/take.mcap", "other/alone.db3")


if __name__ == "__main__":
    unittest.main(verbosity=2)
