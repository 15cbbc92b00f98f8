// ReachProfile: where an arm can hold its tool pointing down, by distance and height from its first axis.
#include "snug/runs/internal/reach_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

}  // namespace

ReachProfile::ReachProfile(const model::Scenario& scenario, double lowest, double highest, int threads)
    : lowest_(lowest) {
  const model::Scenario alone = robot_alone(scenario);
  const robot::ArmModel arm = robot::load_arm(alone);
  const robot::Joint& first = arm.joints.front();
  const Vector3 axis = first.X_SJ.R * first.axis;
  if (first.kind != robot::JointKind::Revolute || std::abs(axis.z()) < 1.0 - 1e-6)
    throw InputError(scenario.source_name, "robot.urdf", "first joint '" + first.name + "'",
                     "one that turns about the vertical; other robots are placed with snug check --reach");
  p_BA_ = first.X_SJ.p.head<2>();

  // The second joint turns in a circle about the axis; what is behind it is no longer than its parts.
  double longest = arm.X_SE.p.norm();
  for (std::size_t i = 2; i < arm.joints.size(); ++i) {
    longest += arm.joints[i].X_SJ.p.norm();
    if (arm.joints[i].kind == robot::JointKind::Prismatic)
      longest += std::max(std::abs(arm.joints[i].lower), std::abs(arm.joints[i].upper));
  }
  const Vector3 p_BS = arm.joints.size() > 1 ? Vector3(first.X_SJ * arm.joints[1].X_SJ.p) : first.X_SJ.p;
  const double offset = (p_BS.head<2>() - p_BA_).norm();
  step_ = (offset + longest) / kStepsOfReach;
  columns_ = kStepsOfReach + 2;
  rows_ = static_cast<int>(std::ceil((highest - lowest) / step_)) + 1;

  const PoseReachability reach(alone);
  const bool has_ends = std::isfinite(first.lower) && std::isfinite(first.upper);
  const double mid = has_ends ? 0.5 * (first.lower + first.upper) : 0.0;
  half_turn_ = has_ends ? 0.5 * (first.upper - first.lower) : std::numeric_limits<double>::infinity();

  // Which way the arm points at the middle of its first joint: by any pose that it reaches.
  double direction = 0.0;
  std::vector<double> flags(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(columns_), 0.0);
  const auto look_at_all = [&] {
    parallel_for(static_cast<int>(flags.size()), threads, [&](int i, int) {
      const double distance = step_ * (i % columns_), height = lowest_ + step_ * (i / columns_);
      const double from_shoulder = std::hypot(std::max(0.0, distance - offset), height - p_BS.z());
      flags[static_cast<std::size_t>(i)] =
          from_shoulder <= longest &&
                  reach.look(tool_at(p_BA_, direction, distance, height)).verdict == ReachVerdict::Reached
              ? 1.0
              : 0.0;
    });
  };
  look_at_all();
  const auto some = [&] {  // the reached pose in the middle of all
    std::vector<int> reached;
    for (std::size_t i = 0; i < flags.size(); ++i)
      if (flags[i] > 0.0) reached.push_back(static_cast<int>(i));
    return reached.empty() ? -1 : reached[reached.size() / 2];
  }();
  if (some >= 0) {
    const Pose at = tool_at(p_BA_, direction, step_ * (some % columns_), lowest_ + step_ * (some / columns_));
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& q : reach.find_stands(at)) {
      const double turn = std::remainder(q.front() - mid, 2.0 * std::numbers::pi);
      if (std::abs(turn) >= nearest) continue;
      nearest = std::abs(turn);
      middle_ = -turn * (axis.z() > 0.0 ? 1.0 : -1.0);
    }
    direction = middle_;
    if (nearest > 0.5) look_at_all();  // the first look was near the end of the joint
  }

  // How deep each point is within what is reached: the nearest point that is not, a step of which counts half.
  depth_.assign(flags.size(), 0.0);
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const std::size_t at =
          static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
      const bool is_reached = flags[at] > 0.0;
      if (is_reached) reach_ = std::max(reach_, step_ * column);
      double nearest = std::numeric_limits<double>::infinity();
      for (int r = 0; r < rows_; ++r) {
        for (int c = 0; c < columns_; ++c) {
          const bool other =
              flags[static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(c)] >
              0.0;
          if (other != is_reached) nearest = std::min(nearest, std::hypot(r - row, c - column));
        }
      }
      const double depth = std::isfinite(nearest) ? step_ * (nearest - 0.5) : step_ * columns_;
      depth_[at] = is_reached ? depth : -depth;
    }
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
