// ReachProfile: where an arm can hold its tool pointing down, by distance and height from its first axis.
#include "snug/runs/internal/reach_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/runs/reach_map.hpp"

namespace snug::runs::internal {
namespace {

constexpr int kStepsOfReach = 36;

/// The robot at the origin, and nothing else.
model::Scenario robot_alone(const model::Scenario& scenario) {
  model::Scenario alone = scenario;
  alone.robot->X_WB = Pose{};
  alone.bodies.clear();
  alone.containers.clear();
  alone.aligner.reset();
  return alone;
}

Pose tool_at(const Eigen::Vector2d& axis, double direction, double distance, double height) {
  return {motion::upright_tool(direction),
          {axis.x() + distance * std::cos(direction), axis.y() + distance * std::sin(direction), height}};
}

/// The second joint goes around the first axis in a circle; what is behind it is no longer than its parts.
struct ArmLengths {
  double offset = 0.0;    ///< m, of the second joint from the first axis
  double shoulder = 0.0;  ///< m, its height over the root link
  double longest = 0.0;   ///< m, from it to E
};
ArmLengths find_lengths(const robot::ArmModel& arm) {
  const robot::Joint& first = arm.joints.front();
  const Vector3 p_BS = arm.moving_count() > 1 ? Vector3(first.X_SJ * arm.moving(1).joint.X_SJ.p) : first.X_SJ.p;
  ArmLengths lengths{(p_BS - first.X_SJ.p).head<2>().norm(), p_BS.z(), arm.X_SE.p.norm()};
  for (std::size_t i = 2; i < arm.moving_count(); ++i) {
    const robot::Joint& joint = arm.moving(i).joint;
    lengths.longest += joint.X_SJ.p.norm();
    if (joint.kind == robot::JointKind::Prismatic)
      lengths.longest += std::max(std::abs(joint.lower), std::abs(joint.upper));
  }
  return lengths;
}

/// rad, how far the first joint stands from `mid` where the tool is there, the nearest branch; none where no branch
/// passes all tests.
std::optional<double> turn_at(const PoseReachability& reach, const Pose& X_BE, double mid) {
  std::optional<double> nearest;
  for (const std::vector<double>& q : reach.find_stands(X_BE)) {
    const double turn = std::remainder(q.front() - mid, 2.0 * std::numbers::pi);
    if (!nearest || std::abs(turn) < std::abs(*nearest)) nearest = turn;
  }
  return nearest;
}

}  // namespace

ReachProfile::ReachProfile(const model::Scenario& scenario, double lowest, double highest, int threads) {
  const model::Scenario alone = robot_alone(scenario);
  const robot::ArmModel arm = robot::load_arm(alone);
  const robot::Joint& first = arm.joints.front();
  const double up = (first.X_SJ.R * first.axis).z();
  if (first.kind != robot::JointKind::Revolute || std::abs(up) < 1.0 - 1e-6)
    throw InputError(scenario.source_name, "robot.urdf", "first joint '" + first.name + "'",
                     "one that turns about the vertical; other robots are placed with snug check --reach");
  p_BA_ = first.X_SJ.p.head<2>();
  const bool has_ends = std::isfinite(first.lower) && std::isfinite(first.upper);
  const double mid = has_ends ? 0.5 * (first.lower + first.upper) : 0.0;
  half_turn_ = has_ends ? 0.5 * (first.upper - first.lower) : std::numeric_limits<double>::infinity();

  const ArmLengths lengths = find_lengths(arm);
  step_ = (lengths.offset + lengths.longest) / kStepsOfReach;
  columns_ = kStepsOfReach + 2;
  lowest_ = std::max(lowest, lengths.shoulder - lengths.longest);
  rows_ = 2 + static_cast<int>(std::max(0.0, std::min(highest, lengths.shoulder + lengths.longest) - lowest_) / step_);

  const PoseReachability reach(alone);
  std::vector<char> flags(static_cast<std::size_t>(rows_ * columns_));
  const auto pose_of = [&](int i) {
    return tool_at(p_BA_, middle_, step_ * (i % columns_), lowest_ + step_ * (i / columns_));
  };
  const auto look_at_all = [&] {
    parallel_for(static_cast<int>(flags.size()), threads, [&](int i, int) {
      const Pose X_BE = pose_of(i);
      const double beside = std::max(0.0, step_ * (i % columns_) - lengths.offset);
      const bool can_be = std::hypot(beside, X_BE.p.z() - lengths.shoulder) <= lengths.longest;
      flags[static_cast<std::size_t>(i)] = can_be && reach.look(X_BE).verdict == ReachVerdict::Reached ? 1 : 0;
    });
  };
  look_at_all();
  // Which way the arm points at the middle of its first joint: by the pose in the middle of those that it reaches.
  std::vector<int> reached;
  for (int i = 0; i < rows_ * columns_; ++i)
    if (flags[static_cast<std::size_t>(i)] != 0) reached.push_back(i);
  const std::optional<double> turn =
      reached.empty() ? std::nullopt : turn_at(reach, pose_of(reached[reached.size() / 2]), mid);
  constexpr double kNearEnd = 0.5;  // rad from the middle: the first look may have been at the end of the joint
  if (turn) middle_ = up > 0.0 ? -*turn : *turn;
  if (turn && std::abs(*turn) > kNearEnd) look_at_all();
  measure_depths(flags);
}

/// The nearest point that is not as this one is; a step between the two counts half.
void ReachProfile::measure_depths(const std::vector<char>& flags) {
  depth_.assign(flags.size(), 0.0);
  for (int i = 0; i < rows_ * columns_; ++i) {
    const bool is_reached = flags[static_cast<std::size_t>(i)] != 0;
    if (is_reached) reach_ = std::max(reach_, step_ * (i % columns_));
    double nearest = columns_ + 0.5;
    for (int k = 0; k < rows_ * columns_; ++k) {
      if ((flags[static_cast<std::size_t>(k)] != 0) == is_reached) continue;
      nearest = std::min(nearest, std::hypot(k / columns_ - i / columns_, k % columns_ - i % columns_));
    }
    depth_[static_cast<std::size_t>(i)] = (is_reached ? step_ : -step_) * (nearest - 0.5);
  }
}

double ReachProfile::depth(double distance, double height) const {
  const double x = distance / step_, y = (height - lowest_) / step_;
  if (x > columns_ - 1 || y < 0.0 || y > rows_ - 1) return -step_;
  const int column = std::min(static_cast<int>(x), columns_ - 2), row = std::clamp(static_cast<int>(y), 0, rows_ - 2);
  const double u = x - column, v = y - row;
  return (1.0 - v) * ((1.0 - u) * node(column, row) + u * node(column + 1, row)) +
         v * ((1.0 - u) * node(column, row + 1) + u * node(column + 1, row + 1));
}

}  // namespace snug::runs::internal
