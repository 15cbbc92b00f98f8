"""Newton's wheel on the CPU, Kamino, its solver with hard contacts, as a worker of bench_peers. --tolerance, --iterations."""

import argparse

import newton
import numpy
import warp
from protocol import PLANE, Engine, serve

warp.config.quiet = True


class Newton(Engine):
    def __init__(self, options):
        self.options = options

    def build(self, scene):
        warp.set_device("cpu")
        builder = newton.ModelBuilder(up_axis=newton.Axis.Z, gravity=tuple(scene["gravity"]))
        newton.solvers.SolverKamino.register_custom_attributes(builder)
        builder.rigid_gap = 0.005
        self.body = {}
        for i, body in enumerate(scene["bodies"]):
            self.add(builder, scene, i, body)
        if scene["plane"] is not None:
            pose = [0.0, 0.0, scene["plane"] - 0.5, 1.0, 0.0, 0.0, 0.0]
            self.add(builder, scene, PLANE, {"half": [5.0, 5.0, 0.5], "mass": 0, "pose": pose, "is_round": False})
        self.model = builder.finalize(device="cpu")
        config = newton.solvers.SolverKamino.Config.from_model(self.model, dynamics_solver=self.options.solver)
        config.use_collision_detector = False
        config.padmm.max_iterations = self.options.iterations
        for kind in ("primal", "dual", "compl"):
            setattr(config.padmm, f"{kind}_tolerance", self.options.tolerance)
        config.padmm.warmstart_mode = "containers"
        self.solver = newton.solvers.SolverKamino(model=self.model, config=config)
        self.state, self.next = self.model.state(), self.model.state()
        self.control = self.model.control()
        self.pipeline = newton.CollisionPipeline(self.model)
        self.contacts = self.pipeline.contacts()
        self.dt, self.wrench = scene["dt"], None
        self.read()

    def add(self, builder, scene, i, body):
        # Newton averages the coefficients of two shapes.
        is_box = body["mass"] > 0
        settings = newton.ModelBuilder.ShapeConfig(gap=0.005)
        for name, kind in (("mu", "friction"), ("restitution", "restitution")):
            box, container = scene["box_box"][kind], scene["box_container"][kind]
            setattr(settings, name, box if is_box else max(0.0, 2.0 * container - box))
        half, pose = body["half"], transform(body["pose"])
        settings.density = 0.0
        parent, place = -1, pose
        if is_box:
            settings.density = body["mass"] / (8.0 * half[0] * half[1] * half[2])
            parent, place = builder.add_body(xform=pose), warp.transform_identity()
            self.body[i] = parent
        if body["is_round"]:
            settings.density *= 4.0 / numpy.pi
            builder.add_shape_cylinder(parent, xform=place, radius=half[0], half_height=half[2], cfg=settings)
        else:
            builder.add_shape_box(parent, xform=place, hx=half[0], hy=half[1], hz=half[2], cfg=settings)

    def read(self):
        self.q, self.qd = self.state.body_q.numpy().copy(), self.state.body_qd.numpy().copy()
        self.is_changed = False

    def step(self):
        if self.is_changed:
            self.state.body_q.assign(self.q)
            self.state.body_qd.assign(self.qd)
            newton.eval_ik(self.model, self.state, self.state.joint_q, self.state.joint_qd)
        self.state.clear_forces()
        if self.wrench is not None:
            self.state.body_f.assign(self.wrench)
            self.wrench = None
        self.pipeline.collide(self.state, self.contacts)
        self.solver.step(self.state, self.next, self.control, self.contacts, self.dt)
        self.state, self.next = self.next, self.state
        self.read()

    def push(self, body, force, torque):
        if self.wrench is None:
            self.wrench = numpy.zeros_like(self.qd)
        self.wrench[self.body[body]] = force + torque

    def set_motion(self, body, pose, velocity):
        self.q[self.body[body]] = pose[:3] + [*pose[4:], pose[3]]
        self.qd[self.body[body]] = velocity
        self.is_changed = True

    def motion(self, body):
        q = self.q[self.body[body]]
        return [*q[:3], q[6], *q[3:6]], self.qd[self.body[body]]


def transform(pose):
    return warp.transform(pose[:3], warp.quat(*pose[4:], pose[3]))


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--solver", default="padmm", choices=["padmm", "dvi", "lox"])
parser.add_argument("--iterations", type=int, default=200)
parser.add_argument("--tolerance", type=float, default=1e-6)
serve(Newton(parser.parse_args()))
