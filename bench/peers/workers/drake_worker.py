"""Drake's wheel as a worker of bench_peers: multibody plant in discrete time. --contact hydroelastic | point, --modulus Pa."""

import argparse

import numpy
from protocol import PLANE, Engine, serve
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    AddContactMaterial,
    AddRigidHydroelasticProperties,
    Box,
    Cylinder,
    ProximityProperties,
)
from pydrake.math import RigidTransform
from pydrake.common.eigen_geometry import Quaternion
from pydrake.multibody.math import SpatialForce, SpatialVelocity
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    CoulombFriction,
    ExternallyAppliedSpatialForce,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder


class Drake(Engine):
    def __init__(self, options):
        self.options = options

    def build(self, scene):
        config = MultibodyPlantConfig(
            time_step=scene["dt"],
            contact_model="point" if self.options.contact == "point" else "hydroelastic_with_fallback",
            discrete_contact_approximation=self.options.approximation,
            penetration_allowance=1e-4,
        )
        builder = DiagramBuilder()
        self.plant, graph = AddMultibodyPlant(config, builder)
        self.plant.mutable_gravity_field().set_gravity_vector(scene["gravity"])
        self.geometry, self.bodies = {}, {}
        for i, body in enumerate(scene["bodies"]):
            self.add(scene, i, body)
        if scene["plane"] is not None:
            pose = [0.0, 0.0, scene["plane"] - 0.5, 1.0, 0.0, 0.0, 0.0]
            self.add(scene, PLANE, {"half": [5.0, 5.0, 0.5], "mass": 0, "pose": pose, "is_round": False})
        self.plant.Finalize()
        diagram = builder.Build()
        self.simulator = Simulator(diagram)
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        self.forces = self.plant.get_applied_spatial_force_input_port()
        self.forces.FixValue(self.context, [])
        for i, body in enumerate(scene["bodies"]):
            if body["mass"] > 0:
                self.set_motion(i, body["pose"], [0.0] * 6)
        self.steps, self.dt, self.is_pushed = 0, scene["dt"], False
        self.simulator.Initialize()

    def friction_of(self, scene, is_box):
        """Drake takes 2 a b / (a + b) of two coefficients: what gives the scene's for box-box and for box-container."""
        box, wanted = scene["box_box"]["friction"], scene["box_container"]["friction"]
        return box if is_box else wanted * box / (2.0 * box - wanted)

    def add(self, scene, i, body):
        half, is_box = numpy.array(body["half"]), body["mass"] > 0
        shape = Cylinder(half[0], 2.0 * half[2]) if body["is_round"] else Box(*(2.0 * half))
        friction = self.friction_of(scene, is_box)
        properties = ProximityProperties()
        AddContactMaterial(
            dissipation=self.options.dissipation, friction=CoulombFriction(friction, friction), properties=properties
        )
        if self.options.contact != "point":
            if is_box:
                AddCompliantHydroelasticProperties(0.01, self.options.modulus, properties)
            else:
                AddRigidHydroelasticProperties(0.5, properties)
        if is_box:
            inertia = (
                SpatialInertia.SolidCylinderWithMass(body["mass"], half[0], 2.0 * half[2], [0, 0, 1])
                if body["is_round"]
                else SpatialInertia.SolidBoxWithMass(body["mass"], *(2.0 * half))
            )
            self.bodies[i] = self.plant.AddRigidBody(f"body{i}", inertia)
            parent, pose = self.bodies[i], RigidTransform()
        else:
            parent, pose = self.plant.world_body(), transform(body["pose"])
        self.geometry[i] = self.plant.RegisterCollisionGeometry(parent, pose, shape, f"shape{i}", properties)

    def step(self):
        self.steps += 1
        self.simulator.AdvanceTo(self.steps * self.dt)
        if self.is_pushed:
            self.forces.FixValue(self.context, [])
            self.is_pushed = False

    def push(self, body, force, torque):
        applied = ExternallyAppliedSpatialForce()
        applied.body_index = self.bodies[body].index()
        applied.F_Bq_W = SpatialForce(tau=torque, f=force)
        self.forces.FixValue(self.context, [applied])
        self.is_pushed = True

    def set_motion(self, body, pose, velocity):
        self.plant.SetFreeBodyPose(self.context, self.bodies[body], transform(pose))
        self.plant.SetFreeBodySpatialVelocity(self.context, self.bodies[body], SpatialVelocity(velocity[3:], velocity[:3]))

    def motion(self, body):
        X = self.plant.EvalBodyPoseInWorld(self.context, self.bodies[body])
        V = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.bodies[body])
        return [*X.translation(), *X.rotation().ToQuaternion().wxyz()], [*V.translational(), *V.rotational()]

    def normal_force(self, body_a, body_b):
        if body_b not in self.geometry:
            return 0.0
        wanted = {self.geometry[body_a], self.geometry[body_b]}
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        total = 0.0
        for k in range(results.num_hydroelastic_contacts()):
            info = results.hydroelastic_contact_info(k)
            surface = info.contact_surface()
            if {surface.id_M(), surface.id_N()} == wanted:
                force = info.F_Ac_W().translational()
                areas = numpy.array([surface.area(f) for f in range(surface.num_faces())])
                normals = numpy.array([surface.face_normal(f) for f in range(surface.num_faces())])
                total += abs(force @ (areas @ normals) / max(numpy.linalg.norm(areas @ normals), 1e-300))
        for k in range(results.num_point_pair_contacts()):
            info = results.point_pair_contact_info(k)
            pair = info.point_pair()
            if {pair.id_A, pair.id_B} == wanted:
                total += abs(info.contact_force() @ pair.nhat_BA_W)
        return total


def transform(pose):
    q = numpy.array(pose[3:])
    return RigidTransform(Quaternion(q / numpy.linalg.norm(q)), pose[:3])


parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--contact", default="hydroelastic", choices=["hydroelastic", "point"])
parser.add_argument("--modulus", type=float, default=1e7)
parser.add_argument("--dissipation", type=float, default=1.0)
parser.add_argument("--approximation", default="lagged", choices=["sap", "lagged", "similar", "tamsi"])
serve(Drake(parser.parse_args()))
