"""urscript_robot.py: runs the URScript that snug writes on a robot that moves in time, as far as that needs.

The language: functions, while, if, local, global, halt, calls. A statement or a function that is not known here is an
error, and so is a variable that is given a value without having been declared.
Semantics are those of the vendor's script manual: a waypoint whose blend overlaps that of the one before is skipped
there, which is an error here; outputs, inputs and payload are used while the robot stands, or on the way of servoj.
Of servoj, the robot is where its target is at the end of the step; a target that it could not reach is an error.
"""
import math
import re
import xml.etree.ElementTree as ElementTree

STEP = 0.008  # s, of the controller
MAX_ACCELERATION = 15.2  # rad/s^2: of the scenario, and what knots and printed digits may add
NO_WAY, NO_TURN = 5e-5, 1e-4  # m, rad: a move shorter than both has no length


class ScriptError(Exception):
    """The script does what a robot would refuse or do otherwise than meant."""


class Halted(Exception):
    """The script stopped the program."""


def translate(text):
    """The script as Python."""
    everywhere = re.findall(r"^ *global (\w+) =", text, re.M)
    lines, blocks = [], []  # of each block that is open: the names that a function declares; None: no function
    for number, line in enumerate(text.splitlines(), 1):
        code = re.sub(r'("[^"]*")|#.*', lambda match: match.group(1) or "", line).strip()
        if not code:
            continue
        code = re.sub(r"\bp\[([^\]]*)\]", r"[\1]", code)
        if code == "end":
            if not blocks:
                raise ScriptError(f"line {number}: an 'end' too many")
            blocks.pop()
            continue
        depth = len(blocks)
        names = next((names for names in reversed(blocks) if names is not None), set())
        function = re.fullmatch(r"def \w+\(([\w, ]*)\):", code)
        assignment = re.fullmatch(r"(local |global |)(\w+) = .+", code)
        if function:
            blocks.append({name.strip() for name in function.group(1).split(",")})
        elif re.fullmatch(r"(while .+|if .+):", code):
            blocks.append(None)
        elif code in ("else:",) or code.startswith("elif "):
            depth -= 1
        elif code == "halt":
            code = "_halt()"
        elif assignment:
            kind, name = assignment.group(1), assignment.group(2)
            if kind == "local ":
                names.add(name)
            elif not kind and name not in names and name not in everywhere:
                raise ScriptError(f"line {number}: not declared: {line}")
            code = code.removeprefix(kind)
        elif not re.fullmatch(r"\w+\(.*\)", code):
            raise ScriptError(f"line {number}: not known: {line}")
        lines.append("  " * depth + code)
        if function and everywhere:
            lines.append("  " * len(blocks) + "global " + ", ".join(everywhere))
    if blocks:
        raise ScriptError("an 'end' too few")
    return "\n".join(lines)


# Rotations are 3 x 3 lists of rows.
def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def turned(rotation, v):
    return [sum(rotation[i][k] * v[k] for k in range(3)) for i in range(3)]


def transposed(a):
    return [list(row) for row in zip(*a)]


def rotation_of(vector):
    angle = math.sqrt(sum(x * x for x in vector))
    if angle < 1e-12:
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    x, y, z = (value / angle for value in vector)
    s, c = math.sin(angle), math.cos(angle)
    k = [[0, -z, y], [z, 0, -x], [-y, x, 0]]
    kk = times(k, k)
    return [[(i == j) + s * k[i][j] + (1 - c) * kk[i][j] for j in range(3)] for i in range(3)]


def angle_between(a, b):
    m = times(transposed(a), b)
    sine = math.sqrt((m[2][1] - m[1][2]) ** 2 + (m[0][2] - m[2][0]) ** 2 + (m[1][0] - m[0][1]) ** 2) / 2
    return math.atan2(sine, (m[0][0] + m[1][1] + m[2][2] - 1) / 2)


def compose(a, b):
    return times(a[0], b[0]), [x + y for x, y in zip(a[1], turned(a[0], b[1]))]


def inverse(a):
    back = transposed(a[0])
    return back, [-x for x in turned(back, a[1])]


class Arm:
    """Forward kinematics of a URDF."""

    def __init__(self, path):
        self.joints, self.max_speeds = {}, []  # rad/s, base to tool: the order of the file
        for joint in ElementTree.parse(path).getroot().findall("joint"):
            origin = joint.find("origin")
            numbers = lambda key: [float(x) for x in (origin.get(key, "0 0 0") if origin is not None else "0 0 0").split()]
            roll, pitch, yaw = numbers("rpy")
            rotation = times(rotation_of([0, 0, yaw]), times(rotation_of([0, pitch, 0]), rotation_of([roll, 0, 0])))
            axis = joint.find("axis")
            self.joints[joint.find("child").get("link")] = (
                joint.find("parent").get("link"), (rotation, numbers("xyz")), joint.get("type") != "fixed",
                [float(x) for x in axis.get("xyz").split()] if axis is not None else [1.0, 0.0, 0.0])
            if joint.find("limit") is not None:
                self.max_speeds.append(float(joint.find("limit").get("velocity")))

    def pose(self, link, q):
        """Of a link in the root link; q of the moving joints on the way, base to tool."""
        chain = []
        while link in self.joints:
            chain.insert(0, self.joints[link])
            link = chain[0][0]
        at, moving = (rotation_of([0, 0, 0]), [0.0, 0.0, 0.0]), iter(q)
        for _, origin, moves, axis in chain:
            at = compose(at, origin)
            if moves:
                angle = next(moving)
                at = compose(at, (rotation_of([angle * x for x in axis]), [0.0, 0.0, 0.0]))
        return at


class Move:
    """One movel, as it was done."""

    def __init__(self, robot, goal, length, angle, duration, blend):
        self.begin, self.goal, self.length, self.angle = robot.time, goal, length, angle
        self.duration, self.blend, self.payload = duration, blend, robot.payload
        self.vacuum = robot.outputs.get(robot.vacuum_output, False)


class Target:
    """One step of servoj."""

    def __init__(self, robot, q):
        self.time, self.q, self.payload = robot.time, list(q), robot.payload  # s, at the end of the step
        self.vacuum = robot.outputs.get(robot.vacuum_output, False)


class Robot:
    """A UR that does what a script says: moves from stop to stop, targets of servoj step by step."""

    def __init__(self, urdf, seals=True, evacuation=0.3, vacuum_output=0, vacuum_input=0, step=STEP, stalls_at=math.inf,
                 offset=(0.0,) * 6, part_input=1, part_comes=0.0, lingering=0.0):
        self.part_input, self.part_comes, self.lingering, self.inertia = part_input, part_comes, lingering, None
        self.arm, self.seals, self.evacuation = Arm(urdf), seals, evacuation
        self.stalls_at, self.stalled, self.offset = stalls_at, None, offset  # s of servoj, then where; rad of each joint
        self.vacuum_output, self.vacuum_input = vacuum_output, vacuum_input
        self.time, self.tcp, self.pose, self.payload = 0.0, None, None, None
        self.outputs, self.switched, self.moves, self.messages = {}, {}, [], []
        self.top_speed = 0.0
        self.step, self.q, self.qd = step, None, [0.0] * 6
        self.targets, self.stops = [], []  # of each stop the number of targets before it

    def run(self, text):
        names = ("set_tcp", "set_payload", "set_target_payload", "get_tool_analog_in", "movej", "movel", "servoj", "stopj", "set_standard_digital_out",
                 "get_standard_digital_in", "get_actual_joint_positions", "sync", "get_steptime", "sleep", "textmsg",
                 "popup")
        scope = {name: getattr(self, name) for name in names}
        scope.update(_halt=self._halt, __builtins__={})
        code = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
        if code[-1] != "end":  # clients of a controller refuse what stands behind it
            raise ScriptError(f"the last line is no 'end': {code[-1]}")
        exec(translate(text), scope)  # pylint: disable=exec-used
        scope["snug_program"]()  # a controller runs what it was sent

    def _halt(self):
        raise Halted(self.messages[-1] if self.messages else "")

    def _stand(self, what):
        if self.moves and self.moves[-1].blend > 0.0:
            raise ScriptError(f"{what} while the robot passes {self.moves[-1].goal[1]} in a blend")

    def _rest(self, what):
        self._stand(what)
        if any(self.qd):
            raise ScriptError(f"{what} while joints move at {self.qd} rad/s, not stopped")

    def set_tcp(self, pose):
        self._stand("set_tcp")
        self.tcp = rotation_of(pose[3:]), list(pose[:3])

    def set_payload(self, mass, com):
        self._stand("set_payload")
        self.payload = mass, tuple(com)

    def set_standard_digital_out(self, number, value):
        self._stand("an output")
        if self.outputs.get(number) != value:
            self.switched[number] = self.time
        self.outputs[number] = value

    def set_target_payload(self, mass, com, inertia, transition):
        if len(inertia) != 6 or min(inertia[:3]) <= 0.0 or not 0.0 < transition < 1.0:
            raise ScriptError(f"set_target_payload({inertia}, {transition})")
        self.set_payload(mass, com)
        self.inertia = inertia

    def get_tool_analog_in(self, number):
        """The gauge: 10 V at -1e5 Pa. It falls to 0 a while after the switch does, `lingering`."""
        self._stand("an input")
        since = self.time - self.switched.get(self.vacuum_output, -1e9)
        is_empty = not self.outputs.get(self.vacuum_output, False) and since >= self.evacuation + self.lingering
        return 0.0 if is_empty or number != 0 else 6.0

    def get_standard_digital_in(self, number):
        self._stand("an input")
        if number == self.part_input:
            return self.time >= self.part_comes
        if number != self.vacuum_input:
            return False
        is_on = self.outputs.get(self.vacuum_output, False)
        has_changed = self.time - self.switched.get(self.vacuum_output, -1e9) >= self.evacuation
        return self.seals and is_on == has_changed

    def sync(self):
        self._rest("sync")
        self.time += self.step

    def get_steptime(self):
        return self.step

    def get_actual_joint_positions(self):
        """Of the arm, which has stopped in front of something from `stalls_at` on; else off its target by `offset`."""
        return list(self.stalled or (q + off for q, off in zip(self.q, self.offset)))

    def sleep(self, seconds):
        self._rest("sleep")
        self.time += seconds

    def textmsg(self, first, second=""):
        self.messages.append(f"{first}{second}")

    def popup(self, text, title="", warning=False, error=False, blocking=False):
        del text, title, warning, error, blocking

    def movej(self, q, a, v):
        self._rest("movej")
        if not (a > 0.0 and v > 0.0) or self.tcp is None or self.payload is None:
            raise ScriptError("movej before set_tcp and set_payload, or without a speed")
        self.q, self.pose = list(q), self.pose_at(q)

    def pose_at(self, q):
        """Of the TCP in the controller's base frame."""
        return compose(compose(inverse(self.arm.pose("base", q)), self.arm.pose("tool0", q)), self.tcp)

    def servoj(self, q, a, v, t, lookahead_time, gain):
        if (a, v) != (0, 0) or t != self.step or not 0.03 <= lookahead_time <= 0.2 or not 100 <= gain <= 2000:
            raise ScriptError(f"servoj({a=}, {v=}, {t=}, {lookahead_time=}, {gain=})")
        if self.q is None:
            raise ScriptError("servoj from nobody knows where")
        qd = [(new - old) / t for new, old in zip(q, self.q)]
        for joint, (speed, before, most) in enumerate(zip(qd, self.qd, self.arm.max_speeds)):
            if abs(speed) > most or abs(speed - before) > MAX_ACCELERATION * t:
                raise ScriptError(f"at {self.time} s: joint {joint} jumps from {before} to {speed} rad/s, may have {most}")
        self.q, self.qd, self.time, self.pose = list(q), qd, self.time + t, None
        if self.stalled is None and self.time >= self.stalls_at:
            self.stalled = list(q)
        self.targets.append(Target(self, q))

    def stopj(self, a):
        if max(map(abs, self.qd)) > a * self.step:
            raise ScriptError(f"at {self.time} s: stopj at {self.qd} rad/s leads away from the last target")
        self.qd, self.pose = [0.0] * 6, self.pose_at(self.q)
        self.stops.append(len(self.targets))

    def movel(self, pose, a, v, t=0.0, r=0.0):
        if any(self.qd):
            raise ScriptError("movel while joints move")
        if self.pose is None:
            raise ScriptError("movel from nobody knows where")
        goal = rotation_of(pose[3:]), list(pose[:3])
        length = math.dist(goal[1], self.pose[1])
        angle = angle_between(goal[0], self.pose[0])
        if length < NO_WAY and angle < NO_TURN:
            raise ScriptError(f"a move without a length to {pose}")
        before = self.moves[-1].blend if self.moves else 0.0
        if before + r >= length and before + r > 0.0:
            raise ScriptError(f"blends of {before} and {r} m overlap on a move of {length} m")
        duration = t if t > 0.0 else self.trapezoid(length, a, v)
        self.moves.append(Move(self, goal, length, angle, duration, r))
        self.integrate(length, a, v, duration if t > 0.0 else None)
        self.time += duration
        self.pose = goal

    @staticmethod
    def trapezoid(length, a, v):
        return length / v + v / a if length > v * v / a else 2.0 * math.sqrt(length / a)

    def integrate(self, length, a, v, duration):
        """Steps along the way from stop to stop; the goal must be met."""
        way, speed, time = 0.0, 0.0, 0.0
        step = 1e-3
        if duration is not None:  # constant acceleration to the middle and back
            a, v = 4.0 * length / duration**2, 2.0 * length / duration
        while way < length - 1e-4 and time < 1e3:
            braking = speed * speed / (2.0 * a) + speed * step
            wanted = speed - a * step if braking >= length - way else min(v, speed + a * step)
            speed = max(wanted, min(a * step, v))
            way, time = way + speed * step, time + step
            self.top_speed = max(self.top_speed, speed)
        if way < length - 1e-3:
            raise ScriptError(f"a move of {length} m ends {length - way} m short")
