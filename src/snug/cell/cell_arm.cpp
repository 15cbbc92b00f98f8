// CellArm: a robot's arm in the cell: its links among the bodies, what its sensor reads, when it stops for protection.
#include "snug/cell/cell_arm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/control/pose_solver.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/geometry/manifold.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/robot/load_arm.hpp"

namespace snug::cell {
namespace {

using robot::JointVector;

const model::RobotParams& params_of(const model::Scenario& scenario) {
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "", "a robot, to run a program with its joints");
  return *scenario.robot;
}

control::JointController make_controller(const model::Scenario& scenario, double task_stiffness) {
  return {robot::load_arm(scenario),
          {scenario.controller.tick, task_stiffness, params_of(scenario), {}, scenario.source_name}};
}

JointVector start_joints(const model::Scenario& scenario, const robot::ArmModel& arm) {
  const model::RobotParams& params = params_of(scenario);
  if (!params.joints_start.empty()) return robot::joint_vector(params.joints_start);
  const control::PoseSolution solution =
      control::solve_pose(arm, scenario.controller.X_WE_start, robot::joint_vector(params.posture), 200);
  if (!solution.is_reached()) {
    throw InputError(scenario.source_name, "controller.start_pose",
                     fmt::format("{:.3f} m and {:.2f} rad from where the arm can bring the tool from its posture",
                                 solution.position_error, solution.angle_error),
                     "a pose within reach, or robot.joints_start");
  }
  return solution.q;
}

// rad (m) or rad/s (m/s), by which a joint may be beyond its limits: rounding.
constexpr double kRounding = 1e-9;
// N, of a link against something: less is rounding.
constexpr double kTouch = 0.5;
// A load that was acknowledged stops the arm again when it grows to so many times itself: what moves off shifts a load
// before it gives it up.
constexpr double kMoreThanAcknowledged = 1.5;
// s, after which links that no longer touch have parted: shorter gaps are bounces.
constexpr double kParted = 0.1;

void add_touch(physics::BodyId link, physics::BodyId other, double force, std::vector<ArmTouch>& touches) {
  for (ArmTouch& known : touches) {
    if (known.link != link || known.other != other) continue;
    known.force = std::max(known.force, force);
    return;
  }
  touches.push_back({link, other, 0.0, 0.0, force});
}

}  // namespace

CellArm::CellArm(const model::Scenario& scenario, double task_stiffness)
    : params_(params_of(scenario)),
      gravity_(scenario.gravity),
      controller_(make_controller(scenario, task_stiffness)),
      machine_(control::make_demonstrator_machine()),
      start_(start_joints(scenario, controller_.arm())),
      sensor_link_(robot::find_link(controller_.arm(), params_.sensor_frame)),
      load_(robot::distal_inertia(controller_.arm(), sensor_link_)) {}

void CellArm::attach(const CellWorld& world) {
  obstacles_.clear();
  shapes_.clear();
  for (std::size_t i = 0; i < world.model.bodies.size(); ++i) {
    const physics::BodyModel& body = world.model.bodies[i];
    if (body.kind != physics::BodyKind::Static) continue;
    const bool is_base = std::any_of(world.arm.begin(), world.arm.end(),
                                     [&](const ArmBody& part) { return part.body.index == static_cast<int>(i); });
    if (is_base) continue;
    for (const physics::Geom& geom : body.geoms) {
      const Pose X_WG = body.X_WB * geom.X_BG;
      obstacles_.push_back({static_cast<int>(i), geom.shape, X_WG, geometry::bounds(geom.shape, X_WG)});
    }
  }
  for (const ArmBody& part : world.arm) {
    const robot::Link& link = model().links[static_cast<std::size_t>(part.link)];
    if (link.segment == 0) continue;
    for (const model::PlacedShape& placed : link.shapes) {
      shapes_.push_back({part.body.index, {link.segment, link.X_SL * placed.X_BG, placed.shape, 0.0}});
    }
  }
  for (const physics::Geom& geom : world.model.bodies[static_cast<std::size_t>(world.tool.index)].geoms) {
    if (!geom.touches_held_body) continue;  // the cup gives way: docs/theory/controller.md, section 6
    shapes_.push_back({world.tool.index, {model().last_segment(), model().X_SE * geom.X_BG, geom.shape, 0.0}});
  }
}

ArmState CellArm::make_state(std::uint64_t seed, const JointVector& q) const {
  const JointVector none = JointVector::Zero(model().joint_count());
  return {machine_.make_state(controller_, q), Rng(seed).split("force sensor"), {}, {q, none, none}, {none}};
}

void CellArm::stand(ArmState& state) const { state.machine = machine_.make_state(controller_, state.machine.joints.q); }

void CellArm::acknowledge(const ArmReading& reading, ArmState& state) const {
  for (std::size_t j = 0; j < reading.joints.size(); ++j) {
    state.acknowledged.torques[static_cast<Eigen::Index>(j)] = std::abs(reading.joints[j].torque);
  }
  state.acknowledged.force = reading.sensor_force;
  state.acknowledged.torque = reading.sensor_torque;
}

control::MachineTick CellArm::tick(const motion::PreparedProgram& plan, motion::ControllerState& program,
                                   ArmState& state, control::JointControllerWork& work) const {
  if (state.machine.state >= 0) state.machine.program = program;
  const control::MachineTick tick = machine_.tick(plan, controller_, state.machine, work);
  program = state.machine.program;
  return tick;
}

JointVector CellArm::driven_accelerations(const control::DriveCommand& command, const control::JointMotion& motion,
                                          const OutsideDrive& outside) const {
  return control::compute_torque_accelerations(model(), command, motion, outside.torques_felt + outside.torques_fixed,
                                               gravity_);
}

JointVector CellArm::torques_of(const robot::ArmPose& at, const ArmLoads& loads) const {
  const robot::Jacobian J_WE = robot::tool_jacobian(model(), at);
  return J_WE.topRows<3>().transpose() * loads.F_Eo_W.force + J_WE.bottomRows<3>().transpose() * loads.F_Eo_W.torque +
         loads.torques;
}

void CellArm::aim(const CellWorld& world, const robot::ArmPose& at,
                  std::vector<physics::KinematicTarget>& targets) const {
  targets.clear();
  targets.push_back({world.tool, at.X_WE});
  for (const ArmBody& part : world.arm) {
    if (model().links[static_cast<std::size_t>(part.link)].segment == 0) continue;
    targets.push_back({part.body, robot::link_pose(model(), at, part.link)});
  }
}

void CellArm::add_force(const robot::ArmPose& at, int segment, const Vector3& p_WQ, const Vector3& force_W,
                        bool is_tool, ArmLoads& loads) const {
  if (is_tool) {
    loads.F_Eo_W.force += force_W;
    loads.F_Eo_W.torque += (p_WQ - at.X_WE.p).cross(force_W);
    return;
  }
  const robot::Jacobian J_WQ = robot::point_jacobian(model(), at, segment, p_WQ);
  loads.torques += J_WQ.topRows<3>().transpose() * force_W;
}

void CellArm::add_loads(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work,
                        const GripperState& gripper, const robot::ArmPose& at, ArmLoads& loads) const {
  if (loads.torques.size() == 0) loads.torques.setZero(model().joint_count());
  ++loads.steps;
  const auto link_of = [&](physics::BodyId body) {
    for (const ArmBody& part : world.arm) {
      if (part.body == body) return part.link;
    }
    return -1;
  };
  struct PairForce {
    physics::BodyId link, other;
    Vector3 force_W;
  };
  std::vector<PairForce> pairs;  // of moving links, all points of a pair together
  for (const physics::ContactReport& contact : work.contacts()) {
    for (const bool is_b : {false, true}) {
      const physics::BodyId body = is_b ? contact.b : contact.a;
      const bool is_tool = body == world.tool;
      const int link = is_tool ? -1 : link_of(body);
      if (!is_tool && link < 0) continue;
      const Vector3 force_W = is_b ? contact.force_W : Vector3(-contact.force_W);
      const int segment = is_tool ? model().last_segment() : model().links[static_cast<std::size_t>(link)].segment;
      add_force(at, segment, contact.p_WQ, force_W, is_tool, loads);
      const physics::BodyId other = is_b ? contact.a : contact.b;
      if (force_W.norm() > loads.worst_force) {
        loads.worst_force = force_W.norm();
        loads.worst_part = body;
        loads.worst_other = other;
      }
      if (is_tool || segment == 0) continue;
      const auto known = std::find_if(pairs.begin(), pairs.end(),
                                      [&](const PairForce& pair) { return pair.link == body && pair.other == other; });
      if (known == pairs.end()) {
        pairs.push_back({body, other, force_W});
      } else {
        known->force_W += force_W;
      }
    }
  }
  for (const PairForce& pair : pairs) add_touch(pair.link, pair.other, pair.force_W.norm(), loads.touches);
  if (gripper.cup.body >= 0) {  // the reaction of the cup
    const Pose X_WS = physics::pose_of(world.model, state, physics::BodyId{gripper.cup.body}) * gripper.cup.X_PS;
    const Vector3 force_W = -(X_WS.R * gripper.F_S.force);
    loads.F_Eo_W.force += force_W;
    loads.F_Eo_W.torque += (X_WS.p - at.X_WE.p).cross(force_W) - X_WS.R * gripper.F_S.torque;
  }
}

/// Links and gripper against what never moves: the physics has no forces between bodies that do not give way, so the
/// arm gives way here, like a spring at the point of contact. Returns the largest joint angle that it yields.
double CellArm::touch_obstacles(const CellWorld& world, const robot::ArmPose& at, ArmLoads& loads,
                                ArmReading& reading) const {
  double yielded = 0.0;
  for (const MovingShape& moving : shapes_) {
    const Pose X_WG = at.X_WS[static_cast<std::size_t>(moving.shape.segment)] * moving.shape.X_SG;
    const geometry::Aabb bounds = geometry::bounds(moving.shape.shape, X_WG);
    for (const Obstacle& obstacle : obstacles_) {
      if (!bounds.overlaps(obstacle.bounds)) continue;
      geometry::PairCache cache;
      geometry::Manifold manifold;
      geometry::collide(obstacle.shape, obstacle.X_WG, moving.shape.shape, X_WG, 0.0, cache, manifold);
      int deepest = -1;
      for (int i = 0; i < manifold.count; ++i) {
        const double phi = manifold.points[static_cast<std::size_t>(i)].phi;
        if (phi < 0.0 && (deepest < 0 || phi < manifold.points[static_cast<std::size_t>(deepest)].phi)) deepest = i;
      }
      if (deepest < 0) continue;
      const geometry::ManifoldPoint& point = manifold.points[static_cast<std::size_t>(deepest)];
      physics::ContactReport contact;
      contact.a = physics::BodyId{obstacle.body};
      contact.b = physics::BodyId{moving.body};
      contact.p_WQ = point.p_WA;
      contact.n_AB_W = manifold.n_AB_W;
      contact.force_W = -point.phi * params_.contact_stiffness * manifold.n_AB_W;
      contact.phi = point.phi;
      reading.contacts.push_back(contact);
      const bool is_tool = moving.body == world.tool.index;
      add_force(at, moving.shape.segment, contact.p_WQ, contact.force_W, is_tool, loads);
      const JointVector row = (manifold.n_AB_W.transpose() *
                               robot::point_jacobian(model(), at, moving.shape.segment, contact.p_WQ).topRows<3>())
                                  .transpose();
      if (row.squaredNorm() > 0.0) {
        yielded = std::max(yielded, -point.phi * row.lpNorm<Eigen::Infinity>() / row.squaredNorm());
      }
      if (!is_tool) add_touch(contact.b, contact.a, contact.force_W.norm(), loads.touches);
      if (contact.force_W.norm() > loads.worst_force) {
        loads.worst_force = contact.force_W.norm();
        loads.worst_part = contact.b;
        loads.worst_other = contact.a;
      }
    }
  }
  return yielded;
}

void CellArm::follow_touches(double time, const ArmLoads& loads, ArmState& state, ArmReading& reading) const {
  reading.touches_begun.clear();
  reading.touches_ended.clear();
  for (const ArmTouch& touch : loads.touches) {
    if (touch.force < kTouch) continue;
    const auto known = std::find_if(state.touches.begin(), state.touches.end(), [&](const ArmTouch& open) {
      return open.link == touch.link && open.other == touch.other;
    });
    if (known != state.touches.end()) {
      known->force = std::max(known->force, touch.force);
      known->last = time;
      continue;
    }
    state.touches.push_back({touch.link, touch.other, time, time, touch.force});
    reading.touches_begun.push_back(state.touches.back());
  }
  std::erase_if(state.touches, [&](const ArmTouch& open) {
    const bool has_ended = time - open.last > kParted;
    if (has_ended) reading.touches_ended.push_back(open);
    return has_ended;
  });
}

Wrench CellArm::disturbed(const Wrench& F, double time, Rng& noise) const {
  const model::ForceSensorParams& sensor = params_.sensor;
  Wrench read = F;
  read.force += sensor.force_bias + time * sensor.force_drift;
  read.torque += sensor.torque_bias + time * sensor.torque_drift;
  if (sensor.force_noise > 0.0) {
    for (double& value : read.force) value += sensor.force_noise * noise.normal();
  }
  if (sensor.torque_noise > 0.0) {
    for (double& value : read.torque) value += sensor.torque_noise * noise.normal();
  }
  return read;
}

std::optional<ProtectiveStop> CellArm::find_stop(const ArmState& state, const ArmTask& task, const ArmReading& reading,
                                                 double yielded) const {
  std::optional<ProtectiveStop> found;
  const auto stop = [&](StopCause cause, std::string where, double value, double limit, const char* unit) {
    if (found || !(value > limit)) return;
    found = ProtectiveStop{cause, std::move(where), value, limit, unit, 0.0, task.row, "", "", ""};
    if (task.waypoint != nullptr) found->waypoint = motion::name_of(*task.waypoint);
  };
  const auto stop_by_load = [&](StopCause cause, const std::string& where, double value, double limit,
                                double acknowledged, const char* unit) {
    stop(cause, where, value, std::max(limit, kMoreThanAcknowledged * acknowledged), unit);
  };
  const AcknowledgedLoad& known = state.acknowledged;
  const control::JointState& joints = state.machine.joints;
  for (Eigen::Index j = 0; j < joints.q.size(); ++j) {
    const robot::Joint& joint = model().joints[static_cast<std::size_t>(j)];
    const bool turns = joint.kind == robot::JointKind::Revolute;
    const double torque = std::abs(reading.joints[static_cast<std::size_t>(j)].torque);
    stop_by_load(StopCause::JointTorque, joint.name, torque, torque_limit(j), known.torques[j], turns ? "Nm" : "N");
    if (task.outside == nullptr) continue;
    stop(StopCause::JointSpeed, joint.name, std::abs(joints.qd[j]), joint.max_speed + kRounding,
         turns ? "rad/s" : "m/s");
    stop(StopCause::JointRange, joint.name, joints.q[j], joint.upper + kRounding, turns ? "rad" : "m");
    stop(StopCause::JointRange, joint.name, -joints.q[j], -joint.lower + kRounding, turns ? "rad" : "m");
  }
  const std::string& sensor = params_.sensor_frame;
  const model::ProtectiveStop& limits = params_.protective_stop;
  stop_by_load(StopCause::SensorForce, sensor, reading.sensor_force, limits.sensor_force, known.force, "N");
  stop_by_load(StopCause::SensorTorque, sensor, reading.sensor_torque, limits.sensor_torque, known.torque, "Nm");
  stop(StopCause::TrackingError, "the joints", yielded, params_.protective_stop.tracking_error, "rad");
  if (task.is_stuck && task.waypoint != nullptr) {
    stop(StopCause::Stuck, motion::name_of(*task.waypoint), (task.waypoint->X_WE.p - state.machine.tool.X_WE.p).norm(),
         -1.0, "m");
  }
  return found;
}

double CellArm::torque_limit(Eigen::Index joint) const {
  return params_.protective_stop.torque_fraction * model().joints[static_cast<std::size_t>(joint)].max_effort;
}

void CellArm::forget_released(const ArmReading& reading, AcknowledgedLoad& acknowledged) const {
  for (Eigen::Index j = 0; j < acknowledged.torques.size(); ++j) {
    const double torque = std::abs(reading.joints[static_cast<std::size_t>(j)].torque);
    if (torque <= torque_limit(j)) acknowledged.torques[j] = 0.0;
  }
  if (reading.sensor_force <= params_.protective_stop.sensor_force) acknowledged.force = 0.0;
  if (reading.sensor_torque <= params_.protective_stop.sensor_torque) acknowledged.torque = 0.0;
}

void CellArm::read(const CellWorld& world, const ArmTask& task, double time, ArmLoads& loads, ArmState& state,
                   ArmReading& reading) const {
  const control::JointState& joints = state.machine.joints;
  const robot::ArmPose at = robot::forward(model(), joints.q);
  const double share = 1.0 / std::max(1, loads.steps);
  loads.F_Eo_W.force *= share;
  loads.F_Eo_W.torque *= share;
  if (loads.torques.size() == 0) loads.torques.setZero(model().joint_count());
  loads.torques *= share;
  reading.contacts.clear();
  reading.control = task.control;
  const ArmLoads moving = loads;
  const double yielded = touch_obstacles(world, at, loads, reading);
  if (task.outside != nullptr) state.outside.torques_fixed = torques_of(at, loads) - torques_of(at, moving);

  const robot::ArmMotion motion{joints.q, joints.qd, joints.qdd};
  const JointVector zero = JointVector::Zero(joints.q.size());
  const JointVector torques = robot::inverse_dynamics(model(), motion, loads.F_Eo_W, gravity_) - loads.torques;
  const Wrench F_sensor = robot::sensor_wrench(model(), motion, sensor_link_, load_, loads.F_Eo_W, gravity_);
  const Wrench weight = robot::sensor_wrench(model(), {joints.q, zero, zero}, sensor_link_, load_, Wrench{}, gravity_);
  reading.F_Eo_W = loads.F_Eo_W;
  reading.F_sensor = disturbed(F_sensor, time, state.noise);
  reading.joints.resize(static_cast<std::size_t>(joints.q.size()));
  for (Eigen::Index j = 0; j < joints.q.size(); ++j) {
    reading.joints[static_cast<std::size_t>(j)] = {joints.q[j], joints.qd[j], torques[j]};
  }

  follow_touches(time, loads, state, reading);
  reading.sensor_force = (F_sensor.force - weight.force).norm();
  reading.sensor_torque = (F_sensor.torque - weight.torque).norm();
  reading.stop = find_stop(state, task, reading, yielded);
  forget_released(reading, state.acknowledged);
  if (!reading.stop) return;
  reading.stop->time = time;
  if (loads.worst_force > 0.0) {
    reading.stop->touching = fmt::format("{} with {}, {:.0f} N", name_of(world, loads.worst_other),
                                         name_of(world, loads.worst_part), loads.worst_force);
  }
  for (int i = 0; i < task.control.active_count; ++i) {
    reading.stop->limited_by +=
        (i == 0 ? "limited by " : ", ") + controller_.describe(task.control.active[static_cast<std::size_t>(i)]);
  }
}

}  // namespace snug::cell
