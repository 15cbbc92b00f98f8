// Limits: how much of what a robot's joints and the hold of the cup allow a recorded run used.
#include "snug/replay/limits.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "snug/cell/joint_pace.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"
#include "snug/cup/phases.hpp"
#include "snug/replay/internal/recorded_scenario.hpp"
#include "snug/robot/arm.hpp"

namespace snug::replay {
namespace {

/// A recording that does not say otherwise was made fast.
bool is_fast(const record::RecordingHeader& header) {
  const auto settings = nlohmann::json::parse(header.settings, nullptr, false);
  return !settings.is_object() || settings.value("controller", nlohmann::json("fast")) == "fast";
}

}  // namespace

std::optional<JointUseLimits> joint_limits_of(const record::RecordingHeader& header, const std::string& urdf) {
  std::optional<model::Scenario> scenario = internal::scenario_of(header);
  if (header.joints.empty() || !scenario || !scenario->robot) return std::nullopt;
  std::vector<robot::JointLimits> known;
  try {
    known = robot::parse_joint_limits(urdf, scenario->robot->urdf);
  } catch (const InputError&) {  // another robot's, or damaged: the run was not made with it
    return std::nullopt;
  }
  JointUseLimits limits;
  limits.acceleration = scenario->robot->max_joint_acceleration;
  if (!is_fast(header)) cell::limit_joint_speeds(*scenario, motion::LaggedTracking{});
  for (const std::string& name : header.joints) {
    const auto found = std::ranges::find(known, name, &robot::JointLimits::joint);
    if (found == known.end() || !(found->max_speed > 0.0)) return std::nullopt;
    limits.speed.push_back(scenario->robot->velocity_fraction * found->max_speed);
    limits.torque.push_back(found->max_effort);
  }
  return limits;
}

HoldUse::HoldUse(const record::RecordingHeader& header) {
  const std::optional<model::Scenario> scenario = internal::scenario_of(header);
  if (scenario && scenario->tool) params_ = scenario->cup;
}

double HoldUse::next(const record::Frame& frame) {
  const record::CupSample& cup = frame.cup;
  if (cup.attached_body < 0 || !cup.vacuum_command || !params_) {
    is_established_ = false;
    return kNaN;
  }
  is_established_ =
      is_established_ || cup.pressure_gauge <= cup::kEstablishedVacuum * params_->vacuum.pressure_gauge_hold;
  return is_established_ ? 1.0 / cup::find_hold_factor(*params_, cup.pressure_gauge, cup.F_PSo_S) : kNaN;
}

}  // namespace snug::replay
