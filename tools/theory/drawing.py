"""drawing.py: drawings and diagrams as SVG, in the look of docs/img."""
import math
from xml.sax.saxutils import escape

INK, BLUE, RED, GREEN, GREY = "#22303c", "#2468b0", "#c0392b", "#2e7d4f", "#8a97a3"
PALE_BLUE, PALE_SAND, PALE_GREY, PALE_GREEN = "#dfe9f4", "#f6ecd9", "#d9dde2", "#e2efe6"


def number(value):
    return f"{value:.1f}".rstrip("0").rstrip(".")


class Picture:
    """Lengths in pixels, y down."""

    def __init__(self, height, title, width=860):
        self.width, self.height, self.title = width, height, title
        self.parts, self.markers = [], []

    def add(self, text):
        self.parts.append(text)

    def text(self, x, y, words, color=INK, size=12, anchor="start", bold=False):
        weight = ' font-weight="bold"' if bold else ""
        self.add(f'<text x="{number(x)}" y="{number(y)}" text-anchor="{anchor}" fill="{color}" font-size="{size}"{weight}>{escape(words)}</text>')

    def lines(self, x, y, rows, color=INK):
        for i, words in enumerate(rows):
            self.text(x, y + 18 * i, words, color)

    def heading(self, x, y, words):
        self.text(x, y, words, size=13, bold=True)

    def line(self, points, color=INK, width=1.5, dash=None, arrow=False, both=False):
        more = f' stroke-dasharray="{dash}"' if dash else ""
        if arrow or both:
            if color not in self.markers:
                self.markers.append(color)
            name = f"url(#a{self.markers.index(color)})"
            more += f' marker-end="{name}"' + (f' marker-start="{name}"' if both else "")
        where = " ".join(f"{number(x)},{number(y)}" for x, y in points)
        self.add(f'<polyline points="{where}" fill="none" stroke="{color}" stroke-width="{width}" stroke-linejoin="round"{more}/>')

    def arrow(self, x1, y1, x2, y2, color=INK, width=1.6, dash=None, both=False):
        self.line([(x1, y1), (x2, y2)], color, width, dash, True, both)

    def polygon(self, points, fill=PALE_BLUE, stroke=INK, width=1.5):
        where = " ".join(f"{number(x)},{number(y)}" for x, y in points)
        self.add(f'<polygon points="{where}" fill="{fill}" stroke="{stroke}" stroke-width="{width}" stroke-linejoin="round"/>')

    def rect(self, x, y, w, h, fill=PALE_BLUE, stroke=INK, width=1.5, rx=0):
        self.add(f'<rect x="{number(x)}" y="{number(y)}" width="{number(w)}" height="{number(h)}" rx="{rx}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"/>')

    def circle(self, x, y, r=4, fill=INK, stroke="none", width=1.5):
        self.add(f'<circle cx="{number(x)}" cy="{number(y)}" r="{number(r)}" fill="{fill}" stroke="{stroke}" stroke-width="{width}"/>')

    def box(self, x, y, w, h, title, lines=(), fill=PALE_BLUE):
        self.rect(x, y, w, h, fill, rx=6)
        top = y + (h - 16 * len(lines)) / 2 + 5
        self.text(x + w / 2, top, title, size=13, anchor="middle", bold=True)
        for i, words in enumerate(lines):
            self.text(x + w / 2, top + 17 + 16 * i, words, anchor="middle")

    def arc(self, x, y, r, start, end, color=INK, width=1.6, arrow=True):
        """Degrees, counterclockwise from the right as one sees it."""
        steps = max(8, int(abs(end - start) / 5))
        angles = [math.radians(start + (end - start) * i / steps) for i in range(steps + 1)]
        self.line([(x + r * math.cos(a), y - r * math.sin(a)) for a in angles], color, width, arrow=arrow)

    def svg(self):
        defs = "".join(f'<marker id="a{i}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" markerHeight="7" orient="auto-start-reverse">'
                       f'<path d="M0 0 10 5 0 10z" fill="{c}"/></marker>' for i, c in enumerate(self.markers))
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {self.height}" width="{self.width}" height="{self.height}" '
                f'font-family="sans-serif" font-size="13" role="img">\n<title>{escape(self.title)}</title>\n')
        head += f"<defs>{defs}</defs>\n" if defs else ""
        head += f'<rect width="{self.width}" height="{self.height}" rx="6" fill="#ffffff"/>\n'
        return head + "\n".join(self.parts) + "\n</svg>\n"


class Axes:
    """A rectangle of a picture with numbers on its sides. `log`: of "", "x", "y", "xy"."""

    def __init__(self, picture, left, top, width, height, x_range, y_range, log=""):
        self.picture, self.left, self.top, self.width, self.height = picture, left, top, width, height
        self.log = log
        self.x_range, self.y_range = [self.scaled(v, "x") for v in x_range], [self.scaled(v, "y") for v in y_range]
        bottom = top + height
        picture.line([(left, bottom), (left + width, bottom)])
        picture.line([(left, bottom), (left, top)])

    def scaled(self, value, axis):
        return math.log10(value) if axis in self.log else value

    def x(self, value):
        low, high = self.x_range
        return self.left + self.width * (self.scaled(value, "x") - low) / (high - low)

    def y(self, value):
        low, high = self.y_range
        return self.top + self.height * (1 - (self.scaled(value, "y") - low) / (high - low))

    def at(self, x, y):
        return self.x(x), self.y(y)

    def ticks_x(self, values, names=None, title="", grid=False):
        bottom = self.top + self.height
        for value, name in zip(values, names or [f"{v:g}" for v in values]):
            self.picture.line([(self.x(value), self.top if grid else bottom), (self.x(value), bottom + 4)], PALE_GREY if grid else INK, 1)
            self.picture.text(self.x(value), bottom + 17, name, size=11, anchor="middle")
        self.picture.text(self.left + self.width, bottom + 33, title, anchor="end")

    def ticks_y(self, values, names=None, title="", grid=True):
        for value, name in zip(values, names or [f"{v:g}" for v in values]):
            self.picture.line([(self.left - 4, self.y(value)), (self.left + (self.width if grid else 0), self.y(value))], PALE_GREY if grid else INK, 1)
            self.picture.text(self.left - 8, self.y(value) + 4, name, size=11, anchor="end")
        self.picture.text(self.left - 30, self.top - 10, title)

    def curve(self, points, color=BLUE, width=2.5, dash=None):
        self.picture.line([self.at(x, y) for x, y in points], color, width, dash)

    def dot(self, x, y, color=RED, r=4, fill=None):
        self.picture.circle(*self.at(x, y), r, fill or color, color)

    def label(self, x, y, words, color=INK, dx=6, dy=4, anchor="start", size=12):
        self.picture.text(self.x(x) + dx, self.y(y) + dy, words, color, size, anchor)
