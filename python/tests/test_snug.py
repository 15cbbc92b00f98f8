"""The module: views and their lifetime, snapshots, errors, runs and recordings."""
import csv
import dataclasses
import gc
import importlib.util
import io
import json
import threading
from pathlib import Path

import numpy as np
import pytest

import snug

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "scenarios"


@pytest.fixture(scope="module")
def demonstrator():
    return snug.load_scenario(SCENARIOS / "box-demonstrator.yaml")


@pytest.fixture()
def world():
    return snug.World(snug.load_scenario(SCENARIOS / "drop.yaml"))


def falling():
    """One box 1 m over the floor."""
    return snug.World(snug.parse_scenario("""
materials: [{name: m}]
contacts: {default: {friction: 0.3, restitution: 0.0}}
bodies:
  - {name: floor, kind: static, material: m, shapes: [{box: [2, 2, 0.1]}], pose: {position: [0, 0, -0.05]}}
  - {name: box, kind: dynamic, material: m, mass: 1.0, shapes: [{box: [0.1, 0.1, 0.1]}], pose: {position: [0, 0, 1.05]}}
"""))


class TestErrors:
    def test_a_bad_file_is_an_input_error_with_file_line_and_key(self, tmp_path):
        path = tmp_path / "bad.yaml"
        path.write_text("seed: 1\ntime_step: -1\n")
        with pytest.raises(snug.InputError) as caught:
            snug.load_scenario(path)
        error = caught.value
        assert (error.file, error.line, error.key) == (str(path), 2, "time_step")
        assert error.got and error.expected and str(path) in str(error)
        assert isinstance(error, ValueError)

    def test_a_file_that_is_not_there(self):
        with pytest.raises(snug.InputError):
            snug.load_scenario("/none/there.yaml")

    def test_set_values_are_checked(self, demonstrator):
        with pytest.raises(snug.InputError, match="max_sweeps"):
            demonstrator.with_values({"solver.max_sweeps": -1})

    @pytest.mark.parametrize("call", [
        lambda s: snug.pack(s, "no such sequence"),
        lambda s: snug.pack(s, "1", agent="no such agent"),
        lambda s: snug.pack(s, "1", samples=-1),
        lambda s: snug.simulate(s, cup="wet"),
        lambda s: snug.Cell(s, "none", snug.parse_program("0,0,0,0,0,0,home,0,0,0,0,0,0\n")),
        lambda s: snug.env.Packing(s, mode="imagined"),
        lambda s: snug.env.Packing(s, resolutoin=0.01),
        lambda s: snug.env.Packing(s, action="shout"),
        lambda s: snug.parse_program("1,2\n"),
        lambda s: snug.Recording("/none/there.h5"),
        lambda s: snug.pose(np.zeros((4, 4))),
    ])
    def test_arguments_are_checked(self, demonstrator, call):
        with pytest.raises(snug.InputError):
            call(demonstrator)


class TestScenario:
    def test_tells_what_is_in_it(self, demonstrator):
        assert demonstrator.name == "box-demonstrator"
        assert "1" in demonstrator.sequences
        parcel = demonstrator.parcels[0]
        assert parcel["id"] == demonstrator.sequences["1"][0] or parcel["size"].shape == (3,)
        assert demonstrator.container["inner_size"] == pytest.approx([0.37, 0.57, 0.25])

    def test_a_changed_one_says_so_in_its_text_and_leaves_the_first(self, demonstrator):
        changed = demonstrator.with_values({"time_step": 0.002, "gravity": np.array([0, 0, -1.6])})
        assert (changed.time_step, demonstrator.time_step) == (0.002, 0.001)
        assert snug.parse_scenario(changed.text, changed.source).time_step == 0.002
        assert changed != demonstrator

    def test_those_that_come_with_it_are_found_by_name(self, demonstrator, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        assert snug.load_scenario("box-demonstrator").text == demonstrator.text
        assert {"box-demonstrator", "drop", "bench/s6a"} <= set(snug.scenario_names())
        with pytest.raises(snug.InputError, match="'box-demonstrator'"):
            snug.load_scenario("box-demonstratr")
        (tmp_path / "drop.yaml").write_text("materials: [{name: m}]\nseed: 77\n")
        try:
            assert snug.load_scenario("drop").seed == 77  # one's own comes first
        except snug.InputError as error:
            assert error.file == "drop.yaml"

    def test_items_come_from_a_file_or_a_table(self, demonstrator, tmp_path):
        @dataclasses.dataclass
        class Line:
            order: str
            article: str
            length_mm: float
            width_mm: float
            height_mm: float
            mass_kg: float
            count: int

        lines = [Line("mine", "kettle, large", 235, 170, 190, 1.2, 2), Line("mine", "plates", 200, 200, 95, 2.4, 1)]
        path = tmp_path / "items.csv"
        path.write_text('order,article,length_mm,width_mm,height_mm,mass_kg,count\n'
                        'mine,"kettle, large",235,170,190,1.2,2\nmine,plates,200,200,95,2.4,1\n')
        try:
            expected = demonstrator.with_items(path).parcels[len(demonstrator.parcels):]
        except snug.InputError:
            pytest.fail("quoted cells are read")
        for table in (lines, [dataclasses.asdict(line) for line in lines], (vars(line) for line in lines)):
            changed = demonstrator.with_items(table)
            assert len(changed.sequences["mine"]) == 3
            assert [p["size"].tolist() for p in changed.parcels[len(demonstrator.parcels):]] == [p["size"].tolist() for p in expected]
        for wrong in ([], [3], [{"order": "a"}], [{**vars(lines[0]), "mass_kg": "heavy"}], 7):
            with pytest.raises((snug.InputError, TypeError)):
                demonstrator.with_items(wrong)

    def test_empty_cells_of_a_table_are_left_to_their_defaults(self, demonstrator):
        line = {"order": "o", "article": "a", "length_mm": 200, "width_mm": 150, "height_mm": 100, "mass_kg": 1.0}
        lines = [{**line, "upright_only": True}, {**line, "upright_only": float("nan")}, line]
        assert len(demonstrator.with_items(lines).sequences["o"]) == 3

    def test_poses_turn_into_matrices_and_back(self):
        pose = np.array([1.0, 2.0, 3.0, 0.5, 0.5, 0.5, 0.5])
        matrix = snug.matrix(pose)
        assert matrix @ [1, 0, 0, 1] == pytest.approx([1, 3, 3, 1])
        assert snug.pose(matrix) == pytest.approx(pose)


class TestWorld:
    def test_a_box_falls_as_it_should(self):
        world = falling()
        steps = 300
        world.step(steps)
        fallen = 1.05 - world.pose("box")[2]
        # Symplectic Euler: g dt^2 n (n + 1) / 2; midpoint schemes g (n dt)^2 / 2: both within one step's fall.
        assert fallen == pytest.approx(0.5 * 9.81 * 0.3**2, abs=9.81 * 0.3 * world.dt)
        world.step(1500)
        assert world.pose("box")[2] == pytest.approx(0.05, abs=1e-4)

    def test_views_are_live_read_only_and_share_memory(self, world):
        positions = world.positions
        before = positions.copy()
        world.step(200)
        assert not np.array_equal(positions, before)
        assert np.shares_memory(positions, world.positions)
        for view in (positions, world.velocities, world.quaternions_xyzw, world.angular_velocities, world.present):
            assert len(view) == len(world.names)
            with pytest.raises(ValueError):
                view[0] = 0

    def test_views_outlive_their_world(self):
        world = falling()
        world.step(10)
        view = world.positions
        expected = view.copy()
        del world
        gc.collect()
        junk = [np.ones(1000) for _ in range(1000)]
        assert np.array_equal(view, expected)
        del junk

    def test_views_stay_where_they_are_after_restore(self, world):
        view = world.positions
        address = view.__array_interface__["data"]
        start = world.snapshot()
        first = view.copy()
        world.step(100)
        world.restore(start)
        assert world.positions.__array_interface__["data"] == address
        assert np.array_equal(view, first)

    def test_a_snapshot_goes_on_with_the_same_bytes(self, world):
        world.step(500)
        snapshot = world.snapshot()
        world.step(700)
        end, time = world.hash, world.time
        world.restore(snapshot)
        assert world.hash == snapshot.hash != end
        world.step(700)
        assert (world.hash, world.time) == (end, time)

    def test_a_snapshot_of_another_world_is_refused(self, world):
        with pytest.raises(snug.InputError):
            world.restore(falling().snapshot())

    def test_poses_are_copies_or_go_where_asked(self, world):
        world.step(10)
        poses = world.poses()
        assert poses.shape == (len(world.names), 7)
        assert np.linalg.norm(poses[:, 3:], axis=1) == pytest.approx(1.0)
        assert poses[-1] == pytest.approx(world.pose(world.names[-1]))
        kept = poses.copy()
        world.step(100)
        assert np.array_equal(poses, kept)
        out = np.empty_like(poses)
        assert world.poses(out=out) is out or np.array_equal(world.poses(out=out), out)
        assert np.array_equal(out, world.poses())
        with pytest.raises((snug.InputError, TypeError)):
            world.poses(out=np.empty((1, 7)))

    def test_a_body_is_moved_and_pushed(self):
        world = falling()
        world.set_pose("box", [0, 0, 3, 1, 0, 0, 0])
        world.set_twist("box", [1, 0, 0], [0, 0, 0])
        world.step(100)
        assert world.pose("box")[0] == pytest.approx(0.1, abs=1e-9)
        with pytest.raises(snug.InputError, match="box"):
            world.pose("bax")
        with pytest.raises(snug.InputError):
            world.set_pose("box", [np.nan, 0, 0, 1, 0, 0, 0])

    def test_contacts_carry_the_weight(self):
        world = falling()
        world.step(2500)
        force = sum(contact["force"] * (1 if contact["bodies"][1] == "box" else -1) for contact in world.contacts())
        assert force == pytest.approx([0, 0, 9.81], abs=0.01)

    def test_two_threads_on_one_world_are_refused_not_crashed(self, world):
        refused = []

        def work():
            for _ in range(200):
                try:
                    world.step(5)
                except RuntimeError as error:
                    refused.append(str(error))
                world.positions.sum()

        threads = [threading.Thread(target=work) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert all("another thread" in text for text in refused)


class TestCell:
    @pytest.fixture(scope="class")
    def program(self, demonstrator, request):
        result = snug.pack(demonstrator, "1", agent="margin", samples=0, robot="none", decision_time=0.01, threads=1)
        return result.program

    def test_a_program_steps_tick_by_tick(self, demonstrator, program):
        cell = snug.Cell(demonstrator, "1", program, cup="phases")
        for _ in range(1000):
            assert cell.step()
        assert cell.time == pytest.approx(1000 * cell.tick)
        assert cell.tool.shape == (7,)
        assert cell.cup["phase"] in ("free", "holding", "releasing")
        assert cell.row >= 0 and not cell.has_ended

    def test_a_snapshot_goes_on_with_the_same_bytes(self, demonstrator, program):
        cell = snug.Cell(demonstrator, "1", program, cup="phases")
        cell.step(500)
        snapshot = cell.snapshot()
        cell.step(1500)
        end = cell.hash
        cell.restore(snapshot)
        assert cell.hash != end
        cell.step(1500)
        assert cell.hash == end

    def test_run_to_the_end_is_what_simulate_says(self, demonstrator, program, tmp_path):
        cell = snug.Cell(demonstrator, "1", program, cup="phases")
        cell.run()
        assert cell.has_ended
        record = tmp_path / "run.h5"
        result = snug.simulate(demonstrator, program, "1", cup="phases", record=record)
        assert result.failure == ""
        states = {box["id"]: box["state"] for box in cell.boxes()}
        assert states == {box["id"]: box["state"] for box in result.boxes}
        recording = snug.Recording(record)
        columns = recording.read(every=10)
        assert columns["poses"].shape == (len(columns["time"]), len(recording.names), 7)
        assert np.all(np.diff(columns["time"]) > 0)
        assert recording.result["boxes"] == result.boxes
        assert recording.is_complete and recording.events


class TestTools:
    def test_the_cup_at_rest_has_no_wrench_and_its_tangent_is_its_stiffness(self, demonstrator):
        cup = snug.Cup(demonstrator)
        at_rest = [0, 0, 0, 1, 0, 0, 0]
        assert cup.wrench(at_rest) == pytest.approx(np.zeros(6))
        pulled = cup.wrench([0, 0, 1e-4, 1, 0, 0, 0])
        assert pulled[2] == pytest.approx(-cup.stiffness[2, 2] * 1e-4, rel=1e-3)

    def test_a_lift_tells_the_payload(self, demonstrator):
        lift = np.genfromtxt(ROOT / "scenarios" / "examples" / "lift.csv", delimiter=",", skip_header=1)
        found = snug.Cup(demonstrator).payload(lift[:, 0], lift[:, 1:8], lift[:, 8:14])
        numbers = {one["name"]: one for one in found["parameters"]}
        assert numbers["mass"]["verdict"] == "identified"
        assert numbers["mass"]["value"] * 9.81 == pytest.approx(-np.median(lift[:, 10]), rel=0.05)
        for wrong in ((lift[::-1, 0], lift[:, 1:8], lift[:, 8:14]), (lift[:, 0], lift[:, 1:7], lift[:, 8:14]),
                      (lift[:, 0], lift[:, 1:8], lift[1:, 8:14]), (lift[:2, 0], lift[:2, 1:8], lift[:2, 8:14]),
                      (lift[:, 0], lift[:, 1:8], lift[:, 8:14] * np.nan)):
            with pytest.raises(snug.InputError):
                snug.Cup(demonstrator).payload(*wrong)

    def test_a_load_settles_by_its_weight(self, demonstrator):
        cup = snug.Cup(demonstrator)
        settled = cup.settle(1.0)
        assert settled["status"] == "converged" and settled["is_stable"]
        assert settled["lip"][2] - cup.hold_length == pytest.approx(9.81 / cup.stiffness[2, 2], rel=0.01)

    def test_the_arm_reaches_where_it_was(self, demonstrator):
        arm = snug.Arm(demonstrator)
        q = np.array([0.3, -1.2, 1.5, -1.0, -1.5, 0.4])
        pose = arm.forward(q)
        assert arm.inverse(pose, q) == pytest.approx(q, abs=1e-8)
        assert 1 <= len(arm.branches(pose, q)) <= 8
        assert arm.inverse([9, 9, 9, 1, 0, 0, 0], q) is None
        step = 1e-6
        numeric = (arm.forward(q + step * np.eye(6)[2])[:3] - arm.forward(q - step * np.eye(6)[2])[:3]) / (2 * step)
        assert arm.jacobian(q)[:3, 2] == pytest.approx(numeric, abs=1e-6)


class TestPacking:
    def test_agents_place_item_by_item(self, demonstrator):
        packer = snug.Packer(demonstrator, "contact-aware", decision_time=0.01)
        for parcel in demonstrator.sequences["1"]:
            candidates = packer.decide(parcel)
            if isinstance(candidates, str):
                break
            packer.place(parcel)
        assert packer.percent > 40
        assert len(packer.boxes()) >= 5

    def test_a_tempo_moves_fast_and_the_program_remembers(self, demonstrator):
        words = dict(agent="margin", samples=0, robot="none", decision_time=0.01, threads=1)
        fast, lagged = snug.pack(demonstrator, "1", **words), snug.pack(demonstrator, "1", tempo=None, **words)
        assert (fast.controller, fast.tempo) == ("fast", 1.0)
        assert (lagged.controller, lagged.tempo) == ("lagged", None)
        assert fast.boxes_per_hour > lagged.boxes_per_hour
        assert fast.program.to_csv().startswith("# tempo: 1")
        own, slow = (snug.simulate(demonstrator, fast.program, "1", cup="phases", controller=controller)["duration_s"]
                     for controller in (None, "lagged"))
        assert own < slow
        with pytest.raises(snug.InputError, match="tempo"):
            snug.pack(demonstrator, "1", tempo=0.4, **words)

    def test_packing_twice_is_the_same(self, demonstrator):
        words = dict(agent="margin", samples=0, robot="none", decision_time=0.01, threads=1)
        first, second = snug.pack(demonstrator, "1", **words), snug.pack(demonstrator, "1", **words)
        assert first.state_hash == second.state_hash
        assert first.program.to_csv() == second.program.to_csv()
        assert first.executed_boxes >= 5
        with pytest.raises(AttributeError, match="executed_boxes"):
            first.no_such_word

    def test_an_agent_is_any_object_that_decides(self, demonstrator):
        class Last:
            asked = 0

            def begin(self, settings, container, future):
                assert container["inner_size"] and future

            def decide(self, state, item, candidates):
                Last.asked += 1
                assert item.size and isinstance(state.boxes, list)
                return candidates[:3]

        result = snug.pack(demonstrator, "1", agent=Last(), samples=0, robot="none", threads=1)
        assert result.agent == "Last" and Last.asked >= 3 and result.executed_boxes >= 3

    def test_what_an_agent_raises_comes_through(self, demonstrator):
        class Broken:
            def decide(self, state, item, candidates):
                raise KeyError("oh")

        with pytest.raises(KeyError):
            snug.pack(demonstrator, "1", agent=Broken(), samples=0, robot="none")

    def test_repeated_runs_are_the_same_at_any_number_of_threads_also_beside_others(self, demonstrator):
        """Each is a process of its own, split off from this one while another thread of it prints and allocates."""
        done = threading.Event()

        def work():
            while not done.is_set():
                json.dumps([str(i) for i in range(1000)])

        thread = threading.Thread(target=work)
        thread.start()
        try:
            one, two = (snug.pack(demonstrator, "1", agent="margin", samples=0, robot="none", decision_time=0.01, threads=threads,
                                  monte_carlo=6).monte_carlo for threads in (1, 2))
        finally:
            done.set()
            thread.join()
        assert one == two
        assert one["count"] == 6 and one["failed"] == 0 and len(one["items"]) >= 5
        assert all(item["succeeded"] <= 6 and item["worst_distance_mm"] > 0 for item in one["items"] if item["succeeded"])

    def test_packing_runs_beside_other_threads(self, demonstrator):
        ticks = []
        done = threading.Event()

        def count():
            while not done.wait(0.001):
                ticks.append(1)

        thread = threading.Thread(target=count)
        thread.start()
        snug.pack(demonstrator, "1", agent="margin", samples=0, robot="none", decision_time=0.01, threads=1)
        done.set()
        thread.join()
        assert len(ticks) > 20


def test_a_report_is_one_file(demonstrator, tmp_path):
    record = tmp_path / "drop.h5"
    snug.simulate(snug.load_scenario(SCENARIOS / "drop.yaml"), until=0.2, record=record)
    page = snug.report(record, tmp_path / "drop.html")
    text = page.read_text()
    assert "<html" in text and len(text) > 100_000
    assert "<iframe" in snug.Recording(record)._repr_html_()


def test_a_recording_tells_bodies_and_other_formats_name_their_package(tmp_path):
    record = tmp_path / "slide.h5"
    snug.simulate(snug.load_scenario(SCENARIOS / "drop.yaml"), until=0.1, record=record)
    recording = snug.Recording(record)
    bodies = recording.bodies
    assert [body["name"] for body in bodies] == recording.names
    parcel = bodies[recording.names.index("parcel")]
    assert parcel["kind"] == "dynamic" and parcel["mass"] > 0.0
    assert [shape["kind"] for shape in parcel["shapes"]] == ["box"]
    assert len(parcel["shapes"][0]["size"]) == 3 and parcel["shapes"][0]["pose"].shape == (7,)
    for write, module, name in ((snug.to_rerun, "rerun", "run.rrd"), (snug.to_usd, "pxr", "run.usda")):
        if importlib.util.find_spec(module) is None:
            with pytest.raises(ImportError, match=r"pip install snug\["):
                write(record, tmp_path / name)
        assert not (tmp_path / name).exists()


def test_objects_say_what_they_are(demonstrator, world):
    assert repr(demonstrator) == ("<snug.Scenario 'box-demonstrator': %d parcels, %d sequences, %s, container 370 x 570 x 250 mm>" % (
        len(demonstrator.parcels), len(demonstrator.sequences), repr(demonstrator).split(", ")[2]))
    world.step(100)
    assert repr(world).startswith("<snug.World 'drop': ") and repr(world).endswith("t = 0.100 s>")
    assert "lip radius" in repr(snug.Cup(demonstrator)) and "6 joints" in repr(snug.Arm(demonstrator))
    assert repr(snug.Packer(demonstrator)) == "<snug.Packer: 0 boxes, 0.0 % of the container>"
    assert "0.0 % packed" in repr(snug.env.Packing(demonstrator))


def test_results_are_short_to_look_at_and_flat_records(world):
    result = snug.simulate(world.scenario, until=0.1)
    assert "duration_s: 0.1" in repr(result) and "solver: 6 of them" in repr(result) and len(repr(result)) < 1500
    (record,) = result.records("bodies")
    assert record["X_WB.p.2"] == result["bodies"][0]["X_WB"]["p"][2] and record["name"] == "parcel"
    assert result.records("events") == []
    table = io.StringIO()
    writer = csv.DictWriter(table, record)
    writer.writeheader()
    writer.writerow(record)
    for key in ("solver", "nothing", "duration_s"):
        with pytest.raises(snug.InputError, match="bodies"):
            result.records(key)


def test_the_command_of_the_wheel_gives_way_to_the_program(tmp_path):
    """With a program that tells its words; exit codes pass."""
    import shutil
    import subprocess
    import sys

    shutil.copy(ROOT / "python" / "_snug_program.py", tmp_path)
    run = [sys.executable, "-c", "import sys; sys.argv[0] = 'snug'; import _snug_program; _snug_program.main()", "a b", "--c"]
    missing = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert missing.returncode == 1 and "expected the program of the wheel" in missing.stderr
    program = tmp_path / "snug" / "bin" / "snug"
    program.parent.mkdir(parents=True)
    program.write_text('#!/bin/sh\nprintf "%s|" "$@" "$SNUG_PYTHON"\nexit 3\n')
    program.chmod(0o755)
    done = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (3, f"a b|--c|{sys.executable}|")
