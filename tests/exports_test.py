#!/usr/bin/env python3
"""exports_test.py: what snug writes for other programs, opened by their own readers; manifests and workflows against their schemas.
scripts/test-exports.sh runs it, with packages from PyPI. SNUG names the program."""
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import yaml

ROOT = Path(__file__).resolve().parent.parent
SNUG = os.environ.get("SNUG", str(ROOT / "build" / "snug"))
CELL = ROOT / "scenarios" / "box-demonstrator.yaml"
HELD = 8.0  # s: the cup carries a box

# What a planning scene consists of beside the messages that every ROS 2 has: fields of the interfaces of their names.
MESSAGES = {
    "octomap_msgs/msg/Octomap": "std_msgs/Header header\nbool binary\nstring id\nfloat64 resolution\nint8[] data",
    "octomap_msgs/msg/OctomapWithPose": "std_msgs/Header header\ngeometry_msgs/Pose origin\noctomap_msgs/Octomap octomap",
    "object_recognition_msgs/msg/ObjectType": "string key\nstring db",
    "moveit_msgs/msg/CollisionObject": """std_msgs/Header header
geometry_msgs/Pose pose
string id
object_recognition_msgs/ObjectType type
shape_msgs/SolidPrimitive[] primitives
geometry_msgs/Pose[] primitive_poses
shape_msgs/Mesh[] meshes
geometry_msgs/Pose[] mesh_poses
shape_msgs/Plane[] planes
geometry_msgs/Pose[] plane_poses
string[] subframe_names
geometry_msgs/Pose[] subframe_poses
byte operation""",
    "moveit_msgs/msg/AttachedCollisionObject": """string link_name
moveit_msgs/CollisionObject object
string[] touch_links
trajectory_msgs/JointTrajectory detach_posture
float64 weight""",
    "moveit_msgs/msg/RobotState": """sensor_msgs/JointState joint_state
sensor_msgs/MultiDOFJointState multi_dof_joint_state
moveit_msgs/AttachedCollisionObject[] attached_collision_objects
bool is_diff""",
    "moveit_msgs/msg/AllowedCollisionEntry": "bool[] enabled",
    "moveit_msgs/msg/AllowedCollisionMatrix": """string[] entry_names
moveit_msgs/AllowedCollisionEntry[] entry_values
string[] default_entry_names
bool[] default_entry_values""",
    "moveit_msgs/msg/LinkPadding": "string link_name\nfloat64 padding",
    "moveit_msgs/msg/LinkScale": "string link_name\nfloat64 scale",
    "moveit_msgs/msg/ObjectColor": "string id\nstd_msgs/ColorRGBA color",
    "moveit_msgs/msg/PlanningSceneWorld": "moveit_msgs/CollisionObject[] collision_objects\noctomap_msgs/OctomapWithPose octomap",
    "moveit_msgs/msg/PlanningScene": """string name
moveit_msgs/RobotState robot_state
string robot_model_name
geometry_msgs/TransformStamped[] fixed_frame_transforms
moveit_msgs/AllowedCollisionMatrix allowed_collision_matrix
moveit_msgs/LinkPadding[] link_padding
moveit_msgs/LinkScale[] link_scale
moveit_msgs/ObjectColor[] object_colors
moveit_msgs/PlanningSceneWorld world
bool is_diff""",
}


def snug(*words):
    done = subprocess.run([SNUG, *map(str, words)], text=True, capture_output=True, timeout=600, check=False, cwd=ROOT)
    assert done.returncode == 0, (words, done.returncode, done.stderr)
    return done


def rotation(w, x, y, z):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


class Exports(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.scratch.name)
        program = cls.folder / "p.csv"
        snug("program", CELL, ROOT / "scenarios" / "demo-placements.yaml", "--sequence", "1", "-o", program)
        cls.run_file = cls.folder / "run.h5"
        snug("simulate", CELL, "--program", program, "--sequence", "1", "--robot", "ur10", "--until", "12", "-o", cls.run_file)

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def columns(self):
        import snug as module
        recording = module.Recording(self.run_file)
        return recording, recording.read()

    def test_mcap_is_decoded_by_its_own_package(self):
        from mcap.reader import make_reader
        from mcap_protobuf.decoder import DecoderFactory
        snug("export", self.run_file, "--format", "mcap", "-o", self.folder / "run.mcap")
        recording, columns = self.columns()
        with open(self.folder / "run.mcap", "rb") as file:
            reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
            poses = [message for _, _, _, message in reader.iter_decoded_messages(topics=["/tool/pose"])]
            scenes = [message for _, _, _, message in reader.iter_decoded_messages(topics=["/scene", "/robot/scene", "/joint_states"])]
        self.assertEqual(len(poses), len(columns["time"]))
        position = np.array([[p.pose.position.x, p.pose.position.y, p.pose.position.z] for p in poses])
        np.testing.assert_array_equal(position, columns["tool"][:, :3])
        self.assertEqual(scenes[0].DESCRIPTOR.full_name, "foxglove.SceneUpdate")
        self.assertEqual([joint.name for joint in scenes[-1].joints], recording.joint_names)

    def test_planning_scene_is_the_message(self):
        from rosbags.typesys import Stores, get_types_from_msg, get_typestore
        store = get_typestore(Stores.ROS2_HUMBLE)
        types = {}
        for name, text in MESSAGES.items():
            types.update(get_types_from_msg(text, name))
        store.register(types)
        snug("export", self.run_file, "--format", "moveit-scene", "--time", HELD, "-o", self.folder / "scene.yaml")
        values = yaml.load((self.folder / "scene.yaml").read_text(), Strict)
        message = build(store, "moveit_msgs/msg/PlanningScene", values)
        raw = store.serialize_cdr(message, "moveit_msgs/msg/PlanningScene")
        again = store.deserialize_cdr(raw, "moveit_msgs/msg/PlanningScene")
        self.assertEqual(bytes(store.serialize_cdr(again, "moveit_msgs/msg/PlanningScene")), bytes(raw))

        recording, columns = self.columns()
        frame = int(np.argmin(np.abs(columns["time"] - HELD)))
        objects = {item.id: item for item in message.world.collision_objects}
        held = [item for item in message.robot_state.attached_collision_objects if item.object.id != "tool"]
        self.assertEqual([item.object.id[:3] for item in held], ["BOX"])
        self.assertEqual(len(message.robot_state.attached_collision_objects), 2)
        there = {name for name, present in zip(recording.names, columns["present"][frame]) if present and not name.startswith("robot/")}
        self.assertEqual(set(objects) | {held[0].object.id, "tool"}, there)
        np.testing.assert_array_equal(message.robot_state.joint_state.position, columns["joints"][frame])
        # Boxes stand at the poses of the recording relative to the robot's root, a link of its URDF.
        root = message.world.collision_objects[0].header.frame_id
        self.assertIn(f'<link name="{root}"', (ROOT / "scenarios" / "robots" / "ur10.urdf").read_text())
        self.assertIn(f'<link name="{held[0].link_name}"', (ROOT / "scenarios" / "robots" / "ur10.urdf").read_text())
        base = columns["poses"][frame, recording.names.index("robot/base_link")]
        self.assertEqual(root, "base_link")
        for name, item in [*objects.items(), (held[0].object.id, held[0].object)]:
            pose = columns["poses"][frame, recording.names.index(name)]
            expected = rotation(*base[3:]).T @ (pose[:3] - base[:3])
            got = np.array([item.pose.position.x, item.pose.position.y, item.pose.position.z])
            np.testing.assert_allclose(got, expected, atol=1e-12, err_msg=name)
            turned = rotation(item.pose.orientation.w, item.pose.orientation.x, item.pose.orientation.y, item.pose.orientation.z)
            np.testing.assert_allclose(turned, rotation(*base[3:]).T @ rotation(*pose[3:]), atol=1e-12, err_msg=name)
            self.assertEqual(len(item.primitives), len(item.primitive_poses))
            self.assertEqual(len(item.meshes), len(item.mesh_poses))
            self.assertGreater(len(item.primitives) + len(item.meshes), 0)

    def test_rerun_reads_its_file(self):
        import rerun as rr
        import snug as module
        path = module.to_rerun(self.run_file, self.folder / "run.rrd", every=5)
        recording, columns = self.columns()
        self.assertEqual([entry.name for entry in self.folder.iterdir() if "snug-part" in entry.name], [])
        read = rr.dataframe.load_recording(str(path))
        entities = {column.entity_path for column in read.schema().component_columns()}
        for entity in ("/W/tote1", "/W/robot\\/base_link/0", "/W/E", "/cup/pressure_gauge", "/joints/elbow_joint", "/events"):
            self.assertIn(entity, entities)

        def positions(entity):
            table = read.view(index="time", contents=entity).select().read_all()
            return np.array([row[0] for row in table.column(f"{entity}:Translation3D").to_pylist() if row])

        np.testing.assert_allclose(positions("/W/E"), columns["tool"][::5, :3], atol=1e-6)  # single precision
        box = next(name for name in recording.names if name.startswith("BOX"))
        index = recording.names.index(box)
        there = columns["present"][::5, index]
        np.testing.assert_allclose(positions(f"/W/{box}")[-1], columns["poses"][::5, index][there][-1, :3], atol=1e-6)

    def test_usd_has_the_positions_of_the_recording(self):
        from pxr import Usd, UsdGeom
        import snug as module
        recording, columns = self.columns()
        for ending in (".usda", ".usdc"):
            stage = Usd.Stage.Open(str(module.to_usd(recording, self.folder / f"run{ending}")))
            self.assertEqual(UsdGeom.GetStageUpAxis(stage), "Z")
            self.assertEqual(UsdGeom.GetStageMetersPerUnit(stage), 1.0)
            rate = stage.GetTimeCodesPerSecond()
            prims = {prim.GetDisplayName() or prim.GetName(): prim for prim in stage.GetPrimAtPath("/W").GetChildren()}
            self.assertEqual(set(prims), {*recording.names, "E"})
            for frame in range(0, len(columns["time"]), 97):
                code = Usd.TimeCode(columns["time"][frame] * rate)
                cache = UsdGeom.XformCache(code)
                for index, name in enumerate(recording.names):
                    is_there = bool(columns["present"][frame, index])
                    self.assertEqual(UsdGeom.Imageable(prims[name]).ComputeVisibility(code) != "invisible", is_there, (name, frame))
                    if is_there:
                        world = np.array(cache.GetLocalToWorldTransform(prims[name]))
                        pose = columns["poses"][frame, index]
                        np.testing.assert_allclose(world[3, :3], pose[:3], atol=1e-9, err_msg=name)
                        np.testing.assert_allclose(world[:3, :3].T, rotation(*pose[3:]), atol=1e-6, err_msg=name)
            box = prims[next(name for name in recording.names if name.startswith("BOX"))]
            bounds = UsdGeom.Imageable(box.GetChild("shape_0")).ComputeUntransformedBound(Usd.TimeCode.Default(), "default")
            self.assertGreater(min(bounds.ComputeAlignedRange().GetSize()), 0.05)
        self.assertEqual([entry.name for entry in self.folder.iterdir() if "snug-part" in entry.name], [])

    def test_what_cannot_be_written_is_said(self):
        import snug as module
        for write, name in ((module.to_usd, "run.obj"), (module.to_rerun, "run.mcap")):
            with self.assertRaises(module.InputError) as caught:
                write(self.run_file, self.folder / name)
            self.assertIn(name, str(caught.exception))

    def test_xarray_knows_axes_and_units(self):
        import xarray
        recording, columns = self.columns()
        with xarray.open_dataset(self.run_file, engine="h5netcdf", group="bodies") as bodies:
            self.assertEqual(bodies["twist"].dims, ("time", "name", "twist_part"))
            np.testing.assert_array_equal(bodies["mass"].dims, ("name",))
        with xarray.open_dataset(self.run_file, engine="h5netcdf", group="tool") as tool:
            self.assertEqual(tool["pose"].dims, ("time", "pose_part"))
            np.testing.assert_array_equal(tool["pose"].values, columns["tool"])
        with xarray.open_dataset(self.run_file, engine="h5netcdf", group="cup") as cup:
            self.assertEqual(cup["pressure_gauge"].attrs["units"], "Pa")
        with xarray.open_dataset(self.run_file, engine="h5netcdf", phony_dims="sort") as root:
            np.testing.assert_array_equal(root["time"].values, columns["time"])
            self.assertEqual(root["time"].attrs["units"], "s")
            self.assertEqual([bytes(part).rstrip(b"\0").decode() if isinstance(part, bytes) else part for part in root["pose_part"].values.tolist()],
                             ["x", "y", "z", "qw", "qx", "qy", "qz"])
        with xarray.open_dataset(self.run_file, engine="h5netcdf", group="events", phony_dims="sort") as events:
            self.assertEqual(events["kind"].dims, ("time",))
            self.assertEqual(events.sizes["time"], len(recording.events))
        groups = xarray.open_groups(self.run_file, engine="h5netcdf", phony_dims="sort")
        bodies = groups["/bodies"].assign_coords(time=groups["/"].time)
        box = next(name for name in recording.names if name.startswith("BOX"))
        part = bodies.pose.sel(time=slice(5, 6), name=box.encode())
        rows = (columns["time"] >= 5.0) & (columns["time"] <= 6.0)
        np.testing.assert_array_equal(part.values, columns["poses"][rows, recording.names.index(box)])
        for group in groups.values():
            group.close()

    def test_table_of_a_study_becomes_parquet(self):
        """As docs/studies.md says it."""
        import pandas
        study = ROOT / "scenarios" / "examples" / "friction.yaml"
        snug("study", study, "--dir", self.folder / "tables", "--threads", 1)
        snug("study", "merge", study, "--dir", self.folder / "tables", "-o", self.folder / "friction.csv")
        table = pandas.read_csv(self.folder / "friction.csv")
        table.to_parquet(self.folder / "friction.parquet")
        again = pandas.read_parquet(self.folder / "friction.parquet")
        pandas.testing.assert_frame_equal(again, table)
        self.assertGreater(len(table), 10)
        self.assertGreater(len(table.select_dtypes("number").columns), 2)


class Schemas(unittest.TestCase):
    def test_workflows(self):
        files = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
        self.assertGreater(len(files), 1)
        check = [sys.executable, "-m", "check_jsonschema", "--builtin-schema", "vendor.github-workflows"]
        done = subprocess.run([*check, *map(str, files)], capture_output=True, text=True, timeout=300, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with tempfile.TemporaryDirectory() as folder:
            wrong = Path(folder) / "wrong.yml"
            wrong.write_text(files[0].read_text().replace("runs-on:", "run-on:"))
            self.assertNotEqual(subprocess.run([*check, str(wrong)], capture_output=True, timeout=300, check=False).returncode, 0)

    def test_workflows_call_verbs_of_the_makefile(self):
        verbs = {line.split(":")[0] for line in (ROOT / "Makefile").read_text().splitlines() if line[:1].isalpha() and ": " in line}
        for path in (ROOT / ".github" / "workflows").glob("*.yml"):
            for job in yaml.safe_load(path.read_text())["jobs"].values():
                included = job.get("strategy", {}).get("matrix", {})
                named = [*included.get("verb", []), *(entry["verb"] for entry in included.get("include", []) if "verb" in entry)]
                for verb in named:
                    self.assertIn(verb.split()[0], verbs, path.name)

    def test_job_of_kubernetes(self):
        import kubernetes_validate
        job = yaml.safe_load((ROOT / "examples" / "studies" / "indexed-job.yaml").read_text())
        kubernetes_validate.validate(job, kubernetes_validate.latest_version(), strict=True)
        self.assertEqual(job["spec"]["completionMode"], "Indexed")
        self.assertEqual(job["spec"]["completions"], 7)  # 64 chunks in tens
        job["spec"]["completion"] = 7
        with self.assertRaises(kubernetes_validate.ValidationError):
            kubernetes_validate.validate(job, kubernetes_validate.latest_version(), strict=True)


class Strict(yaml.SafeLoader):
    """A key twice is an error."""

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key) for key, _ in node.value]
        assert len(keys) == len(set(keys)), keys
        return super().construct_mapping(node, deep)


def build(store, name, values):
    """The message of these values, the rest as a message begins; a key that it does not have, or a value of another kind, is an error."""
    from rosbags.interfaces import Nodetype
    fields = dict(store.fielddefs[name][1])
    unknown = set(values) - set(fields)
    assert not unknown, (name, unknown)

    def number(kind, value):
        if kind in ("float32", "float64"):
            assert isinstance(value, float), (name, value)
        elif kind == "string":
            assert isinstance(value, str), (name, value)
        elif kind == "bool":
            assert isinstance(value, bool), (name, value)
        else:
            assert isinstance(value, int) and not isinstance(value, bool), (name, kind, value)
        return value

    def made(definition, value, is_given):
        kind, detail = definition
        if kind == Nodetype.NAME:
            return build(store, detail, value if is_given else {})
        if kind == Nodetype.BASE:
            return number(detail[0], value) if is_given else {"string": "", "bool": False}.get(detail[0], 0.0 if "float" in detail[0] else 0)
        inner, size = detail
        if not is_given:
            items = [made(inner, None, False) for _ in range(size or 0)]
        else:
            assert isinstance(value, list) and (not size or kind == Nodetype.SEQUENCE or len(value) == size), (name, value)
            items = [made(inner, item, True) for item in value]
        if inner[0] == Nodetype.BASE and inner[1][0] != "string":
            plain = {"bool": "bool", "byte": "uint8", "octet": "uint8", "char": "uint8"}.get(inner[1][0], inner[1][0])
            return np.array(items, dtype=plain)
        return items

    return store.types[name](**{key: made(definition, values.get(key), key in values) for key, definition in fields.items()})


if __name__ == "__main__":
    unittest.main()
