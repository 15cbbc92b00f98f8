"""motion.py: pictures of docs/theory/lspb.md and controller.md."""
import math
from dataclasses import dataclass, replace

from theory.drawing import BLUE, GREEN, GREY, INK, PALE_GREEN, PALE_GREY, RED, Axes, Picture

TICK = 0.008


@dataclass
class Profile:
    """Time law of lspb.md; lengths in m or rad."""
    length: float
    duration: float
    blend: float
    peak: float
    coast: float

    def sample(self, t):
        """Length and speed."""
        a = self.peak / self.blend
        if t <= 0 or t >= self.duration:
            return (0.0 if t <= 0 else self.length), 0.0
        if t < self.blend:
            return a * t * t / 2, a * t
        left = self.duration - t
        if left > self.blend:
            return self.length / 2 + self.coast * (t - self.duration / 2), self.coast
        return self.length - a * left * left / 2, a * left

    def with_sampled_coast(self):
        ticks = self.blend / TICK
        return replace(self, coast=self.peak * (math.ceil(ticks) - 1) / ticks)


def two_phases(length, duration):
    return Profile(length, duration, duration / 2, 2 * length / duration, 2 * length / duration)


def fastest(length, v, a):
    if length > v * v / a:
        return Profile(length, length / v + v / a, v / a, v, v)
    return two_phases(length, 2 * math.sqrt(length / a))


def lspb_path():
    p = Picture(290, "A motion from pose A to pose B: a straight line and a turn about one axis")
    (xA, yA), (xB, yB) = (110, 190), (560, 90)
    line = fastest(0.5, 0.25, 0.5)
    turn = two_phases(math.radians(80), line.duration)
    p.line([(xA, yA), (xB, yB)], GREY, 1.3, "5 4")
    for i in range(7):
        t = line.duration * i / 6
        part, angle = line.sample(t)[0] / 0.5, math.radians(10) + turn.sample(t)[0]
        x, y, c, s = xA + part * (xB - xA), yA + part * (yB - yA), 42 * math.cos(angle), 42 * math.sin(angle)
        p.arrow(x, y, x + c, y - s, RED, 2)
        p.arrow(x, y, x - s, y - c, GREEN, 2)
        p.circle(x, y, 4, BLUE)
    p.text(xA - 8, yA + 20, "A", size=13, anchor="end", bold=True)
    p.text(xB + 14, yB + 18, "B", size=13, bold=True)
    p.text(330, 200, "p_WE: along the line, sigma_o of L_o", BLUE)
    p.text(330, 218, "R_WE: about the fixed axis u, sigma_th of theta", RED)
    p.text(30, 272, "seven instants, equally far apart in time: dense where E is slow", GREY)
    p.heading(660, 28, "Axis u")
    p.circle(740, 120, 9, "#ffffff", INK)
    p.circle(740, 120, 3)
    p.arc(740, 120, 46, 10, 90, RED, 2)
    p.text(740, 156, "u, toward the reader", anchor="middle")
    p.text(740, 190, "theta, 0 to 180 degrees", RED, anchor="middle")
    p.text(740, 208, "R_WA exp(sigma_th u)", GREY, anchor="middle")
    return p


def lspb_profile():
    p = Picture(330, "Length, speed and acceleration of the slower part and of a part that is stretched to its duration")
    slower, quick = fastest(0.5, 0.25, 0.5), fastest(math.radians(25), 1.0, 2.0)
    T, t_s = slower.duration, slower.blend
    stretched = two_phases(quick.length, T)
    parts = ((slower, BLUE, None, 0.25, 0.5), (quick, RED, "4 4", 1.0, 2.0), (stretched, RED, None, 1.0, 2.0))
    for left, low, ticks, title in ((70, 0, [0, 0.5, 1], "length, of the whole"), (340, 0, [0, 0.5, 1], "speed, of v_max"),
                                    (610, -1.1, [-1, 0, 1], "acceleration, of a_max")):
        ax = Axes(p, left, 60, 190, 190, (0, T), (low, 1.1))
        ax.ticks_x([0, t_s, T - t_s, T], ["0", "t_s", "T - t_s", "T"])
        ax.ticks_y(ticks, title=title)
        for profile, color, dash, v, a in parts:
            times = [profile.duration * i / 300 for i in range(301)]
            if low < 0:
                rate, end, blend = profile.peak / profile.blend / a, profile.duration, profile.blend
                points = [(0, rate), (blend, rate), (blend, 0), (end - blend, 0), (end - blend, -rate), (end, -rate)]
            elif title.startswith("length"):
                points = [(t, profile.sample(t)[0] / profile.length) for t in times]
            else:
                points = [(t, profile.sample(t)[1] / v) for t in times]
            ax.curve(points, color, 1.5 if dash else 2.2, dash)
    p.text(70, 300, "blue: the slower part, three phases", BLUE)
    p.text(320, 300, "dashed: the other part at its fastest, two phases", RED)
    p.text(640, 300, "red: stretched to T", RED)
    p.text(70, 318, "translation of 0.5 m (0.25 m/s, 0.5 m/s^2) and turn of 25 degrees (1 rad/s, 2 rad/s^2)", GREY)
    return p


def lspb_coast():
    p = Picture(290, "Speed at the end of the blend, and the jump of the reference of the demonstrator's planner")
    exact = fastest(0.5, 0.25, 1.9)
    sampled = exact.with_sampled_coast()
    p.heading(30, 28, "Speed")
    ax = Axes(p, 80, 60, 300, 170, (110, 150), (0.20, 0.26))
    ax.ticks_x([110, 120, 130, 140, 150], title="time, ms")
    ax.ticks_y([0.20, 0.22, 0.24, 0.25], title="m/s")
    for profile, color in ((exact, GREY), (sampled, BLUE)):
        ax.curve([(i / 10, profile.sample(i / 1e4)[1]) for i in range(1100, 1501)], color, 2.2)
    for i in range(14, 19):
        ax.dot(1000 * i * TICK, sampled.sample(i * TICK)[1], BLUE, 3.5)
    ax.label(134, sampled.coast, "coasts at the last sample", BLUE, dx=0, dy=18)
    ax.label(134, 0.25, "v", GREY, dy=-6)
    p.heading(460, 28, "Sampled less exact length")
    ax = Axes(p, 520, 60, 290, 170, (0, exact.duration), (-7.5, 7.5))
    ax.ticks_x([0, 0.5, 1, 1.5, 2], title="time, s")
    ax.ticks_y([-6, -3, 0, 3, 6], title="mm")
    times = [exact.duration * i / 2000 for i in range(2001)]
    ax.curve([(t, 1000 * (sampled.sample(t)[0] - exact.sample(t)[0])) for t in times], BLUE, 2.2)
    p.text(30, 278, "0.5 m at 0.25 m/s and 1.9 m/s^2, samples every 8 ms: the end pose and the duration stay", GREY)
    return p


def follow(profile, k):
    """(time, position) of a tool that follows by equation (1) of controller.md; exactly where k is None."""
    x, v, rows = 0.0, 0.0, [(0.0, 0.0)]
    while len(rows) <= 5.0 / TICK:
        now, (r, speed) = profile.sample(rows[-1][0])[0], profile.sample(len(rows) * TICK)
        if k is None:
            a = (speed - v) / TICK + (r - x - TICK * (v + speed) / 2) / (4 * TICK**2)
        else:
            a = k * (now - x) - 2 * math.sqrt(k) * v
        x, v = x + TICK * v + TICK**2 / 2 * a, v + TICK * a
        rows.append((len(rows) * TICK, x))
    return rows


def controller_tasks():
    p = Picture(300, "Reference and tool with the critically damped spring and with exact tracking")
    profile = fastest(0.4, 0.25, 0.5)
    lagged, exact = follow(profile, 10.0), follow(profile, None)
    p.heading(30, 28, "Position")
    ax = Axes(p, 80, 60, 310, 180, (0, 5), (0, 0.42))
    ax.ticks_x(range(6), title="time, s")
    ax.ticks_y([0, 0.1, 0.2, 0.3, 0.4], title="m")
    ax.curve([(i / 100, profile.sample(i / 100)[0]) for i in range(501)], GREY, 4)
    ax.curve(exact[::5], GREEN, 1.6)
    ax.curve(lagged[::5])
    ax.label(0.1, 0.34, "reference, and", GREY, dx=0)
    ax.label(0.1, 0.305, "exact tracking", GREEN, dx=0)
    ax.label(2.6, 0.2, "spring, k = 10 / s^2", BLUE)
    p.heading(460, 28, "Reference less tool")
    ax = Axes(p, 510, 60, 230, 180, (0, 5), (0, 170))
    ax.ticks_x(range(6), title="time, s")
    ax.ticks_y([0, 50, 100, 150], title="mm")
    for rows, color in ((lagged, BLUE), (exact, GREEN)):
        ax.curve([(t, 1000 * (profile.sample(t)[0] - x)) for t, x in rows[::5]], color)
    limit = 2000 * 0.25 / math.sqrt(10.0)
    ax.curve([(0, limit), (5, limit)], GREY, 1.2, "4 4")
    ax.label(5, limit, "2 v / sqrt(k)", GREY)
    ax.label(5, 4, "exact", GREEN)
    p.text(30, 288, "0.4 m at 0.25 m/s and 0.5 m/s^2, ticks of 8 ms, no limit active", GREY)
    return p


def stopping_speed(room, a):
    """v^2 / (2 a) + v dt = room."""
    return math.sqrt((a * TICK) ** 2 + 2 * a * room) - a * TICK


def controller_limits():
    p = Picture(310, "Largest speed of a joint toward its limit, and of two links toward each other, over the distance")
    p.heading(30, 28, "A joint near its limit")
    near, safe, v_max = 0.1 * 4 * math.pi, 0.01 * 4 * math.pi, math.pi / 2
    ax = Axes(p, 80, 60, 300, 180, (0, 1.4), (0, 1.8))
    ax.ticks_x([0, safe, 0.5, 1, near], ["0", "ds", "0.5", "1", "di"], "distance d, rad")
    ax.ticks_y([0, 0.5, 1, 1.5], title="speed, rad/s")
    for speed, color in ((v_max, BLUE), (0.8, GREEN)):
        xi = speed + 0.5  # kept from when the joint came near, at d = di
        inside = [safe + (near - safe) * i / 400 for i in range(401)]
        ax.curve([(d, min(v_max, xi * (d - safe) / (near - safe))) for d in inside] + [(near, v_max), (1.4, v_max)], color, 2)
    ax.curve([(safe + room / 1000, stopping_speed(room / 1000, 12.0)) for room in range(148)], RED, 1.6, "5 4")
    ax.curve([(0, v_max), (1.4, v_max)], GREY, 1, "3 3")
    ax.label(1.4, v_max, "speed", GREY)
    ax.label(0.16, 1.25, "80 % braking", RED, dx=12)
    ax.label(0.86, 0.85, "came near at pi/2 rad/s", BLUE, dx=14)
    ax.label(0.6, 0.3, "came near at 0.8 rad/s", GREEN, dx=20)
    p.text(30, 290, "range 4 pi, half of 180 deg/s, 15 rad/s^2", GREY)
    p.heading(460, 28, "Two links near each other")
    ax = Axes(p, 510, 60, 270, 180, (0.09, 0.21), (0, 1.6))
    ax.ticks_x([0.1, 0.12, 0.14, 0.16, 0.18, 0.2], title="distance d, m")
    ax.ticks_y([0, 0.5, 1, 1.5], title="speed of approach, m/s")
    rooms = [i / 5000 for i in range(501)]
    laws = ((BLUE, lambda room: 10.0 * room / 0.1), (GREEN, lambda room: 0.5 * room / TICK), (RED, lambda room: stopping_speed(room, 4.8)))
    for color, law in laws:
        ax.curve([(0.1 + room, law(room)) for room in rooms if law(room) < 1.6], color, 1.6, "5 4")
    ax.curve([(0.1 + room, min(law(room) for _, law in laws)) for room in rooms], INK, 3)
    ax.label(0.113, 1.45, "damping 10 m/s", BLUE, dx=12, dy=-2)
    ax.label(0.122, 1.2, "half of the room in a tick", GREEN, dy=2)
    ax.label(0.17, 0.75, "80 % braking", RED, dx=-8, dy=20)
    p.text(460, 290, "safety 0.1 m, interaction 0.2 m, row of 0.4 m; black: the least of", GREY)
    p.text(460, 306, "damping, braking and half of the room in a tick", GREY)
    return p


ROWS = [((-1.0, 0.0), -1.0), ((-0.5, -math.sqrt(3) / 2), -1.25), ((0.0, 1.0), -0.3)]  # n . y >= b
WANTED = (2.2, 1.35)
WINDOW = [(-1.2, -1.2), (3.2, -1.2), (3.2, 1.9), (-1.2, 1.9)]


def slack(row, y):
    (nx, ny), b = row
    return nx * y[0] + ny * y[1] - b


def nearest_on(active):
    """To WANTED, where one or two rows hold as equations."""
    (nx, ny), b = active[0]
    if len(active) == 1:
        s = slack(active[0], WANTED)
        return WANTED[0] - s * nx, WANTED[1] - s * ny
    (mx, my), c = active[1]
    return (b * my - c * ny) / (nx * my - ny * mx), (nx * c - mx * b) / (nx * my - ny * mx)


def cut(polygon, row):
    """The part where the row holds, and the two points where its border meets the polygon."""
    kept, border = [], []
    for u, v in zip(polygon, polygon[1:] + polygon[:1]):
        a, b = slack(row, u), slack(row, v)
        if a >= 0:
            kept.append(u)
        if a * b < 0:
            border.append((u[0] + a / (a - b) * (v[0] - u[0]), u[1] + a / (a - b) * (v[1] - u[1])))
            kept.append(border[-1])
    return kept, border


def controller_qp():
    p = Picture(300, "The nearest point that fulfils all rows, found by adding rows one by one")

    def at(y):
        return 142.5 + 75 * y[0], 190 - 75 * y[1]
    p.heading(30, 28, "The programme in y = L^T x")
    region = WINDOW
    for row in ROWS:
        region = cut(region, row)[0]
    p.polygon([at(y) for y in region], PALE_GREEN, "none", 0)
    for i, (row, name_at) in enumerate(zip(ROWS, ((1.0, 1.74), (-0.75, 1.74), (3.2, -0.35)))):
        p.line([at(y) for y in cut(WINDOW, row)[1]])
        p.text(at(name_at)[0] + 6, at(name_at)[1], f"row {i + 1}")
    for radius in (0.5, 0.9, 1.4):
        ring = [(WANTED[0] + radius * math.cos(i * math.pi / 90), WANTED[1] + radius * math.sin(i * math.pi / 90)) for i in range(91, 181)]
        p.line([at(y) for y in ring if y[0] < 3.2], PALE_GREY, 1)
    path, active = [WANTED], []
    while min(slack(row, path[-1]) for row in ROWS) < -1e-9:
        active.append(min(ROWS, key=lambda row: slack(row, path[-1])))
        path.append(nearest_on(active))
    for start, end in zip(path, path[1:]):
        p.arrow(*at(start), *at(end), RED, 2)
        p.circle(*at(end), 4.5, RED)
    p.circle(*at(WANTED), 5, BLUE)
    p.text(at(WANTED)[0] + 9, at(WANTED)[1] - 8, "y0: without limits", BLUE)
    p.text(at(path[-1])[0] - 12, at(path[-1])[1] + 12, "answer", RED, anchor="end")
    p.heading(520, 28, "Steps")
    p.lines(520, 60, ["1. y0 violates rows 1 and 2, row 1 more: it is added", "2. the nearest point on row 1 violates row 2: added",
                      "3. along row 1 until row 2 holds as well", "4. all rows hold, no multiplier is negative: the end"])
    p.text(520, 200, "green: points that fulfil all rows", GREEN)
    p.text(520, 220, "circles: equally far from y0", GREY)
    p.lines(520, 250, ["no green area: the programme has no solution;", "the arm brakes every joint"], GREY)
    return p


PICTURES = {"lspb-path": lspb_path, "lspb-profile": lspb_profile, "lspb-coast": lspb_coast, "controller-tasks": controller_tasks,
            "controller-limits": controller_limits, "controller-qp": controller_qp}
