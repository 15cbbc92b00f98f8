"""cup.py: pictures of docs/theory/cup.md. The cup is that of the defaults of src/snug/model/cup_params.hpp."""
import math
import re
from pathlib import Path

from theory.drawing import BLUE, GREEN, GREY, RED, Axes, Picture

GRAVITY = 9.81


class Plane:
    """A load under a cup that moves in a plane: S1 shifted by (x, z) and turned by theta in S2, z toward the package. The
    centre of mass hangs `arm` m below S1, 60 mm below the lip; the gripper is tilted by `tilt`, degrees."""

    def __init__(self, bend, mass, tilt, arm=0.085):
        self.stiffness, self.mass, self.arm = (2500.0, 6000.0, bend), mass, arm
        self.gravity = (GRAVITY * math.sin(math.radians(tilt)), GRAVITY * math.cos(math.radians(tilt)))

    def gradient(self, motion, fraction=1.0):
        """Of e^T K e / 8 less the fraction of m g . p, by (x, z, theta)."""
        x, z, theta = motion
        c, s = math.cos(theta), math.sin(theta)
        e = (x + c * x - s * z, z + s * x + c * z, 2 * s)
        slopes = ((1 + c, s, 0.0), (-s, 1 + c, 0.0), (-s * x - c * z, c * x - s * z, 2 * c))
        spring = [sum(k * a * b for k, a, b in zip(self.stiffness, e, slope)) / 4 for slope in slopes]
        gx, gz = (fraction * self.mass * g for g in self.gravity)
        return [spring[0] - gx, spring[1] - gz, spring[2] - self.arm * (gx * c - gz * s)]

    def hessian(self, motion, fraction=1.0):
        columns = []
        for j in range(3):
            high, low = ([m + sign * 1e-6 * (i == j) for i, m in enumerate(motion)] for sign in (1, -1))
            columns.append([(a - b) / 2e-6 for a, b in zip(self.gradient(high, fraction), self.gradient(low, fraction))])
        return [list(row) for row in zip(*columns)]

    def settle(self, motion=(0.0, 0.0, 0.0), fraction=1.0, tangent=None, steps=12):
        """Newton's method, with a constant tangent where one is given: where it ends, and the residual after each step."""
        residuals = []
        for _ in range(steps + 1):
            x, z, moment = left = self.gradient(motion, fraction)
            residuals.append(max(1e-12, math.hypot(x, z, 20 * moment)))
            motion = [m - d for m, d in zip(motion, solve(tangent or self.hessian(motion, fraction), left))]
        return motion, residuals

    def branch(self):
        """(fraction of gravity, bend in degrees) of the equilibria from rest to 90 degrees."""
        found, x, z, fraction = [(0.0, 0.0)], 0.0, 0.0, 0.0
        for theta in (math.radians(i / 2) for i in range(1, 180)):
            for _ in range(20):
                motion = (x, z, theta)
                left, rows = self.gradient(motion, fraction), self.hessian(motion, fraction)
                by_fraction = [b - a for a, b in zip(left, self.gradient(motion, fraction + 1))]
                dx, dz, part = solve([[row[0], row[1], by] for row, by in zip(rows, by_fraction)], left)
                x, z, fraction = x - dx, z - dz, fraction - part
            found.append((fraction, math.degrees(theta)))
        return found


def solve(matrix, right):
    """Three equations, by Cramer's rule."""
    def determinant(m):
        return sum(m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]) for i in range(3))

    def replaced(column):
        return [[right[i] if j == column else value for j, value in enumerate(row)] for i, row in enumerate(matrix)]
    return [determinant(replaced(j)) / determinant(matrix) for j in range(3)]


def cup_tangent():
    p = Picture(300, "The tangent of the law, and what it does for Newton's method")
    p.heading(30, 28, "Bending torque, k_bend = 5 Nm/rad, and its tangents")
    ax = Axes(p, 70, 60, 300, 180, (0, 60), (0, 3.2))
    ax.ticks_x([0, 15, 30, 45, 60], title="bend, degrees")
    ax.ticks_y([0, 1, 2, 3], title="Nm")

    def torque(angle):
        return 2.5 * math.sin(2 * math.radians(angle))
    ax.curve([(angle, torque(angle)) for angle in range(61)])
    for angle, low, high, color, dash in ((0, 0, 34, GREY, "5 4"), (20, 4, 42, RED, None), (40, 22, 58, RED, None)):
        slope = 5 * math.cos(2 * math.radians(angle))
        ax.curve([(at, torque(angle) + slope * math.radians(at - angle)) for at in (low, high)], color, 1.6, dash)
        ax.dot(angle, torque(angle), color)
    ax.label(34, 2.97, "at rest: K", GREY, dx=-72, dy=8)
    ax.label(27, 2.05, "(d)", RED, dx=-30, dy=-12)
    ax.label(48, 2.58, "(d)", RED, dy=-6)
    p.heading(470, 28, "Newton's method: 1.75 kg at 60 degrees, at once")
    ax = Axes(p, 530, 60, 220, 180, (0, 12), (1e-12, 100), "y")
    ax.ticks_x([0, 4, 8, 12], title="steps")
    ax.ticks_y([1e-12, 1e-8, 1e-4, 1], ["1e-12", "1e-8", "1e-4", "1"], "residual, N")
    plane = Plane(5.0, 1.75, 60)
    fixed = plane.settle(tangent=plane.hessian((0, 0, 0), 0))[1]
    exact = plane.settle(steps=4)[1]
    for residuals, color in ((fixed, GREY), (exact, RED)):
        ax.curve(list(enumerate(residuals)), color, 2)
        for i, residual in enumerate(residuals):
            ax.dot(i, residual, color, 3)
    ax.label(12, fixed[-1], "K of the", GREY, dy=-4)
    ax.label(12, fixed[-1], "cup at rest", GREY, dy=12)
    ax.label(4, 1e-10, "with (d)", RED, dx=4)
    p.text(470, 288, "the load hangs 60 mm below the lip; motion in one plane", GREY)
    return p


def cup_rest():
    p = Picture(300, "Bend of the cup while gravity is turned on: three cups come to rest, one branch ends at a fold")
    p.heading(30, 28, "1.75 kg at 60 degrees")
    ax = Axes(p, 70, 60, 260, 180, (0, 1), (0, 30))
    ax.ticks_x([0, 0.25, 0.5, 0.75, 1], title="fraction of gravity")
    ax.ticks_y([0, 10, 20, 30], title="bend, degrees")
    for bend, color in ((3.0, RED), (5.0, BLUE), (10.0, GREEN)):
        plane, rest = Plane(bend, 1.75, 60), [(0.0, 0.0)]
        for i in range(1, 41):
            rest.append((i / 40, math.degrees(plane.settle(fraction=i / 40)[0][2])))
        ax.curve(rest, color)
        for x, y in rest[5::5]:
            ax.dot(x, y, color, 3)
        ax.label(*rest[-1], f"{bend:g} Nm/rad: {rest[-1][1]:.1f}", color)
    p.text(30, 288, "dots: the eight parts in which gravity is turned on", GREY)
    p.heading(460, 28, "2.5 kg at 150 degrees: the cup points up")
    ax = Axes(p, 500, 60, 240, 180, (0, 1.2), (0, 90))
    ax.ticks_x([0, 0.25, 0.5, 0.75, 1], title="fraction of gravity")
    ax.ticks_y([0, 15, 30, 45, 60, 75, 90], title="bend, degrees")
    ax.curve([(1, 0), (1, 90)], GREY, 1, "2 3")
    for bend, color in ((3.0, RED), (5.0, BLUE)):
        branch = Plane(bend, 2.5, 150).branch()
        fold = branch.index(max(branch))
        ax.curve([at for at in branch[:fold + 1] if at[0] <= 1.2], color)
        ax.curve([at for at in branch[fold:] if at[0] <= 1.2], color, 1.5, "4 4")
        if bend == 3.0:
            ax.dot(*branch[fold])
            ax.label(*branch[fold], "fold", RED, dx=8)
    ax.label(0.18, 24, "3 Nm/rad", RED, dx=-8)
    ax.label(1.2, 14, "5 Nm/rad", BLUE)
    ax.label(1.2, 68, "unstable", BLUE)
    p.text(460, 288, "3 Nm/rad: the branch ends before the whole load", GREY)
    return p


def drawn_in(pressure):
    x = min(1.0, max(0.0, pressure / -12.0))
    return x * x * (3 - 2 * x)


def cup_phases():
    p = Picture(420, "Pressure, unloaded length and stiffness of a cup over the phases of a grasp")
    pressure, rows = 0.0, []
    for ms in range(1400):
        rows.append((ms / 1000, pressure))
        wanted = -60.0 if 100 <= ms < 1000 else 5.0 if ms >= 1000 else 0.0
        pressure = wanted + (pressure - wanted) * math.exp(-0.001 / (0.20 if wanted < pressure else 0.03))
    panels = ((84, 90, (-65, 10), [-60, -40, -20, 0], "gauge pressure, kPa", BLUE, lambda pressure: pressure),
              (209, 60, (45, 75), [50, 60, 72], "unloaded length l0, mm", GREEN, lambda pressure: 72 - 22 * drawn_in(pressure)),
              (314, 60, (0, 1.1), [0, 0.25, 1], "stiffness, of that under vacuum", RED, lambda pressure: 0.25 + 0.75 * drawn_in(pressure)))
    axes = []
    for top, height, limits, ticks, title, color, value in panels:
        ax = Axes(p, 90, top, 560, height, (0, 1.4), limits)
        ax.ticks_y(ticks, title=title)
        for time in (0.1, 1.0):
            ax.curve([(time, limits[0]), (time, limits[1])], GREY, 1, "4 4")
        ax.curve([(time, value(pressure)) for time, pressure in rows[::4]], color)
        axes.append(ax)
    axes[2].ticks_x([0, 0.2, 0.4, 0.6, 0.8, 1, 1.2, 1.4], title="time, s")
    for time, phase, words in ((0.0, "Free", ""), (0.1, "Holding", "vacuum on, lip seals"), (1.0, "Releasing", "vacuum off, blow-off")):
        p.text(axes[0].x(time) + 4, 26, words, GREY)
        p.text(axes[0].x(time) + 4, 44, phase, bold=True)
    established = next(time for time, pressure in rows if pressure <= -48)
    collapsed = next(time for time, pressure in rows if pressure <= -12)
    axes[0].dot(established, -48)
    axes[0].label(established, -48, "80 %: the limits of the hold count", RED, dx=8, dy=-4)
    axes[1].label(collapsed, 50, f"drawn in after {1000 * (collapsed - 0.1):.0f} ms, at -12 kPa", GREEN, dx=10, dy=-8)
    p.lines(680, 114, ["default cup:", "-60 kPa, drawn with 0.2 s,", "lost with 0.03 s"], GREY)
    return p


def measured_law():
    """The numbers of scenarios/cups/other-make.yaml below `cup`."""
    text = (Path(__file__).resolve().parents[2] / "scenarios/cups/other-make.yaml").read_text(encoding="utf-8")
    return {key: float(value) for key, value in re.findall(r"^    (\w+): ([-+.\de]+)$", text.split("\ncup:", 1)[1], re.M)}


def cup_law():
    p = Picture(290, "Axial force, lateral and bending stiffness of a measured cup over its compression")
    law = measured_law()

    def powers(name, u, degree=0):
        return sum(law.get(f"{name}_{i}", 0.0) * u**i for i in range(degree, 6))

    at = [i / 50 for i in range(-50, 51)]  # u, from most compressed to rest
    half = 1000 * law["half_range"]
    curves = [("axial force, N", (-25, 0), [-25, -20, -15, -10, -5, 0], RED, lambda u: powers("axial", u) - powers("axial", 1.0)),
              ("lateral stiffness, N/m", (0, 3000), [0, 1000, 2000, 3000], BLUE, lambda u: powers("lateral", u)),
              ("bending stiffness, Nm/rad", (0, 1.5), [0, 0.5, 1, 1.5], GREEN, lambda u: powers("bend", u))]
    for i, (title, limits, ticks, color, curve) in enumerate(curves):
        ax = Axes(p, 70 + 275 * i, 50, 200, 180, (0, 15), limits)
        ax.ticks_x([0, 5, 10, 15], title="compression, mm")
        ax.ticks_y(ticks, title=title)
        ax.curve([(half * (1 - u), curve(u)) for u in at], color)
    p.text(30, 280, "another make of cup, fitted to 1017 poses (scenarios/cups/other-make.yaml); force counted from the least compressed pose", GREY)
    return p


PICTURES = {"cup-tangent": cup_tangent, "cup-rest": cup_rest, "cup-phases": cup_phases, "cup-law": cup_law}
