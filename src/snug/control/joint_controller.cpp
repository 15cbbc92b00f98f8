// JointController: the joint accelerations of one tick: tasks and limits of an arm as one quadratic programme.
#include "snug/control/joint_controller.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"

namespace snug::control {
namespace {

using robot::JointVector;

// Part of the joints' acceleration limit that braking in front of a limit may count on; the rest keeps the last ticks
// in front of it feasible, where speeds are known only a tick ahead.
constexpr double kBrakingReserve = 0.8;
// Of the distance to the safety distance, at most this part is travelled in a tick.
constexpr double kLargestApproach = 0.5;
// Exact following: part of the remaining pose error that is taken back in a tick.
constexpr double kExactGain = 0.25;
// Below this singularity measure the tool's task gives way to damping of the joints; the demonstrator's programs stay
// above 0.2. kSingularWeight is its weight at a singularity, against 1 for the tool: there a tool that is 1 m off
// (10 m/s^2 wanted) asks for no more than some rad/s^2. Both chosen on targets out of reach, which made the arm
// chatter.
constexpr double kSingular = 0.05;
constexpr double kSingularWeight = 0.05;
// s, over which the motion is looked ahead for the acceleration that a distance has by itself.
constexpr double kLookAhead = 1e-4;
// A row that the joints can hardly move, m per rad: it says nothing.
constexpr double kDeadRow = 1e-6;

Vector6 desired_acceleration(const ToolTarget& target, const Pose& X_WE, const Vector6& V_WE, double stiffness,
                             double dt) {
  Vector6 error;
  error << target.X_WE.p - X_WE.p, log_rotation(target.X_WE.R * X_WE.R.transpose());
  if (!target.is_exact) return stiffness * error - 2.0 * std::sqrt(stiffness) * V_WE;
  const Vector6 V_end = as_vector(target.V_WE);
  return (V_end - V_WE) / dt + kExactGain / (dt * dt) * (error - 0.5 * dt * (V_WE + V_end));
}

}  // namespace

JointController::JointController(robot::ArmModel arm, JointControllerSettings settings)
    : arm_(std::move(arm)),
      settings_(std::move(settings)),
      drive_(arm_, settings_.params.max_joint_acceleration, settings_.tick),
      clearance_(arm_, settings_.carried, settings_.params.self_collision, settings_.where) {
  const int n = arm_.joint_count();
  posture_.setZero(n);
  const std::vector<double>& posture = settings_.params.posture;
  if (!posture.empty() && static_cast<int>(posture.size()) != n) {
    throw InputError(settings_.where, "posture", fmt::format("{} numbers", posture.size()),
                     fmt::format("one for each of the {} joints", n));
  }
  for (std::size_t i = 0; i < posture.size(); ++i) posture_[static_cast<Eigen::Index>(i)] = posture[i];
  SNUG_CHECK(4 * n + static_cast<int>(clearance_.pairs().size()) < numerics::kMaxQpRows, "too many pairs for the QP");
}

JointState JointController::make_state(const JointVector& q) const {
  JointState state;
  state.q = q;
  state.qd.setZero(q.size());
  state.qdd.setZero(q.size());
  return state;
}

double JointController::add_tasks(const ToolTarget& target, const JointState& state, const robot::ArmPose& at,
                                  numerics::QpProblem& problem) const {
  const model::RobotTasks& tasks = settings_.params.tasks;
  const robot::Jacobian J_WE = robot::tool_jacobian(arm_, at);
  const Vector6 V_WE = J_WE * state.qd;
  const Vector6 wanted = desired_acceleration(target, at.X_WE, V_WE, settings_.tool_stiffness, settings_.tick) -
                         robot::tool_bias_acceleration(arm_, at, state.qd);
  const double weight = tasks.posture_weight / tasks.tool_weight;  // scaled so that the tool's is 1
  const JointVector posture =
      tasks.posture_stiffness * (posture_ - state.q) - 2.0 * std::sqrt(tasks.posture_stiffness) * state.qd;
  problem.reset(arm_.joint_count());
  problem.H.noalias() = J_WE.transpose() * J_WE;
  problem.H.diagonal().array() += weight;
  problem.g.noalias() = -(J_WE.transpose() * wanted);
  problem.g -= weight * posture;
  const double singularity = robot::singularity_measure(J_WE);
  if (singularity < kSingular) {
    const double damping = kSingularWeight * std::pow(1.0 - singularity / kSingular, 2);
    problem.H.diagonal().array() += damping;
    problem.g += damping * 2.0 * std::sqrt(settings_.tool_stiffness) * state.qd;
  }
  return singularity;
}

void JointController::add_joint_limits(JointState& state, JointControllerWork& work) const {
  const model::RobotParams& params = settings_.params;
  const double dt = settings_.tick, a_max = params.max_joint_acceleration;
  const auto add = [&](int joint, double sign, double bound, LimitKind kind) {
    work.problem.add_row((sign * JointVector::Unit(arm_.joint_count(), joint)).transpose(), bound);
    work.rows.push_back({kind, joint});
  };
  for (int j = 0; j < arm_.joint_count(); ++j) {
    const robot::Joint& joint = arm_.joints[static_cast<std::size_t>(j)];
    const double range = joint.upper - joint.lower;
    const double near = params.damper.interaction * range, safe = params.damper.safety * range;
    for (const double sign : {1.0, -1.0}) {  // speed toward the lower limit, toward the upper one
      double fastest = params.velocity_fraction * joint.max_speed;
      LimitKind kind = LimitKind::Speed;
      double& damping = state.damping[static_cast<std::size_t>(2 * j + (sign > 0.0 ? 0 : 1))];
      const double distance = sign > 0.0 ? state.q[j] - joint.lower : joint.upper - state.q[j];
      if (std::isfinite(range) && distance < near) {
        const double room = std::max(0.0, distance - safe);
        if (damping == 0.0) {
          damping = params.damper.offset;
          if (room > 0.0) damping += std::abs((near - safe) / room * state.qd[j]);
        }
        const double damped =
            std::min(damping * room / (near - safe), stopping_speed(room, kBrakingReserve * a_max, dt));
        if (damped < fastest) {
          fastest = damped;
          kind = sign > 0.0 ? LimitKind::LowerPosition : LimitKind::UpperPosition;
        }
      } else {
        damping = 0.0;
      }
      add(j, sign, (-fastest - sign * state.qd[j]) / dt, kind);
      add(j, sign, -a_max, LimitKind::Acceleration);
    }
  }
}

void JointController::add_distances(const JointState& state, const robot::ArmPose& at, JointTick& report,
                                    JointControllerWork& work) const {
  const model::RobotParams& params = settings_.params;
  using Row = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, robot::kMaxJoints>;
  const double dt = settings_.tick;
  const robot::ArmPose ahead = robot::forward(arm_, state.q + kLookAhead * state.qd);
  for (int i = 0; i < static_cast<int>(clearance_.pairs().size()); ++i) {
    const Nearest nearest = clearance_.nearest(at, i);
    if (nearest.index < 0) continue;
    if (report.nearest.index < 0 || nearest.distance < report.nearest.distance) report.nearest = nearest;
    const Clearance::Pair& pair = clearance_.pairs()[static_cast<std::size_t>(i)];
    const int segment_a = clearance_.parts()[static_cast<std::size_t>(pair.part_a)].segment;
    const int segment_b = clearance_.parts()[static_cast<std::size_t>(pair.part_b)].segment;
    const auto row_at = [&](const robot::ArmPose& pose, const Vector3& p_WA, const Vector3& p_WB) -> Row {
      return nearest.n_AB_W.transpose() * (robot::point_jacobian(arm_, pose, segment_b, p_WB).topRows<3>() -
                                           robot::point_jacobian(arm_, pose, segment_a, p_WA).topRows<3>());
    };
    const auto carried = [&](int segment, const Vector3& p_WQ) {
      return ahead.X_WS[static_cast<std::size_t>(segment)] *
             (at.X_WS[static_cast<std::size_t>(segment)].inverse() * p_WQ);
    };
    const Row row = row_at(at, nearest.p_WA, nearest.p_WB);
    if (row.norm() < kDeadRow) continue;
    const double room = std::max(0.0, nearest.distance - pair.safety);
    const double braking = kBrakingReserve * params.max_joint_acceleration * row.lpNorm<1>();
    const double approach = std::min({params.collision_damping * room / (pair.interaction - pair.safety),
                                      kLargestApproach * room / dt, stopping_speed(room, braking, dt)});
    // What the two points do along the normal without any joint acceleration.
    const Row later = row_at(ahead, carried(segment_a, nearest.p_WA), carried(segment_b, nearest.p_WB));
    const double bias = (later - row).dot(state.qd) / kLookAhead;
    work.problem.add_row(row, (-approach - row.dot(state.qd)) / dt - bias);
    work.rows.push_back({LimitKind::Distance, i});
  }
}

void JointController::report_active(const JointControllerWork& work, JointTick& report) const {
  std::array<double, 8> strengths{};
  for (int i = 0; i < work.problem.row_count(); ++i) {
    const double strength = work.result.multipliers[i];
    if (!(strength > 0.0)) continue;
    int place = report.active_count;
    if (place == static_cast<int>(strengths.size())) {
      if (strength <= strengths.back()) continue;
      --place;
    } else {
      ++report.active_count;
    }
    for (; place > 0 && strengths[static_cast<std::size_t>(place - 1)] < strength; --place) {
      strengths[static_cast<std::size_t>(place)] = strengths[static_cast<std::size_t>(place - 1)];
      report.active[static_cast<std::size_t>(place)] = report.active[static_cast<std::size_t>(place - 1)];
    }
    strengths[static_cast<std::size_t>(place)] = strength;
    report.active[static_cast<std::size_t>(place)] = work.rows[static_cast<std::size_t>(i)];
  }
}

JointTick JointController::tick(const ToolTarget& target, JointState& state, JointControllerWork& work) const {
  JointTick report;
  const robot::ArmPose at = robot::forward(arm_, state.q);
  work.rows.clear();
  report.singularity = add_tasks(target, state, at, work.problem);
  add_joint_limits(state, work);
  add_distances(state, at, report, work);
  work.solver.solve(work.problem, work.result);
  report.rounds = work.result.rounds;
  if (work.result.status == numerics::QpStatus::Solved) {
    state.held_ticks = 0;
    report_active(work, report);
    drive_.follow_speed(state.qd + settings_.tick * work.result.x, state);
  } else {
    report.is_holding = true;
    ++state.held_ticks;
    if (work.result.worst_row >= 0) report.worst = work.rows[static_cast<std::size_t>(work.result.worst_row)];
    report.violation = work.result.violation;
    brake(state);
  }
  return report;
}

void JointController::brake(JointState& state) const { drive_.follow_speed(JointVector::Zero(state.q.size()), state); }

std::string JointController::describe(const LimitId& limit) const {
  if (limit.index < 0) return "the solver";
  if (limit.kind == LimitKind::Distance) {
    return fmt::format("distance {}", clearance_.name_of(limit.index));
  }
  const std::string& joint = arm_.joints[static_cast<std::size_t>(limit.index)].name;
  switch (limit.kind) {
    case LimitKind::LowerPosition:
      return joint + " at its lower limit";
    case LimitKind::UpperPosition:
      return joint + " at its upper limit";
    case LimitKind::Speed:
      return joint + " at its largest speed";
    default:
      return joint + " at its largest acceleration";
  }
}

}  // namespace snug::control
