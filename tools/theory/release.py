"""release.py: pictures of docs/theory/cup-release.md. Numbers: those fitted to recordings, docs/scenario.md, release."""
import math

from theory.drawing import BLUE, GREEN, GREY, INK, RED, Axes, Picture

GROWTH, SHUT, OPEN, DAMPING = 0.02967, 7001.0, 652.2, 10.58  # m, N/m, N/m, Ns/m
START, VOLUME, DELAY, VALVE_TIME = -1.368e4, 7.667e-5, 0.007112, 0.06075  # Pa, m^3, s, s
FLOW, PEEL, VENT = 1.704e-3, 0.07539, 0.03  # m^3/s, Ns, s
AREA, EFFECTIVE_AREA, HOLD_LENGTH = 2.83e-3, math.pi / 4 * 0.06**2, 0.050  # m^2, m^2, m: of the default cup
AMBIENT, HOLD, BLOW = 101325.0, -6e4, 5e3  # Pa
TIMES = [0, 20, 40, 60, 80, 100]


def pull(pressure, length):
    """Of the bellows at rest, N; are the folds shut?"""
    shut = SHUT * (length - HOLD_LENGTH - max(0.0, (pressure - START) * AREA / SHUT))
    opened = -pressure * AREA - OPEN * (HOLD_LENGTH + GROWTH - length)
    return min(shut, opened), shut <= opened


def opened_until(time):
    moving = max(0.0, time - DELAY)
    return moving - VALVE_TIME / 2 if moving >= VALVE_TIME else moving**2 / 2 / VALVE_TIME


def release(mass, dt=5e-5):
    """Rows (ms, kPa, folds are shut, N that the lip lacks, Ns) from the switch until the lip opens; a box below an upright cup."""
    length, speed, pressure, time, impulse, rows = HOLD_LENGTH + mass * 9.81 / SHUT, 0.0, HOLD, 0.0, 0.0, []
    while True:
        force, is_shut = pull(pressure, length)
        force += DAMPING * speed
        lacks = max(0.0, force + pressure * EFFECTIVE_AREA)
        rows.append((1000 * time, pressure / 1000, is_shut, lacks, impulse))
        if impulse >= PEEL:
            return rows
        impulse += lacks * dt
        speed += dt * (9.81 - force / mass)
        before, length = AREA * length + VOLUME, length + dt * speed
        volume = AREA * length + VOLUME
        pressure = (AMBIENT + pressure) * before / volume - AMBIENT
        if time + dt > DELAY:
            pressure = max(pressure, START)
            blown = AMBIENT * FLOW * VENT / volume
            fading = math.exp(-(opened_until(time + dt) - opened_until(time)) / VENT)
            pressure = min(blown + (pressure - blown) * fading, max(pressure, BLOW))
        time += dt


def cup_release_bellows():
    p = Picture(290, "Pull of the bellows over its length at three pressures")
    ax = Axes(p, 90, 50, 420, 180, (48, 82), (-25, 60))
    ax.ticks_x([50, 55, 60, 65, 70, 75, 80], title="length L, mm")
    ax.ticks_y([-20, 0, 20, 40, 60], title="pull F, N")
    ax.curve([(48, 0), (82, 0)], INK, 1)
    for pressure, color, name in ((START, BLUE, "-13.7 kPa: p_0"), (START / 2, GREEN, "-6.8 kPa"), (0.0, RED, "0: no vacuum")):
        points = [(length / 100, *pull(pressure, length / 1e5)) for length in range(4800, 8201)]
        shown = [(length, force, is_shut) for length, force, is_shut in points if force >= -25]
        fold = next((length, force) for length, force, is_shut in shown if not is_shut)
        ax.curve([shown[0][:2], fold, shown[-1][:2]], color)
        ax.dot(*fold, color)
        ax.label(*shown[-1][:2], name, color, dx=8)
    p.lines(640, 170, ["steep: folds shut, k", "flat: open bellows, k_f", "dots: the folds open"])
    p.text(90, 280, "numbers fitted to the recordings (docs/scenario.md), no damping", GREY)
    return p


def cup_release_gas():
    p = Picture(300, "Pressure in the cup and opening of the valve over a release")
    ax = Axes(p, 90, 50, 440, 190, (0, 110), (-62, 10))
    ax.ticks_x(TIMES, title="time since the switch, ms")
    ax.ticks_y([-60, -40, -20, 0], title="gauge pressure p, kPa")
    rows = release(1.0)
    ax.curve([row[:2] for row in rows[::8]])
    ax.dot(*rows[-1][:2])
    ax.label(*rows[-1][:2], "lip opens", RED, dx=8)
    unfold = next(row[:2] for row in rows if not row[2])
    ax.dot(*unfold, GREEN)
    ax.label(*unfold, "folds open, the bellows lengthens", GREEN, dx=4, dy=26)
    ax.curve([(1000 * DELAY, -62), (1000 * DELAY, 10)], GREY, 1, "4 4")
    ax.label(1000 * DELAY, -50, "t_d: what is deeper than p_0 is let in at once", GREY, dx=8)
    ax = Axes(p, 630, 50, 200, 190, (0, 110), (0, 1.1))
    ax.ticks_x(TIMES, title="ms")
    ax.ticks_y([0, 0.5, 1], title="opening of the valve")
    ax.curve([(0, 0), (1000 * DELAY, 0), (1000 * (DELAY + VALVE_TIME), 1), (110, 1)], GREEN)
    ax.label(40, 0.5, "t_v", GREEN, dx=10, dy=12)
    p.text(90, 288, "computed: 1 kg below the cup, numbers fitted to the recordings (docs/scenario.md)", GREY)
    return p


def cup_release_lip():
    p = Picture(300, "What the contact of the lip lacks over a release of three masses, and its impulse")
    lacks = Axes(p, 90, 50, 300, 190, (60, 110), (0, 10))
    lacks.ticks_y([0, 2, 4, 6, 8, 10], title="lacks, N")
    impulse = Axes(p, 480, 50, 300, 190, (60, 110), (0, 0.09))
    impulse.ticks_y([0, 0.03, 0.06, 0.09], title="impulse of what it lacks, Ns")
    impulse.curve([(60, PEEL), (110, PEEL)], GREY, 1.2, "4 4")
    impulse.label(60, PEEL, "J: the lip opens", GREY, dx=8, dy=-6)
    for ax in (lacks, impulse):
        ax.ticks_x([60, 70, 80, 90, 100], title="time since the switch, ms")
    for mass, color, lower in ((0.5, GREEN, 12), (1.0, BLUE, 10), (2.0, RED, 2)):
        rows = [row for row in release(mass) if row[0] >= 60]
        for ax, column in ((lacks, 3), (impulse, 4)):
            ax.curve([(row[0], row[column]) for row in rows[::4] + rows[-1:]], color)
            ax.dot(rows[-1][0], rows[-1][column], color)
        lacks.label(rows[-1][0], rows[-1][3], f"{mass:g} kg", color, dy=lower)
    p.text(90, 288, "computed, a box below an upright cup: lacks = F + p A_eff while the lip holds", GREY)
    return p


def cup_release_errors():
    """The numbers of the table of section 4."""
    p = Picture(300, "Errors of the height of the box in recorded releases")
    bars = [("fitted to all masses", 0.52, BLUE), ("left out: all seven", 0.57, INK), ("left out: the lightest", 0.58, RED),
            ("left out: those between, worst", 0.75, GREEN), ("left out: those between, best", 0.40, GREEN),
            ("left out: the heaviest", 0.72, INK), ("a learned force, by the authors, fitted", 0.80, GREY)]
    ax = Axes(p, 290, 40, 440, 200, (0, 1.2), (0, len(bars)))
    ax.ticks_x([0, 0.2, 0.4, 0.6, 0.8, 1], title="rms over 139 ms, mm", grid=True)
    for i, (name, error, color) in enumerate(bars):
        y = ax.y(len(bars) - i) + 5
        p.rect(ax.x(0), y, ax.x(error) - ax.x(0), 18, color, "none", 0)
        p.text(280, y + 14, name, anchor="end")
        p.text(ax.x(error) - 8, y + 14, "0.6 to 0.8" if color == GREY else f"{error:.2f}", "#ffffff", anchor="end", bold=True)
    ax.curve([(0.8, 0), (0.8, len(bars))], RED, 1.2, "4 4")
    p.text(ax.x(0.8) + 5, 36, "aim for masses left out", RED)
    p.text(30, 288, "76 releases of seven masses; the phases of cup.md, section 6: 9.8 mm", GREY)
    return p


PICTURES = {"cup-release-bellows": cup_release_bellows, "cup-release-gas": cup_release_gas, "cup-release-lip": cup_release_lip,
            "cup-release-errors": cup_release_errors}
