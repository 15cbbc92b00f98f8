"""Rapier's wheel, in single precision, as a worker of bench_peers. --iterations N: of its solver in a step (0: its default)."""

import argparse
import math

import rapier3d as rapier
from protocol import PLANE, Engine, serve

MULTIPLY = rapier.CoefficientCombineRule.MULTIPLY


class Rapier(Engine):
    takes_moments = True

    def __init__(self, options):
        self.options = options

    def build(self, scene):
        self.world = rapier.PhysicsWorld(gravity=tuple(scene["gravity"]))
        parameters = self.world.integration_parameters
        parameters.dt = scene["dt"]
        if self.options.iterations:
            parameters.num_solver_iterations = self.options.iterations
        soft = scene["box_container"]
        if soft["stiffness"] > 0:  # N/m: the frequency at which the first body swings on it
            frequency = math.sqrt(soft["stiffness"] / scene["bodies"][0]["mass"]) / (2 * math.pi)
            spring = rapier.SpringCoefficients(frequency, 10 * soft["damping_ratio"])  # 10 is its default
            parameters.contact_softness = parameters.static_contact_softness = spring
        self.world.set_num_threads(1)
        self.dt, self.bodies, self.colliders, self.pushed = scene["dt"], {}, {}, []
        for i, body in enumerate(scene["bodies"]):
            self.add(scene, i, body)
        if scene["plane"] is not None:
            pose = [0.0, 0.0, scene["plane"] - 0.5, 1.0, 0.0, 0.0, 0.0]
            self.add(scene, PLANE, {"half": [5.0, 5.0, 0.5], "mass": 0, "pose": pose, "is_round": False})

    def add(self, scene, i, body):
        # Rapier multiplies the values of both: a box gets the root of the box-box value.
        factors = {}
        for kind in ("friction", "restitution"):
            root = math.sqrt(scene["box_box"][kind])
            factors[kind] = root if body["mass"] > 0 else scene["box_container"][kind] / root if root > 0 else 0.0
        half = body["half"]
        if body["is_round"]:  # its axis is y
            turn = rapier.Rotation3.from_scaled_axis(rapier.Vec3(math.pi / 2, 0.0, 0.0))
            shape = rapier.Collider.cylinder(half[2], half[0]).position(rapier.Isometry3(rapier.Vec3(0.0, 0.0, 0.0), turn))
        else:
            shape = rapier.Collider.cuboid(*half)
        shape = shape.friction(factors["friction"]).restitution(factors["restitution"])
        shape = shape.friction_combine_rule(MULTIPLY).restitution_combine_rule(MULTIPLY)
        if body["mass"] > 0:
            rigid = rapier.RigidBody.dynamic().can_sleep(False)
            if body.get("moments"):
                middle = body["middle"]
                shape = shape.translation(rapier.Vec3(*middle))
                com = rapier.Vec3(*[-x for x in middle])  # in the frame of the shape
                moments = rapier.Vec3(*body["moments"])
                shape = shape.mass_properties(rapier.MassProperties(com, body["mass"], moments, rapier.Rotation3.identity()))
            else:
                shape = shape.mass(body["mass"])
        else:
            rigid = rapier.RigidBody.fixed()
        handle = self.world.add_body(rigid.position(isometry(body["pose"])), colliders=[shape])
        self.bodies[i] = handle
        self.colliders[i] = self.body(i).colliders[0]

    def body(self, i):
        return self.world.rigid_bodies[self.bodies[i]]

    def step(self):
        self.world.step()
        for body in self.pushed:
            self.body(body).reset_forces()
            self.body(body).reset_torques()
        self.pushed = []

    def push(self, body, force, torque):
        self.body(body).add_force(rapier.Vec3(*force))
        self.body(body).add_torque(rapier.Vec3(*torque))
        self.pushed.append(body)

    def set_motion(self, body, pose, velocity):
        rigid = self.body(body)
        rigid.position = isometry(pose)
        rigid.linvel = rapier.Vec3(*velocity[:3])
        rigid.angvel = rapier.Vec3(*velocity[3:])

    def motion(self, body):
        rigid = self.body(body)
        place, turn = rigid.translation, rigid.rotation
        pose = [place.x, place.y, place.z, turn.w, turn.i, turn.j, turn.k]
        linear, angular = rigid.linvel, rigid.angvel
        return pose, [linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]

    def normal_force(self, body_a, body_b):
        if body_b not in self.colliders:
            return 0.0
        pair = self.world.narrow_phase.contact_pair(self.colliders[body_a], self.colliders[body_b])
        if pair is None:
            return 0.0
        return sum(point.impulse for manifold in pair.manifolds for point in manifold.points) / self.dt


def isometry(pose):
    return rapier.Isometry3(rapier.Vec3(*pose[:3]), rapier.Rotation3(*pose[3:]))


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--iterations", type=int, default=0)
serve(Rapier(parser.parse_args()))
