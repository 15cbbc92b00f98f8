"""contact.py: pictures of docs/theory/contact.md, contact-solver.md and contact-surfaces.md."""
import math

from theory.drawing import BLUE, GREEN, GREY, INK, PALE_BLUE, PALE_GREEN, PALE_GREY, PALE_SAND, RED, Axes, Picture

GRAVITY = 9.81
RESIDUALS = ([1e-8, 1e-6, 1e-4, 1e-2], ["1e-8", "1e-6", "1e-4", "0.01"])


class Stack:
    """Boxes of 1 kg on each other that fall for one step of 1 ms onto a floor, with one normal row a contact: row i lies
    below box i. Only row 0 closes at first, since all boxes fall alike."""

    def __init__(self, count):
        self.W = [1.0] + [2.0] * (count - 1)  # diagonal of J M^-1 J^T; -1 beside it
        self.free = [-GRAVITY * 1e-3] + [0.0] * (count - 1)
        self.impulses = [0.0] * count

    def velocity(self, i):
        below = self.impulses[i - 1] if i > 0 else 0.0
        above = self.impulses[i + 1] if i + 1 < len(self.impulses) else 0.0
        return self.free[i] + self.W[i] * self.impulses[i] - below - above

    def update(self, i):
        return max(0.0, self.impulses[i] - self.velocity(i) / self.W[i])

    def residual(self):
        return max(W * abs(impulse - self.update(i)) for i, (W, impulse) in enumerate(zip(self.W, self.impulses)))

    def sweep(self, backward=False):
        rows = range(len(self.impulses))
        for i in reversed(rows) if backward else rows:
            self.impulses[i] = self.update(i)

    def newton_step(self, penalty):
        """All rows closed: impulses' = impulses - penalty / W velocity(impulses'), a tridiagonal system."""
        diagonal = [W + W / penalty for W in self.W]
        right = [W / penalty * impulse - free for W, impulse, free in zip(self.W, self.impulses, self.free)]
        for i in range(1, len(diagonal)):
            diagonal[i] -= 1.0 / diagonal[i - 1]
            right[i] += right[i - 1] / diagonal[i - 1]
        solution = [0.0]
        for d, r in zip(reversed(diagonal), reversed(right)):
            solution.append((r + solution[-1]) / d)
        self.impulses = [max(0.0, impulse) for impulse in reversed(solution[1:])]


def contact_convergence():
    p = Picture(300, "Residual over sweeps in stacks of boxes, and with steps of Newton's method")
    ax = Axes(p, 80, 50, 440, 190, (0, 60), (1e-8, 2e-2), "y")
    ax.ticks_x([0, 10, 20, 30, 40, 50, 60], title="sweeps, or steps of Newton's method")
    ax.ticks_y(*RESIDUALS, "residual, m/s")
    for count, color, lower in ((3, GREEN, 4), (10, BLUE, 8), (40, INK, -2)):
        stack, residuals = Stack(count), []
        for i in range(61):
            residuals.append((i, stack.residual()))
            stack.sweep(backward=i % 2 == 1)
        ax.curve(residuals, color)
        ax.label(*residuals[-1], f"{count} boxes", color, dy=lower)
    for count, label in ((10, (10.5, 2.2e-8)), (40, (30, 3e-7))):
        stack, residuals = Stack(count), []
        for i in range(6):
            stack.sweep(backward=i % 2 == 1)
        while stack.residual() > 1e-8:
            residuals.append((6 + len(residuals), stack.residual()))
            stack.newton_step(600.0)
            stack.sweep()
            stack.sweep(backward=True)
        ax.curve(residuals, RED, 1.5)
        for x, y in residuals:
            ax.dot(x, y, RED, 3)
        ax.label(*label, f"{count} boxes", RED, dx=8)
    ax.curve([(0, 1e-5), (60, 1e-5)], GREY, 1.2, "4 4")
    ax.label(60, 1e-5, "tolerance", GREY)
    p.heading(610, 40, "A stack that lands at once")
    p.lines(610, 150, ["1 kg each, one normal row a contact,", "from zero impulses, 1 ms", "lines: sweeps"])
    p.lines(610, 222, ["red dots: Newton's method after six", "sweeps, two sweeps after each step"], RED)
    return p


def solver_rest():
    p = Picture(290, "Residual of a tower of 40 cubes with a constant and a growing penalty")
    ax = Axes(p, 80, 50, 480, 180, (0, 8), (1e-9, 2e-2), "y")
    ax.ticks_x(range(9), title="steps of Newton's method")
    ax.ticks_y(*RESIDUALS, "residual, m/s")
    growing = [600.0, 18000.0, 30000.0, 30000.0]
    for penalties, color, words in (([300.0] * 8, INK, "300 / W, constant"), (growing, BLUE, "600 / W, then 30 times more a step, at most 30 000 / W")):
        stack = Stack(40)
        residuals = [(0, stack.residual())]
        for penalty in penalties:
            stack.newton_step(penalty)
            residuals.append((len(residuals), stack.residual()))
        ax.curve(residuals, color)
        for x, y in residuals:
            ax.dot(x, y, color)
        ax.label(*residuals[-1], words, color, dx=11)
    p.lines(590, 60, ["tower of 40 cubes, 1 kg each,", "one normal row a contact,", "from zero impulses, 1 ms"], GREY)
    return p


def spring_step(x, v, dt, omega):
    """The force of the spring at the middle of the step."""
    v_end = (v - dt * omega**2 * (x + dt / 4 * v)) / (1 + (dt * omega / 2) ** 2)
    return x + dt / 2 * (v + v_end), v_end


def early_step(x, v, dt, omega):
    v_end = v - dt * omega**2 * x
    return x + dt / 2 * (v + v_end), v_end


def late_step(x, v, dt, omega):
    v_end = (v - dt * omega**2 * x) / (1 + (dt * omega) ** 2)
    return x + dt * v_end, v_end


def contact_forces():
    p = Picture(310, "A spring at the middle of the step, and the speed of a kinematic body at the end of the step")
    p.heading(30, 28, "A mass on a spring, 20 steps a period")
    ax = Axes(p, 70, 60, 330, 190, (0, 5), (0, 2))
    ax.ticks_x(range(6), title="periods")
    ax.ticks_y([0, 0.5, 1, 1.5, 2], title="energy, of the start")
    omega, dt = 2 * math.pi, 1 / 20
    for rule, color, name, at in ((spring_step, BLUE, "middle of the step", (2.7, 1.09)), (early_step, RED, "start of the step", (0.73, 1.72)),
                                  (late_step, GREEN, "end of the step", (1.25, 0.2))):
        x, v, energies = 1.0, 0.0, []
        while len(energies) <= 100 and (energy := x**2 + (v / omega) ** 2) <= 2:
            energies.append((len(energies) * dt, energy))
            x, v = rule(x, v, dt, omega)
        ax.curve(energies, color)
        ax.label(*at, name, color, dx=0)
    p.text(30, 298, "the force of the spring is taken at this instant", GREY)
    p.heading(460, 28, "A body rides on a kinematic body that speeds up")
    ax = Axes(p, 500, 60, 300, 190, (0, 6), (0, 1.25))
    ax.ticks_x(range(7), title="steps")
    ax.ticks_y([0, 0.5, 1], title="speed, of the last")
    speed = [0, 0, 0.25, 0.5, 0.75, 1, 1]
    ax.curve(list(enumerate(speed)), GREY, 1.5, "5 4")
    for i in range(6):
        mean = (speed[i] + speed[i + 1]) / 2
        ax.curve([(i, mean), (i + 1, mean)], RED, 2)
        ax.dot(i + 1, mean)
    for i, v in enumerate(speed):
        ax.dot(i, v, BLUE)
    ax.label(0, 1.12, "with V_WB_end: the speed at E", BLUE, dy=0)
    ax.label(3.2, 0.25, "without: the mean of the step,", RED, dy=-4)
    ax.label(3.2, 0.25, "dt/2 late", RED, dy=12)
    p.text(460, 298, "dots: speed of the riding body at the end of each step", GREY)
    return p


def impact(dt, height, restitution):
    """Falls from rest by the law of section 3: gap and velocity at the end of the step of the impact."""
    gap, v = height, 0.0
    while True:
        free = v - GRAVITY * dt
        if gap + dt / 2 * (v + free) > 0:
            gap, v = gap + dt / 2 * (v + free), free
            continue
        theta = -gap / (dt / 2 * (v + free))
        v_impact = v + theta * (free - v)
        v_end = max(0.0, -restitution * v_impact + (1 - theta) * (free - v))
        opened = (1 - theta) * dt * (-restitution * v_impact + v_end) / 2 if restitution > 0 else gap + dt / 2 * (v + v_end)
        return max(0.0, opened), v_end


def rebound_error(dt, height):
    gap, v = impact(dt, height, 0.8)
    return abs(gap + v * v / 2 / GRAVITY - 0.8**2 * height)


def spring_error(dt):
    x, v = 1.0, 0.0
    for _ in range(round(1 / dt)):
        x, v = spring_step(x, v, dt, 2 * math.pi)
    return max(abs(x - 1), abs(v) / 2 / math.pi)


def contact_order():
    p = Picture(290, "Errors over the time step: second order in smooth motion and for a bounce, first order after a plastic impact")
    steps, heights = [4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4], [0.05 * (1 + 0.9 * k / 40) for k in range(41)]
    ax = Axes(p, 90, 50, 400, 180, (2e-4, 5e-3), (1e-8, 1e-2), "xy")
    ax.ticks_x(steps, ["4", "2", "1", "0.5", "0.25"], "time step, ms")
    ax.ticks_y(*RESIDUALS, "error, m")
    for error, color, name in ((lambda dt: max(impact(dt, h, 0)[0] for h in heights), RED, "gap after a plastic impact: first order"),
                               (spring_error, BLUE, "mass on a spring: second order"),
                               (lambda dt: max(rebound_error(dt, h) for h in heights), GREEN, "height of a rebound: second order")):
        errors = [(dt, error(dt)) for dt in steps]
        ax.curve(errors, color)
        for x, y in errors:
            ax.dot(x, y, color)
        ax.label(*errors[0], name, color, dx=26)
    ax.curve([(dt, GRAVITY * dt**2 / 8) for dt in steps], GREEN, 1, "3 3")
    p.lines(520, 190, ["boxes fall 50 to 95 mm; the largest error of 41", "spring: 1 Hz, 1 m, after one period", "rebound: e = 0.8; dashed: g dt^2 / 8"], GREY)
    return p


class Elimination:
    """Bodies of a graph in the order of minimum degree, then by the elimination tree."""

    def __init__(self, count, edges):
        left = {i: {j for edge in edges if i in edge for j in edge if j != i} for i in range(count)}
        self.rows, degree_order = {}, []  # rows: later bodies that the elimination of a body touches
        while left:
            body = min(left, key=lambda i: (len(left[i]), i))
            self.rows[body] = left.pop(body)
            degree_order.append(body)
            for i in self.rows[body]:
                left[i] = (left[i] | self.rows[body]) - {i, body}
        self.parent = {i: min(rows, key=degree_order.index) for i, rows in self.rows.items() if rows}
        self.children = {i: [j for j in degree_order if self.parent.get(j) == i] for i in range(count)}
        self.order = []
        for body in degree_order:
            if body not in self.parent:
                self.visit(body)

    def visit(self, body):
        for child in self.children[body]:
            self.visit(child)
        self.order.append(body)

    def shares_front(self, body):
        """With its only child: both fill the same rows."""
        below = self.children[body]
        return len(below) == 1 and self.rows[below[0]] - {body} == self.rows[body]

    def depth(self, body):
        return 1 + self.depth(self.parent[body]) if body in self.parent else 0

    def leaves(self, body):
        return max(1, sum(self.leaves(child) for child in self.children[body]))

    def places(self, body, left, places):
        """Horizontal places in the tree, in leaves."""
        for child in self.children[body]:
            self.places(child, left, places)
            left += self.leaves(child)
        below = [places[child] for child in self.children[body]]
        places[body] = sum(below) / len(below) if below else left + 0.5


def solver_front():
    p = Picture(320, "A wall of bricks, its sparse matrix in the order of elimination, and the elimination tree")
    bricks = [(i + 0.5 * (row % 2), row) for row, count in enumerate((4, 3, 4)) for i in range(count)]
    edges = {(i, j) for i, (x, row) in enumerate(bricks) for j, (other, above) in enumerate(bricks) if above == row + 1 and abs(x - other) < 1}
    tree = Elimination(len(bricks), edges)
    number = {body: i + 1 for i, body in enumerate(tree.order)}
    p.heading(30, 28, "A wall")
    for body, (x, row) in enumerate(bricks):
        p.rect(30 + 58 * x, 166 - 44 * row, 56, 44, PALE_SAND)
        p.text(58 + 58 * x, 193 - 44 * row, str(number[body]), anchor="middle")
    p.line([(20, 210), (275, 210)], width=2)
    p.text(30, 236, "numbers: order of elimination", GREY)
    p.heading(320, 28, "Blocks of 6 x 6, lower half")
    for i, later in enumerate(tree.order):
        for j, body in enumerate(tree.order[:i + 1]):
            touch = (body, later) in edges or (later, body) in edges
            color = INK if i == j else BLUE if touch else RED if later in tree.rows[body] else "#ffffff"
            p.rect(325 + 19 * j, 46 + 19 * i, 19, 19, color, PALE_GREY, 1)
        p.text(319, 60 + 19 * i, str(i + 1), GREY, 10, "end")
    for y, color, words in ((268, BLUE, "contacts of two bodies"), (286, RED, "filled by the elimination")):
        p.rect(325, y, 12, 12, color, "none")
        p.text(342, y + 10, words, GREY)
    p.heading(590, 28, "Elimination tree")
    places, deepest = {}, max(map(tree.depth, tree.order))
    for root in (body for body in tree.order if body not in tree.parent):
        tree.places(root, 0, places)
    at = {body: (600 + 220 * x / max(places.values()), 62 + 200 * tree.depth(body) / deepest) for body, x in places.items()}
    for body, above in tree.parent.items():
        together = tree.shares_front(above)
        p.line([at[body], at[above]], GREEN if together else GREY, 14 if together else 1.5)
    for body in tree.order:
        in_front = tree.shares_front(body) or (body in tree.parent and tree.shares_front(tree.parent[body]))
        p.circle(*at[body], 12, PALE_GREEN if in_front else PALE_BLUE, INK, 1.3)
        p.text(at[body][0], at[body][1] + 4, str(number[body]), size=11, anchor="middle")
    p.text(590, 296, "green: one front with a dense panel", GREY)
    return p


def surface_rolling():
    p = Picture(290, "Rolling resistance and torsional friction, and how rolling resistance slows a ball down")
    p.heading(30, 28, "Rolling resistance")
    p.line([(30, 210), (190, 210)], width=2)
    p.circle(105, 150, 60, PALE_BLUE, INK)
    p.circle(105, 150, 3)
    p.arrow(105, 150, 165, 150, BLUE, 2)
    p.text(170, 154, "v", BLUE, 13)
    p.arc(105, 150, 40, 130, 50, BLUE)
    p.text(105, 128, "w", BLUE, 13, "middle")
    p.line([(105, 150), (105, 210)], GREY, 1.2, "4 3")
    p.arrow(121, 210, 121, 166, RED, 2.2)
    p.text(127, 186, "N", RED, 13)
    p.line([(105, 218), (121, 218)], RED, 2)
    p.text(113, 234, "rho", RED, anchor="middle")
    p.lines(30, 258, ["moment of at most rho N:", "as if N stood rho ahead"])
    p.heading(230, 28, "Torsional friction")
    p.circle(310, 140, 62, PALE_BLUE, INK)
    p.circle(310, 140, 3)
    p.arc(310, 140, 48, 200, 340, BLUE)
    p.text(310, 176, "w_n", BLUE, anchor="middle")
    p.arc(310, 140, 30, 140, 40, RED)
    p.text(310, 128, "sigma N", RED, anchor="middle")
    p.text(230, 226, "seen along the normal", GREY)
    p.lines(230, 258, ["moment of at most sigma N", "against the spin"])
    p.heading(450, 28, "A ball of 50 mm radius, from 0.5 m/s without slip")
    ax = Axes(p, 490, 60, 240, 150, (0, 8), (0, 0.55))
    ax.ticks_x([0, 2, 4, 6, 8], title="time, s")
    ax.ticks_y([0, 0.25, 0.5], title="speed, m/s")
    for rho, color, name, at in ((0.5e-3, GREEN, "rho = 0.5 mm", 0.2), (1e-3, BLUE, "1 mm", 0.12), (2e-3, RED, "2 mm", 0.04)):
        stop = 0.5 / (5 / 7 * GRAVITY * rho / 0.05)
        ax.curve([(0, 0.5), (stop, 0), (8, 0)], color, 2.2)
        ax.label((1 - 2 * at) * stop, at, name, color, dx=8)
    ax.curve([(0, 0.5), (8, 0.5)], GREY, 2.2)
    ax.label(8, 0.5, "rho = 0", GREY)
    p.text(450, 275, "closed form: -dv/dt = 5/7 g rho / R", GREY)
    return p


PICTURES = {"contact-convergence": contact_convergence, "contact-forces": contact_forces, "contact-order": contact_order,
            "solver-front": solver_front, "solver-rest": solver_rest, "surface-rolling": surface_rolling}
