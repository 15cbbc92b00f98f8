#!/usr/bin/env python3
"""urscript_test.py: what `snug export --format urscript` writes, run on a robot that moves in time."""
import json
import math
import re
import tempfile
import unittest
from pathlib import Path

from cli_test import CELL, ROOT, snug
from urscript_robot import Halted, Robot, ScriptError

URDF = ROOT / "scenarios" / "robots" / "ur10.urdf"
REAL = ROOT.parent / "shared" / "data" / "waypoints" / "poses1real.csv"
GRIPPER = 1.22  # kg: sensor, gripper and cup of the URDF
PRECISE = 1e-5  # m, of printed poses


def row(x, y, z, name, vacuum=0, blow_off=0):
    return f"{x},{y},{z},0,3.14159,0,{name},{vacuum},{blow_off},0,0,0,0\n"


# A box is picked, carried through rows that are passed and lie nearer to each other than their blends are wide, and set
# down; rows without a way (the pick and the release) are in it, and a row that is there twice.
PROGRAM = (row(-0.469, -0.422, 0.37, "PrePick027") + row(-0.494, -0.43, 0.06, "Box027") + row(-0.494, -0.43, 0.06, "Box027", 1)
           + row(-0.494, -0.43, 0.366, "PostPick027", 1) + row(-0.464, -0.43, 0.366, "midpoint", 1)
           + row(-0.434, -0.44, 0.366, "midpoint", 1) + row(-0.404, -0.43, 0.37, "midpoint", 1)
           + row(-0.404, -0.43, 0.37, "midpoint", 1) + row(-0.25, -0.55, 0.36, "midpoint", 1)
           + row(0.505, -0.35, 0.2, "PrePlace027", 1) + row(0.505, -0.35, -0.115, "Place027", 1)
           + row(0.505, -0.35, -0.115, "Place027", 0, 1) + row(0.505, -0.35, 0.2, "PostPlace027") + row(-0.146, -0.69, 0.206, "home"))
PRECISION = {"PostPick": 0.05, "midpoint": 0.2}  # of the scenario, where it is large


def mass_of(box):
    """As the scenario writes it: layers, and a shell that makes up the rest."""
    return float(re.search(rf"id: {box},.*?mass: ([0-9.]+)", CELL.read_text(), re.S).group(1))


class UrScript(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def export(self, program=PROGRAM, *more):
        path, out = self.folder / "program.csv", self.folder / "program.script"
        path.write_text(program)
        result = snug("export", path, "--scenario", CELL, "--sequence", "1", "--format", "urscript", "-o", out, *more)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.stderr = result.stderr
        return out.read_text()

    def run_script(self, text, **settings):
        robot = Robot(URDF, **settings)
        robot.run(text)
        return robot

    def rows(self, program):
        return [line.split(",") for line in program.splitlines()]

    def test_every_row_is_passed_within_its_precision_and_the_others_are_stopped_at(self):
        robot = self.run_script(self.export())
        goals = {tuple(round(x, 4) for x in move.goal[1]): move for move in robot.moves}
        for cells in self.rows(PROGRAM):
            move = goals[tuple(round(float(x), 4) for x in cells[:3])]
            self.assertLess(math.dist(move.goal[1], [float(x) for x in cells[:3]]), PRECISE)
            precision = next((m for name, m in PRECISION.items() if cells[6].startswith(name)), 0.0)
            self.assertLessEqual(move.blend, precision, cells[6])
        self.assertGreaterEqual(sum(move.blend > 0.0 for move in robot.moves), 4)
        self.assertEqual(robot.moves[-1].blend, 0.0)

    def test_blends_do_not_overlap_and_every_move_has_a_length(self):
        robot = self.run_script(self.export())  # raises ScriptError otherwise
        for before, move in zip(robot.moves, robot.moves[1:]):
            self.assertLess(before.blend + move.blend, move.length + (move.blend + before.blend == 0.0))
        self.assertEqual(len(robot.moves), 11)  # of 14 rows: two act without a way, one is there twice

    def test_what_a_robot_refuses_is_noticed(self):
        text = self.export()
        wide = re.sub(r"r=0\.\d+", "r=0.100", text)
        with self.assertRaises(ScriptError):
            self.run_script(wide)
        twice = re.sub(r"(  movel\(.*\n)(end)", r"\1\1\2", text)
        with self.assertRaises(ScriptError):
            self.run_script(twice)

    def test_begins_at_the_joints_of_the_start_where_the_first_row_expects_it(self):
        text = self.export(row(-0.146, -0.69, 0.256, "home"))
        robot = self.run_script(text)
        # The start pose of the scenario is (-0.146, -0.69, 0.206): the joints put the tool there, 50 mm away.
        self.assertAlmostEqual(robot.moves[0].length, 0.05, places=5)
        self.assertLess(robot.moves[0].angle, 1e-4)
        self.assertLess(text.index("movej("), text.index("movel("))

    def test_payload_is_that_of_gripper_and_box_while_it_is_held(self):
        robot = self.run_script(self.export())
        held = [move for move in robot.moves if move.vacuum]
        self.assertEqual(len(held), 7)
        for move in robot.moves:
            mass, com = move.payload
            if not move.vacuum:
                self.assertAlmostEqual(mass, GRIPPER, places=3)
                continue
            box = mass_of("BOX027")
            self.assertAlmostEqual(mass, GRIPPER + box, places=3)
            # The box hangs 335 mm of gripper and 50 mm of cup below tool0, its middle half its height further.
            middle = (com[2] * mass - GRIPPER * robot_com(robot)) / box
            self.assertGreater(middle, 0.335 + 0.05)
            self.assertLess(middle, 0.335 + 0.05 + 0.2)
        self.assertAlmostEqual(robot.payload[0], GRIPPER, places=3)

    def test_a_vacuum_that_does_not_come_halts_before_the_box_is_lifted(self):
        robot = Robot(URDF, seals=False)
        with self.assertRaises(Halted) as halted:
            robot.run(self.export(PROGRAM, "--vacuum-timeout", 1.5))
        self.assertIn("Box027", str(halted.exception))
        self.assertAlmostEqual(robot.time - robot.switched[0], 1.5, delta=0.05)
        self.assertLess(math.dist(robot.moves[-1].goal[1], (-0.494, -0.43, 0.06)), PRECISE)

    def test_a_slow_vacuum_is_waited_for(self):
        text = self.export()
        fast, slow = self.run_script(text, evacuation=0.1), self.run_script(text, evacuation=1.1)
        self.assertAlmostEqual(slow.time - fast.time, 2.0, delta=0.05)  # once to come, once to go

    def test_the_cup_is_empty_before_it_lifts_and_outputs_are_defined_before_the_arm_moves(self):
        for vent in (0.0, 0.3, 1.2):
            text = self.export(PROGRAM, "--vent-time", vent)
            robot = self.run_script(text, evacuation=0.1)
            lift = next(after for before, after in zip(robot.moves, robot.moves[1:]) if before.vacuum and not after.vacuum)
            self.assertGreaterEqual(lift.begin - robot.switched[0], 0.1 + vent)
            self.assertLess(text.index("set_standard_digital_out(1, False)"), text.index("movej("))

    def test_the_gauge_has_the_last_word_of_whether_the_cup_is_empty(self):
        text = self.export(PROGRAM, "--vent-time", 0.1)
        robot = self.run_script(text, evacuation=0.1, lingering=1.0)
        lift = next(after for before, after in zip(robot.moves, robot.moves[1:]) if before.vacuum and not after.vacuum)
        self.assertGreaterEqual(lift.begin - robot.switched[0], 1.1)
        with self.assertRaises(Halted) as halted:
            self.run_script(text, evacuation=0.1, lingering=60.0)
        self.assertIn("the vacuum did not go before Place", str(halted.exception))

    def test_waits_above_the_aligner_until_a_box_is_there(self):
        text = self.export(PROGRAM, "--part-timeout", 30)
        robot = self.run_script(text, part_comes=20.0)
        down = next(move for move in robot.moves if move.begin >= 20.0)
        self.assertLess(math.dist(down.goal[1], (-0.494, -0.43, 0.06)), PRECISE)
        with self.assertRaises(Halted) as halted:
            self.run_script(text, part_comes=1e9)
        self.assertIn("no box came for Box027", str(halted.exception))

    def test_payloads_may_have_their_inertia(self):
        robot = self.run_script(self.export(PROGRAM, "--payload-inertia"))
        self.assertEqual(len(robot.inertia), 6)
        self.assertAlmostEqual(robot.payload[0], GRIPPER, places=3)

    def test_a_dry_run_touches_nothing(self):
        robot = self.run_script(self.export(PROGRAM, "--dry-run"), seals=False, part_comes=1e9)
        self.assertNotIn(True, robot.outputs.values())
        self.assertAlmostEqual(min(move.goal[1][2] for move in robot.moves), -0.115 + 0.02, places=5)
        self.assertGreater(robot.time, 3.0 * self.run_script(self.export(), evacuation=0.1).time)

    def test_inputs_and_outputs_are_those_asked_for(self):
        text = self.export(PROGRAM, "--vacuum-output", 3, "--blow-off-output", 4, "--vacuum-input", 5)
        robot = self.run_script(text, vacuum_output=3, vacuum_input=5)
        self.assertEqual(robot.outputs, {3: False, 4: False})
        result = snug("export", self.folder / "program.csv", "--scenario", CELL, "--format", "urscript", "-o",
                      self.folder / "x", "--vacuum-output", 1)
        self.assertEqual(result.returncode, 2)
        self.assertIn("--blow-off-output", result.stderr)

    def test_ends_at_rest_on_the_last_row_with_everything_off(self):
        robot = self.run_script(self.export())
        self.assertLess(math.dist(robot.pose[1], (-0.146, -0.69, 0.206)), PRECISE)
        self.assertFalse(any(robot.outputs.values()))

    def test_the_nominal_time_is_that_of_its_moves_and_the_other_that_of_the_simulation(self):
        text = self.export()
        robot = self.run_script(text, evacuation=0.5 - 0.004)  # as long as the scenario's wait
        nominal = float(re.search(r"# ([0-9.]+) s nominal", text).group(1))
        self.assertAlmostEqual(robot.time, nominal, delta=0.1)
        simulated = float(re.search(r"Simulated: ([0-9.]+) s", text).group(1))
        result = snug("simulate", CELL, "--program", self.folder / "program.csv", "--sequence", "1", "--json")
        self.assertAlmostEqual(json.loads(result.stdout)["duration_s"], simulated, delta=0.06)
        self.assertIn(f"{nominal:.1f} s nominal", self.stderr)
        self.assertIn(f"{simulated:.1f} s simulated", self.stderr)

    def test_a_box_that_no_name_tells_is_said(self):
        self.export(PROGRAM.replace("027", "999"), "--unchecked")  # in the cell no such box comes
        self.assertIn("payload of the gripper alone", self.stderr)

    def test_a_row_that_is_passed_at_once_is_no_crawl(self):
        # From 25 mm beside it the row is within its precision of 200 mm at once.
        text = self.export(row(-0.146, -0.69, 0.256, "home") + row(-0.146, -0.665, 0.256, "midpoint")
                           + row(-0.146, -0.5, 0.256, "midpoint") + row(-0.146, -0.69, 0.206, "home"))
        speeds = [float(v) for v in re.findall(r"movel\(.*v=([0-9.]+)", text)]
        self.assertEqual(len(speeds), 4)
        self.assertGreater(min(speeds), 0.05)
        robot = self.run_script(text)
        self.assertLess(max(move.duration for move in robot.moves), 2.0)

    @unittest.skipUnless(REAL.exists(), f"no {REAL}")
    def test_runs_a_whole_program_of_the_demonstrator(self):
        program = REAL.read_text()
        robot = self.run_script(self.export(program, "--unchecked"))  # an exact robot presses harder than it may
        rows = self.rows(program)
        last = [float(x) for x in rows[-1][:3]]
        self.assertLess(math.dist(robot.pose[1], last), PRECISE)
        heavy = [move for move in robot.moves if move.payload[0] > GRIPPER + 0.1]
        self.assertEqual(heavy, [move for move in robot.moves if move.vacuum])

    def test_another_arm_is_refused_with_what_it_can_have_instead(self):
        text = CELL.read_text()
        for name, old, new in (("joints", "elbow_joint", "joint_a3"),
                               ("axes", 'rpy="-1.5707963267948966 0 0"/><parent link="wrist_2_link"',
                                'rpy="-1.2 0 0"/><parent link="wrist_2_link"')):
            with self.subTest(name=name):
                urdf = URDF.read_text()
                self.assertIn(old, urdf)
                (self.folder / "other.urdf").write_text(urdf.replace(old, new))
                cell = self.folder / "cell.yaml"
                cell.write_text(text.replace("urdf: robots/ur10.urdf", "urdf: other.urdf"))
                program = self.folder / "near.csv"
                program.write_text(row(-0.12, -0.69, 0.206, "home"))
                out = self.folder / "x.script"
                result = snug("export", program, "--scenario", cell, "--format", "urscript", "-o", out)
                self.assertEqual(result.returncode, 2, result.stderr)
                self.assertIn("ros-trajectory", result.stderr)
                self.assertFalse(out.exists())


def robot_com(robot):
    """z of the gripper's centre of mass in tool0."""
    return next(move.payload[1][2] for move in robot.moves if not move.vacuum)


def documents(text):
    """Points and outputs of a trajectory file, by its own two forms of lines."""
    times = [int(s) + 1e-9 * int(n) for s, n in re.findall(r"^    time_from_start: \{sec: (\d+), nanosec: (\d+)\}", text, re.M)]
    lists = {key: [[float(x) for x in found.split(",")] for found in re.findall(rf"{key}: \[(.*)\]", text)]
             for key in ("positions", "velocities", "accelerations")}
    outputs = [(int(s) + 1e-9 * int(n), vacuum == "true", blow == "true", int(line)) for s, n, vacuum, blow, line in re.findall(
        r"^  - \{time_from_start: \{sec: (\d+), nanosec: (\d+)\}, vacuum: (\w+), blow_off: (\w+), row: (\d+)", text, re.M)]
    return times, lists, outputs


class FastUrScript(unittest.TestCase):
    """Of a program that was packed fast: two boxes, the second is picked from its side."""
    ORDERS = ("order,article,length_mm,width_mm,height_mm,mass_kg,count,upright_only,no_stack,max_load_kg\n"
              "two,cup,120,110,105,0.5,1,0,0,\ntwo,tray,180,150,60,0.6,1,0,0,\n")
    MASSES = (0.5, 0.6)  # kg
    SETTLING = 0.12  # s, in which the script gives the robot time to arrive where it is to stand
    TOOL = 1e-4  # m, that interpolation may put the tool beside the simulated path

    def setUp(self):
        UrScript.setUp(self)
        self.orders, self.program = self.folder / "orders.csv", self.folder / "program.csv"
        self.orders.write_text(self.ORDERS)
        packed = snug("pack", CELL, "--items", self.orders, "--sequence", "two", "--samples", 0, "--decision-time", 0.02,
                      "--plant-seed", 0, "--program", self.program)
        self.assertEqual(packed.returncode, 0, packed.stderr)

    def export(self, form="urscript", *more):
        out = self.folder / "out"
        result = snug("export", self.program, "--scenario", CELL, "--items", self.orders, "--sequence", "two", "--format",
                      form, "-o", out, *more)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.stderr = result.stderr
        return out.read_text()

    run_script = UrScript.run_script

    def stretches(self, robot):
        """The targets from stop to stop, without those that repeat where the arm stands."""
        begins = [0] + robot.stops[:-1]
        standing = round(self.SETTLING / robot.step)
        return [robot.targets[begin:end - standing] for begin, end in zip(begins, robot.stops)]

    def test_moves_the_tool_as_the_trajectory_does_at_equal_times(self):
        robot = self.run_script(self.export())  # raises ScriptError for what an arm cannot do
        times, lists, outputs = documents(self.export("ros-trajectory", "--period", 0.008))
        self.assertEqual([round(time / 0.008) for time in times], list(range(len(times))), "a point for each tick")
        # All is half a tick later than what is simulated: in the middle between two points of a quintic.
        points = list(zip(*lists.values()))
        at_tick = [[(q + p) / 2 + 5 / 32 * 0.008 * (v - u) + 0.008**2 / 64 * (a + b) for q, v, a, p, u, b in zip(*before, *after)]
                   for before, after in zip(points, points[1:])]
        vacuum = [now for before, now in zip(outputs, outputs[1:]) if before[1] != now[1]]
        ends = [round((time - 0.004) / 0.008) for time, *_ in vacuum] + [len(at_tick) - 1]
        stretches = self.stretches(robot)
        self.assertEqual(len(stretches), len(ends), "it stops where the vacuum changes, and at the end")
        compared = 0
        for targets, end in zip(stretches, ends):
            for before_end, target in enumerate(reversed(targets)):
                expected = at_tick[end - before_end]
                self.assertLess(math.dist(robot.pose_at(target.q)[1], robot.pose_at(expected)[1]), self.TOOL)
                compared += 1
        waited = len(at_tick) - compared
        self.assertLess(waited * 0.008, 0.5 * len(vacuum) + 0.1)  # the scenario's longest wait at each change

    def test_keeps_its_time_with_any_step_of_the_controller(self):
        text = self.export()
        stated = float(re.search(r"Here: ([0-9.]+) s", text).group(1))
        for step in (0.008, 0.002, 0.003):  # CB3, e-Series, and one of which knots are no multiples
            robot = self.run_script(text, step=step)
            self.assertAlmostEqual(len(robot.targets) * step, stated, delta=0.06 + step * len(robot.stops))

    def test_sets_the_payload_of_gripper_and_box_while_it_is_held(self):
        robot = self.run_script(self.export())
        held = [target.payload[0] for target in robot.targets if target.vacuum]
        free = [target.payload[0] for target in robot.targets if not target.vacuum]
        self.assertEqual({round(mass - GRIPPER, 3) for mass in held}, set(self.MASSES))
        self.assertEqual({round(mass, 3) for mass in free}, {GRIPPER})

    def test_waits_as_long_as_the_vacuum_takes(self):
        text = self.export()
        fast, slow = self.run_script(text, evacuation=0.1), self.run_script(text, evacuation=1.1)
        self.assertAlmostEqual(slow.time - fast.time, 4.0, delta=0.05)  # two come, two go

    def test_halts_before_the_box_is_lifted_when_no_vacuum_comes(self):
        robot = Robot(URDF, seals=False)
        with self.assertRaises(Halted) as halted:
            robot.run(self.export("urscript", "--vacuum-timeout", 1.5))
        self.assertIn("PostPick(ITEM000001)", str(halted.exception))
        self.assertAlmostEqual(robot.time - robot.switched[0], 1.5, delta=0.05)
        self.assertEqual(len(robot.stops), 1)

    def test_halts_before_outputs_switch_where_the_arm_did_not_arrive(self):
        text = self.export()
        free = self.run_script(text)
        for settings in ({"stalls_at": 0.3}, {"offset": (0, 0, 0, 0.021, 0, 0)}, {"offset": (0, -0.021, 0, 0, 0, 0)}):
            robot = Robot(URDF, **settings)
            with self.assertRaises(Halted):
                robot.run(text)
            self.assertTrue(any("the arm did not arrive" in message for message in robot.messages), robot.messages)
            self.assertEqual((len(robot.stops), robot.outputs.get(0)), (1, False))
        # What an arm that holds its targets is off by: nothing is said.
        robot = self.run_script(text, offset=(0.019, -0.019, 0.019, -0.019, 0.019, -0.019))
        self.assertEqual((len(robot.stops), robot.messages), (len(free.stops), []))

    def test_halts_at_the_next_stop_when_the_arm_stalls_with_a_box(self):
        text = self.export()
        free = self.run_script(text)
        lifted = next(target.time for target in free.targets if target.vacuum) + 0.5
        robot = Robot(URDF, stalls_at=lifted)
        with self.assertRaises(Halted):
            robot.run(text)
        self.assertTrue(robot.outputs[0], "the box is not let go where the arm stalled")
        self.assertEqual(len(robot.stops), 2)

    def test_begins_with_the_second_box_at_rest_above_it(self):
        whole, robot = self.run_script(self.export()), self.run_script(self.export("urscript", "--from-box", "ITEM000002"))
        held = {round(target.payload[0] - GRIPPER, 3) for target in robot.targets if target.vacuum}
        self.assertEqual(held, {self.MASSES[1]})
        self.assertLess(len(robot.targets), 0.8 * len(whole.targets))
        self.assertEqual(robot.targets[-1].q, whole.targets[-1].q)
        self.assertEqual(len(whole.stops) - len(robot.stops), 2)
        result = snug("export", self.program, "--scenario", CELL, "--items", self.orders, "--sequence", "two", "--format", "urscript",
                      "-o", self.folder / "x", "--from-box", "ITEM000003")
        self.assertEqual(result.returncode, 2)
        self.assertIn("ITEM000001, ITEM000002", result.stderr)

    def test_ends_at_rest_with_everything_off(self):
        robot = self.run_script(self.export())
        self.assertEqual((robot.qd, robot.stops[-1]), ([0.0] * 6, len(robot.targets)))
        self.assertFalse(any(robot.outputs.values()))
        # Where contact has ended a row does not matter at the last one.
        last = [float(x) for x in self.program.read_text().splitlines()[-1].split(",")[:3]]
        self.assertLess(math.dist(robot.pose[1], last), 1e-3)

    def test_says_how_large_it_is(self):
        text = self.export()
        knots = text.count("\n  snug_follow(")
        self.assertIn(f"{knots} knots, {len(text) / 1e3:.0f} kB", self.stderr)
        self.assertLess(knots, 300)

    def test_targets_that_a_robot_cannot_reach_are_noticed(self):
        lines = self.export().splitlines(keepends=True)
        follow = [i for i, line in enumerate(lines) if line.startswith("  snug_follow(")]
        with self.assertRaises(ScriptError):  # a knot is not there: too fast from the one before to the one behind
            self.run_script("".join(lines[:follow[3]] + lines[follow[7]:]))
        rest = next(i for i, line in enumerate(lines) if line.startswith("  snug_rest("))
        with self.assertRaises(ScriptError):  # the arm waits without being told to stand
            self.run_script("".join(lines[:rest] + lines[rest + 1:]))

    def test_unchecked_is_what_the_joints_do_without_contact(self):
        robot = self.run_script(self.export("urscript", "--unchecked"))
        self.assertEqual(len(robot.stops), 5)


class RosTrajectory(unittest.TestCase):
    setUp = UrScript.setUp

    def export(self, program):
        path, out = self.folder / "program.csv", self.folder / "program.yaml"
        path.write_text(program)
        result = snug("export", path, "--scenario", CELL, "--sequence", "1", "--format", "ros-trajectory", "-o", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        return out.read_text()

    def test_ends_at_rest_where_cubics_between_its_points_come_to_rest_too(self):
        times, lists, _ = documents(self.export(PROGRAM))
        self.assertEqual(lists["velocities"][-1], [0.0] * 6)
        self.assertEqual(lists["accelerations"][-1], [0.0] * 6)
        # What a joint trajectory controller makes of positions and velocities: no speed in between is far from theirs.
        for k in range(len(times) - 1):
            dt = times[k + 1] - times[k]
            for a, b, va, vb in zip(lists["positions"][k], lists["positions"][k + 1], lists["velocities"][k],
                                    lists["velocities"][k + 1]):
                middle = 1.5 * (b - a) / dt - 0.25 * (va + vb)
                self.assertLess(abs(middle - 0.5 * (va + vb)), 0.1)  # rad/s; 15 rad/s^2 over half of 0.04 s is 0.3

    def test_outputs_switch_while_the_arm_hardly_moves(self):
        times, lists, outputs = documents(self.export(PROGRAM))
        self.assertEqual([(on, blow, line) for _, on, blow, line in outputs],
                         [(False, False, 1), (True, False, 3), (False, True, 12), (False, False, 13)])
        for at, _, _, line in outputs[1:3]:
            k = min(range(len(times)), key=lambda i: abs(times[i] - at))
            self.assertLess(max(map(abs, lists["velocities"][k])), 0.15, line)
            last = next(i for i in range(len(times)) if times[i] >= at + 0.45)
            self.assertLess(max(map(abs, lists["velocities"][last])), 0.02, "the arm stands while the vacuum changes")


if __name__ == "__main__":
    unittest.main()
