// JointPace: how fast the joints of the scenario's robot let the tool go, and gain speed, along a way.
#include "snug/cell/joint_pace.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <utility>

#include "snug/robot/load_arm.hpp"

namespace snug::cell {
namespace {

constexpr std::size_t kLooks = 16;  ///< at the joints, along a way
/// Left of the limits beside half of what a slope differs from that of the look before: the speed between two looks is
/// their mean, its peak lies a little above. At the first look there is nothing to compare with.
constexpr double kReserve = 0.985, kReserveOfFirst = 0.965;
/// Of the joints' accelerations; what is left is for the controller, which makes up for what it is late.
constexpr double kOfSpeedingUp = 0.7, kOfBending = 0.3;

constexpr double kUpright = 1.0 - 1e-6;  ///< cosine: a first axis that stands upright, or hangs

/// rad (m), the short way round for joints that turn.
double difference(const robot::Joint& joint, double from, double to) {
  const double turn = to - from;
  return joint.kind == robot::JointKind::Revolute ? std::remainder(turn, 2.0 * std::numbers::pi) : turn;
}

}  // namespace

void JointPace::limit(const motion::Way& way, std::span<double> rates, std::span<double> accelerations) const noexcept {
  const auto first = inverse_.nearest(way.start(), posture_);
  if (!first) return;
  robot::JointVector q = *first, slope_before;
  const auto lower = [](std::span<double> limits, std::size_t look, double limit) {
    for (std::size_t i = look * limits.size() / kLooks; i < (look + 1) * limits.size() / kLooks; ++i)
      limits[i] = std::min(limits[i], limit);
  };
  for (std::size_t look = 0; look < kLooks; ++look) {
    const Pose X_WE = way.at(static_cast<double>(look + 1) / kLooks);
    const std::optional<robot::JointVector> next = inverse_.refine(X_WE, q);
    if (!next) return;
    robot::JointVector slope(q.size());  // of each joint by the share of the way
    double rate = std::numeric_limits<double>::infinity();
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      const robot::Joint& joint = inverse_.arm().joints[static_cast<std::size_t>(j)];
      slope[j] = difference(joint, q[j], (*next)[j]) * kLooks;
      if (slope[j] == 0.0) continue;
      const double peak = std::abs(slope[j]) + (look > 0 ? 0.5 * std::abs(slope[j] - slope_before[j]) : 0.0);
      rate = std::min(rate, (look > 0 ? kReserve : kReserveOfFirst) * share_ * joint.max_speed / peak);
    }
    lower(rates, look, rate);
    // q'' = slope s'' + bend s'^2: each may have its part of what the joints can do.
    const double steepest = slope.cwiseAbs().maxCoeff();
    if (steepest > 0.0) lower(accelerations, look, kOfSpeedingUp * acceleration_ / steepest);
    if (look > 0) {
      const double bend = (slope - slope_before).cwiseAbs().maxCoeff() * kLooks;
      const double most = bend > 0.0 ? std::sqrt(kOfBending * acceleration_ / bend) : rate;
      lower(rates, look - 1, most);
      lower(rates, look, most);
    }
    slope_before = slope;
    q = *next;
  }
}

std::optional<motion::PanAxis> find_pan_axis(const model::Scenario& scenario) {
  if (!scenario.robot || std::abs(scenario.robot->X_WB.R(2, 2)) < kUpright) return std::nullopt;
  const settings::TravelParams& travel = scenario.skills.travel;
  return motion::PanAxis{scenario.robot->X_WB.p, travel.least_pan, travel.least_radius};
}

void limit_joint_speeds(model::Scenario& scenario, const motion::Tracking& tracking) {
  if (!scenario.robot || motion::is_fast(tracking)) return;
  double& fraction = scenario.robot->velocity_fraction;
  fraction = std::min(fraction, scenario.controller.velocity_fraction);
}

std::unique_ptr<const JointPace> make_joint_pace(const model::Scenario& scenario, double tempo) {
  std::error_code error;
  if (!scenario.robot || !std::filesystem::exists(robot::urdf_path(scenario), error)) return nullptr;
  robot::ArmModel arm = robot::load_arm(scenario);
  robot::JointVector posture = robot::joint_vector(scenario.robot->posture);
  if (posture.size() == 0) posture.setZero(arm.joint_count());
  return std::make_unique<const JointPace>(std::move(arm), std::move(posture),
                                           tempo * scenario.robot->velocity_fraction,
                                           scenario.robot->max_joint_acceleration);
}

}  // namespace snug::cell
