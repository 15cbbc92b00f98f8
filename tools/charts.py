#!/usr/bin/env python3
"""charts.py: draws the charts of the documents from the tables beside them, and curves that it computes, into docs/img.

  charts.py [--check] [NAME ...]     all of them; --check writes nothing and exits with 1 where a picture is another one

A chart has the numbers of one table of one section and nothing else, so it is drawn anew when `make figures` changed the table.
Needs Debian's python3-numpy for the curves.
"""
import argparse
import csv
import random
import re
import sys
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
INK, GREY, BLUE, RED, GREEN, SAND = "#22303c", "#8a97a3", "#2468b0", "#c0392b", "#2e7d4f", "#b9770e"
FILLS = {BLUE: "#9fc1e6", RED: "#eab0a8", GREEN: "#a8d3b6", SAND: "#ecd29c", GREY: "#ccd4da", INK: "#7c8a96"}
WIDTH = 860


class Drawing:
    """An SVG of the documents' look: 860 wide, on white, so that it can be read on dark pages too."""

    def __init__(self, height, title):
        self.height, self.title, self.behind, self.lines = height, title, [], []
        self.text(30, 28, title, bold=True, size=13)

    def add(self, tag, words=None, behind=False, **attributes):
        """An element; `behind`: under all others. Of names of attributes `_` stands for `-`."""
        written = " ".join(f'{name.replace("_", "-")}="{format(value, "g") if isinstance(value, float) else value}"' for name, value in attributes.items())
        element = f"<{tag} {written}/>" if words is None else f"<{tag} {written}>{escape(words)}</{tag}>"
        (self.behind if behind else self.lines).append(element)

    def text(self, x, y, words, anchor="start", color=INK, size=12, bold=False):
        self.add("text", words, x=float(x), y=float(y), text_anchor=anchor, fill=color, font_size=size, **({"font_weight": "bold"} if bold else {}))

    def line(self, x1, y1, x2, y2, color=INK, width=1.5):
        self.add("line", x1=float(x1), y1=float(y1), x2=float(x2), y2=float(y2), stroke=color, stroke_width=width)

    def curve(self, points, color, width=2.0):
        self.add("polyline", points=" ".join(f"{x:.1f},{y:.1f}" for x, y in points), fill="none", stroke=color, stroke_width=width)

    def axes(self, x, y, width, height, along, up):
        self.line(x, y, x + width, y)
        self.line(x, y, x, y - height)
        self.text(x + width, y + 18, along, "end")
        self.text(x + 6, y - height + 4, up)

    def bar(self, x, y, width, height, color):
        self.add("rect", x=float(x), y=float(y), width=float(width), height=float(height), fill=FILLS[color], stroke=color)

    def dot(self, x, y, color, radius=4.0):
        self.add("circle", cx=float(x), cy=float(y), r=radius, fill=color)

    def legend(self, x, y, entries):
        for words, color in entries:
            self.bar(x, y - 10, 12, 12, color)
            self.text(x + 18, y, words)
            x += 40 + 6.6 * len(words)

    def svg(self):
        size = f'viewBox="0 0 {WIDTH} {self.height}" width="{WIDTH}" height="{self.height}"'
        return "\n".join([f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" font-size="13" role="img">', f"<title>{escape(self.title)}</title>",
                          f'<rect width="{WIDTH}" height="{self.height}" rx="6" fill="#ffffff"/>', *self.behind, *self.lines, "</svg>", ""])


# ---- tables

def tables(page, heading):
    """The tables of one section: lists of rows, a row a list of cells, without the row of dashes."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    start = re.search(rf"^#+ {re.escape(heading)}$", text, re.M)
    if not start:
        raise SystemExit(f"charts.py: docs/{page} has no section '{heading}'")
    rest = text[start.end():]
    end = re.search(r"^#+ ", rest, re.M)
    found, row_before = [], False
    for line in rest[:end.start() if end else None].splitlines():
        is_row = line.startswith("|")
        if is_row:
            cells = [re.sub(r"\[([^\]]*)\]\([^)]*\)|[`*]", r"\1", cell).strip() for cell in line.strip().strip("|").split("|")]
            if not row_before:
                found.append([])
            if not all(re.fullmatch(r":?-+:?", cell) for cell in cells):
                found[-1].append(cells)
        row_before = is_row
    return found


def numbers(cell):
    return [float(number) for number in re.findall(r"-?\d+(?:\.\d+)?", cell)]


# ---- forms of charts

def axis(drawing, scale, ticks, top, bottom, unit):
    for tick in ticks:
        drawing.line(scale(tick), top, scale(tick), bottom, "#e3e8ec", 1)
        drawing.text(scale(tick), bottom + 16, f"{tick:g}", "middle", GREY)
    drawing.text(scale(ticks[-1]) + 26, bottom + 16, unit, "start", GREY)


def ranges(title, rows, ticks, unit, legend=(), left=250):
    """rows: (label, [(lowest or None, mean, highest or None, colour)])."""
    step = 15 if any(len(marks) > 1 for _, marks in rows) else 0
    height_of = [24 + step * (len(marks) - 1) for _, marks in rows]
    top, bottom = 44, 44 + sum(height_of)
    drawing = Drawing(bottom + (54 if legend else 30), title)

    def scale(value):
        return left + (value - ticks[0]) / (ticks[-1] - ticks[0]) * (800 - left)
    axis(drawing, scale, ticks, top, bottom, unit)
    y = top
    for index, ((label, marks), height) in enumerate(zip(rows, height_of)):
        if step and index % 2 == 0:
            drawing.add("rect", behind=True, x=20, y=y, width=820, height=height, fill="#f4f6f8")
        drawing.text(left - 12, y + height / 2 + 4, label, "end")
        for order, (low, mean, high, color) in enumerate(marks):
            at = y + 12 + step * order
            ends = [scale(value) for value in (low, high) if value is not None]
            if ends:
                drawing.line(min([*ends, scale(mean)]), at, max([*ends, scale(mean)]), at, color, 2)
            drawing.dot(scale(mean), at, color)
        y += height
    if legend:
        drawing.legend(left, bottom + 38, legend)
    return drawing.svg()


def stacks(title, rows, parts, ticks, unit, left=190):
    """rows: (label, numbers of the parts); parts: (name, colour)."""
    top, bottom = 44, 44 + 34 * len(rows)
    drawing = Drawing(bottom + 56, title)

    def scale(value):
        return left + (value - ticks[0]) / (ticks[-1] - ticks[0]) * (800 - left)
    axis(drawing, scale, ticks, top, bottom, unit)
    for index, (label, values) in enumerate(rows):
        y, sum_before = top + 34 * index + 7, 0.0
        drawing.text(left - 12, y + 15, label, "end")
        for value, (_, color) in zip(values, parts):
            drawing.bar(scale(sum_before), y, scale(sum_before + value) - scale(sum_before), 20, color)
            sum_before += value
        drawing.text(scale(sum_before) + 8, y + 15, f"{sum_before:.1f}")
    drawing.legend(left, bottom + 40, parts)
    return drawing.svg()


# ---- the charts

PARTS = [("travel", BLUE), ("carry", GREEN), ("regrasp", SAND), ("insert", RED), ("push", INK), ("wait", GREY)]
RESULTS = "packing-results.md"


def sequences():
    """Each sequence: snug in the plants, and the report's robot and people."""
    table = tables(RESULTS, "The five sequences")[0]
    rows = {row[0]: [float(cell) for cell in row[1:]] for row in table[1:]}
    plants = [values for label, values in rows.items() if re.fullmatch(r"plant \d+", label)]
    kinds = [("mean of the plants", BLUE), ("stopped at the first box that does not fit, mean", GREEN), ("the report's robot, programmed by hand", SAND), ("the report's people, by hand", GREY)]
    title = "Sequences: mean and range of the plants, and the report's robot and people"
    found = []
    for index, name in enumerate(table[0][1:]):
        marks = [(None, rows[label][index], None, color) for label, color in kinds]
        if name != "mean":
            of_plants = [values[index] for values in plants]
            marks[0] = (min(of_plants), rows[kinds[0][0]][index], max(of_plants), BLUE)
        found.append((name, marks))
    return ranges(title, found, [60, 65, 70, 75, 80, 85, 90], "%", [("snug", BLUE), ("snug, stopped at the first misfit", GREEN), ("robot, by hand", SAND), ("people", GREY)], left=90)


def cycle():
    """What the seconds of a box are made of, and how long the three ways of picking take."""
    rows = {row[0]: row[1] for row in tables(RESULTS, "An earlier policy")[0][1:]}
    kinds = ["a box that is not turned", "picked by its side", "regrasped"]
    found = []
    for label in kinds:
        mean, low, high = numbers(rows[label])
        found.append((label, [(low, mean, high, BLUE)]))
    return ranges("Seconds from box to box: mean, shortest and longest", found, [0, 5, 10, 15, 20], "s")


def plants():
    """Plants that the planner does not expect: means and lowest, without and with the lag."""
    table = tables(RESULTS, "Plants beyond the ranges")[0]
    found = []
    for row in table[1:]:
        marks = []
        for cell, color in ((row[1], BLUE), (row[4], SAND)):
            if values := numbers(cell) if cell != "-" else []:
                marks.append((values[1], values[0], None, color))
        found.append((row[0].split(" (")[0], marks))
    return ranges("Filling of plants that the planner does not expect: mean, and down to the lowest", found, [40, 50, 60, 70, 80, 90], "%", [("fast motions", BLUE), ("with the lag", SAND)])


def faults():
    table = tables(RESULTS, "Faults")[0]
    found = [(row[0], [(values[1], values[0], None, GREY if row[0].startswith("none") else RED)]) for row in table[1:] if (values := numbers(row[1]))]
    return ranges("Filling with two faults a session: mean, and down to the lowest", found, [60, 65, 70, 75, 80], "%", [("without faults", GREY), ("with faults", RED)])


def tempo():
    table = tables(RESULTS, "Against the tempo")[0]
    first = table[0].index("travel, s a box")
    rows = [("fraction {}, tempo {}".format(*row[0].split(", ")), [float(cell) for cell in row[first:first + len(PARTS)]]) for row in table[1:]]
    return stacks("Seconds a box, by what the robot does", rows, PARTS, [0, 5, 10, 15, 20], "s")


def camera():
    table = tables(RESULTS, "With a camera")
    found = []
    for color, rows in ((BLUE, table[0][1:]), (SAND, table[1][1:])):
        for row in rows:
            mean, low, high = numbers(row[1])
            found.append((row[0].replace("camera, stations that err by", "stations err by").replace("camera, stations without", "stations without").replace(", 14 sessions, insertions at 0.9 m/s", ""), [(low, mean, high, color)]))
    return ranges("Filling by what is seen: mean, lowest and highest session", found, [60, 65, 70, 75, 80, 85], "%", [("fast motions", BLUE), ("earlier, with the lag", SAND)], left=330)


def objects():
    """The container from above, with the middle of each foreign object."""
    table = tables(RESULTS, "With foreign objects")[0]
    title = "Where the foreign objects stood in the container, from above, and what was filled"
    scale, left, top = 0.75, 60, 50
    across, along = 370.0, 570.0  # mm, the container's inner size; x is drawn upward
    drawing = Drawing(int(top + across * scale + 40), title)
    drawing.add("rect", x=left, y=top, width=along * scale, height=across * scale, fill="#f7f9fb", stroke=INK, stroke_width=2)
    labels = []
    for index, (label, place, percent) in enumerate(zip(table[0][1:], table[1][1:], table[2][1:])):
        x, y = numbers(place)
        sequence, plant = label.split(", ")
        color = BLUE if sequence == "2" else SAND
        u, v = left + (along / 2 + y) * scale, top + (across / 2 - x) * scale
        drawing.add("circle", cx=u, cy=v, r=35.0 * scale, fill=FILLS[color], fill_opacity=0.6, stroke=color)
        labels.append((u, v + 4, str(index + 1)))
        drawing.text(520, top + 22 + 24 * index, f"{index + 1}")
        drawing.text(548, top + 22 + 24 * index, f"sequence {sequence}, plant {plant}: {percent} % filled")
    for x, y, words in labels:
        drawing.text(x, y, words, "middle", bold=True)
    drawing.legend(548, top + 22 + 24 * len(table[0][1:]) + 10, [("sequence 2", BLUE), ("sequence 5", SAND)])
    drawing.text(left, top + across * scale + 22, "570 x 370 mm; x upward, y to the right, from the middle; circles: 70 mm, an object's shorter edge", color=GREY)
    return drawing.svg()


def accuracy():
    """What the identification of the cup reaches, as a fraction of its target."""
    found = []
    for row in tables("theory/identification.md", "8. Accuracy")[0][1:]:
        measured, target = numbers(row[1]), numbers(row[2])
        if "%" in row[1] and len(measured) == len(target) and "to" not in row[2]:
            before, _, names = row[0].partition(": ")
            if before == "errors in variables":
                names = "worst stiffness, coupling"
            for name, reached, aim in zip(names.split(" (")[0].split(", "), measured, target):
                found.append((f"{before}: {name}", [(0.0, reached / aim, None, BLUE)]))
    return ranges("Error measured, as a fraction of its target", found, [0, 0.25, 0.5, 0.75, 1], "", left=330)


def tosses():
    """Errors of the tosses: position in mm and rotation in degrees."""
    found = []
    for row in tables("theory/scene-identification.md", "3. The cube tosses")[0][1:]:
        found.append((row[0].removesuffix(" that noise of the start sets"), [(None, numbers(row[1])[0], None, BLUE), (None, numbers(row[2])[0], None, SAND)]))
    return ranges("Mean error of a toss", found, [0, 2, 4, 6, 8, 10, 12, 14], "", [("position, mm", BLUE), ("rotation, degrees", SAND)], left=150)


# ---- curves

def flight():
    """The first toss of the example: its free flight, and the parabola that the task's gravity makes of it."""
    task = (ROOT / "scenarios" / "tosses" / "task.yaml").read_text(encoding="utf-8")
    gravity = 9.81 * float(re.search(r'"gravity\[2\]", form: scale, value: ([\d.]+)', task)[1])
    with open(ROOT / "scenarios" / "tosses" / "example.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(line for line in file if not line.startswith("#")) if row["toss"] == "0"]
    times, heights = ([float(row[key]) for row in rows] for key in ("t", "z"))

    def line_through(count):
        """Height and speed at the start: least squares, z + g t^2 / 2 is a line."""
        ys = [z + gravity * t * t / 2 for t, z in zip(times[:count], heights)]
        t_mean, y_mean = sum(times[:count]) / count, sum(ys) / count
        slope = sum((t - t_mean) * (y - y_mean) for t, y in zip(times, ys)) / sum((t - t_mean) ** 2 for t in times[:count])
        return y_mean - slope * t_mean, slope, max(abs(y - y_mean - slope * (t - t_mean)) for t, y in zip(times, ys))
    count = next(count for count in range(4, len(times)) if line_through(count + 1)[2] > 0.002)  # m
    height, speed, _ = line_through(count)
    drawing = Drawing(270, "Height of the tracked frame of a toss (scenarios/tosses/example.csv)")
    left, floor, wide, tall = 60, 230, 740 / times[-1], 170 / max(heights)
    drawing.axes(left, floor, 770, 185, "time", "height")
    for index, (t, z) in enumerate(zip(times, heights)):
        drawing.dot(left + t * wide, floor - z * tall, RED if index >= count else INK, 1.8)
    drawing.curve([(left + t * wide, floor - (height + speed * t - gravity * t * t / 2) * tall) for t in (1.12 * times[count - 1] * k / 40 for k in range(41))], BLUE)
    end = left + times[count - 1] * wide
    drawing.line(end, 50, end, floor, GREY, 1)
    for t in (0.1, 0.3, 0.5, 0.7):
        drawing.line(left + t * wide, floor, left + t * wide, floor + 6)
        drawing.text(left + t * wide, floor + 20, f"{t:g} s", "middle", GREY)
    drawing.text(end + 8, 62, "first touch: the flight ends", color=GREY)
    drawing.text(end + 8, 100, "parabola with the fitted gravity: gives the start", color=BLUE)
    drawing.text(end + 8, 140, "touches: simulated, not used for the start", color=RED)
    return drawing.svg()


def forms():
    """A short lift, measured, and what the rules of the report's form make of it."""
    import numpy as np  # pylint: disable=import-outside-toplevel
    sys.path.insert(0, str(ROOT / "tests"))
    import report_rules  # pylint: disable=import-outside-toplevel
    rng = random.Random(2)

    def rise(t, start):
        s = min(max((t - start) / 0.6, 0.0), 1.0)
        return 120.0 * s * s * (3 - 2 * s)
    times = np.arange(1500) * report_rules.PERIOD
    measured = np.array([rise(t, 4.5) - rise(t, 5.3) + rng.gauss(0.0, 0.5) for t in times])
    kept = report_rules.without_outliers(times, measured, report_rules.POSITION_MEDIAN)
    cleaned = report_rules.smoothed(report_rules.filled(times, kept))
    drawing = Drawing(290, "Height of a box, measured, and as each form takes it")
    drawing.axes(60, 245, 770, 200, "time", "height")
    first, last = np.searchsorted(times, (3.6, 9.8))

    def place(index, value):
        return 60 + (times[index] - times[first]) / (times[last] - times[first]) * 760, 240 - (value + 10) / 140 * 180
    for index in range(first, last, 3):
        drawing.dot(*place(index, measured[index]), INK if np.isfinite(kept[index]) else RED, 1.6)
    drawing.curve([place(index, cleaned[index]) for index in range(first, last, 2)], BLUE, 2.4)
    for second in range(4, 10):
        x = place(np.searchsorted(times, second), 0.0)[0]
        drawing.line(x, 245, x, 250)
        drawing.text(x, 264, f"{second} s", "middle", GREY)
    for x, y, words, color in ((80, 112, "clean: the measured", INK), (80, 128, "points as they are", INK), (370, 90, "points that the moving median over 3 s", RED), (370, 106, "takes for outliers (red)", RED),
                               (370, 140, "report: the gap is filled by pchip, then smoothed", BLUE), (370, 156, "(blue): the motion is lost", BLUE),
                               (60, 284, "Computed by the rules of the table, for a box that rests, is lifted by 120 mm and put down again, with noise of 0.5 mm.", GREY)):
        drawing.text(x, y, words, color=color)
    return drawing.svg()


CHARTS = {"results-sequences": sequences, "results-cycle": cycle, "results-plants": plants, "results-faults": faults, "results-tempo": tempo,
          "results-camera": camera, "results-objects": objects, "identification-accuracy": accuracy, "tosses": tosses,
          "scene-flight": flight, "validation-forms": forms}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="of " + ", ".join(CHARTS))
    parser.add_argument("--check", action="store_true", help="write nothing, exit code 1 where a picture is another one")
    words = parser.parse_args()
    if unknown := [name for name in words.names if name not in CHARTS]:
        parser.error(f"got '{unknown[0]}'; expected {', '.join(CHARTS)}")
    code = 0
    for name in words.names or CHARTS:
        path = ROOT / "docs" / "img" / f"{name}.svg"
        made = CHARTS[name]()
        if path.exists() and path.read_text(encoding="utf-8") == made:
            print(f"{name}: as it stands")
        elif words.check:
            print(f"{name}: another one; /usr/bin/python3 tools/charts.py {name}")
            code = 1
        else:
            path.write_text(made, encoding="utf-8")
            print(f"{name}: drawn")
    return code


if __name__ == "__main__":
    sys.exit(main())
