"""MuJoCo's wheel as a worker of bench_peers. --solref TIME, --solimp LOW HIGH, --impratio R and --cone as in MuJoCo."""

import argparse

import mujoco
import numpy
from protocol import PLANE, Engine, serve


def numbers(values):
    return " ".join(repr(float(value)) for value in values)


class Mujoco(Engine):
    takes_moments = True

    def __init__(self, options):
        self.options = options

    def build(self, scene):
        fixed, free = [], []
        self.geom, self.address = {}, {}
        for i, body in enumerate(scene["bodies"]):
            is_fixed = body["mass"] == 0
            friction = scene["box_container" if is_fixed else "box_box"]["friction"]
            half, kind = body["half"], "cylinder" if body["is_round"] else "box"
            size = numbers(half[1:] if body["is_round"] else half)
            shape = f'name="{i}" type="{kind}" size="{size}" friction="{friction} 0.005 0.0001"'
            place = f'pos="{numbers(body["pose"][:3])}" quat="{numbers(body["pose"][3:])}"'
            if is_fixed:
                fixed.append(f'<geom {shape} {place} priority="1"/>')
            elif body.get("moments"):
                inertial = f'<inertial pos="0 0 0" mass="{body["mass"]}" diaginertia="{numbers(body["moments"])}"/>'
                geom = f'<geom {shape} pos="{numbers(body["middle"])}"/>'
                free.append(f'<body name="{i}" {place}><freejoint/>{inertial}{geom}</body>')
            else:
                free.append(f'<body name="{i}" {place}><freejoint/><geom {shape} mass="{body["mass"]}"/></body>')
        options = self.options
        if scene["plane"] is not None:
            contact, soft = scene["box_container"], ""
            if contact["time_constant"] > 0:
                solref = numbers([contact["time_constant"], contact["damping_ratio"]])
                solimp = numbers([contact["impedance"], options.solimp[1], 0.001])
                soft = f'solref="{solref}" solimp="{solimp}"'
            fixed.append(
                f'<geom name="plane" type="plane" size="5 5 1" pos="0 0 {scene["plane"]}" priority="1" '
                f'friction="{contact["friction"]} 0.005 0.0001" {soft}/>'
            )
        self.model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><size memory="2G"/>
<option timestep="{scene["dt"]}" gravity="{numbers(scene["gravity"])}" cone="{options.cone}" impratio="{options.impratio}"/>
<default><geom solref="{options.solref} 1" solimp="{numbers(options.solimp)} 0.001"/></default>
<worldbody>{"".join(fixed)}{"".join(free)}</worldbody></mujoco>"""
        )
        self.data = mujoco.MjData(self.model)
        self.body = {}
        for i, body in enumerate(scene["bodies"]):
            self.geom[i] = self.model.geom(str(i)).id
            if body["mass"] > 0:
                self.body[i] = self.model.body(str(i)).id
                joint = self.model.body_jntadr[self.body[i]]
                self.address[i] = (self.model.jnt_qposadr[joint], self.model.jnt_dofadr[joint])
        if scene["plane"] is not None:
            self.geom[PLANE] = self.model.geom("plane").id
        self.is_pushed = False
        mujoco.mj_forward(self.model, self.data)

    def step(self):
        mujoco.mj_step(self.model, self.data)
        if self.is_pushed:
            self.data.xfrc_applied[:] = 0.0
            self.is_pushed = False

    def push(self, body, force, torque):
        self.data.xfrc_applied[self.body[body]] = force + torque
        self.is_pushed = True

    def rotation(self, body):
        matrix = numpy.empty(9)
        q = self.address[body][0]
        mujoco.mju_quat2Mat(matrix, self.data.qpos[q + 3 : q + 7])
        return matrix.reshape(3, 3)

    def set_motion(self, body, pose, velocity):
        q, v = self.address[body]
        self.data.qpos[q : q + 7] = pose
        self.data.qvel[v : v + 3] = velocity[:3]
        self.data.qvel[v + 3 : v + 6] = self.rotation(body).T @ velocity[3:]

    def motion(self, body):
        q, v = self.address[body]
        velocity = self.data.qvel[v : v + 6].copy()
        velocity[3:] = self.rotation(body) @ velocity[3:]
        return self.data.qpos[q : q + 7], velocity

    def normal_force(self, body_a, body_b):
        pair = {self.geom[body_a], self.geom.get(body_b)}
        force, total = numpy.zeros(6), 0.0
        for i in range(self.data.ncon):
            contact = self.data.contact[i]
            if {int(contact.geom1), int(contact.geom2)} == pair:
                mujoco.mj_contactForce(self.model, self.data, i, force)
                total += force[0]
        return total


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--solref", type=float, default=0.02)
parser.add_argument("--solimp", type=float, nargs=2, default=[0.9, 0.95])
parser.add_argument("--impratio", type=float, default=1.0)
parser.add_argument("--cone", default="pyramidal", choices=["pyramidal", "elliptic"])
serve(Mujoco(parser.parse_args()))
