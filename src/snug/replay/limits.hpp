// Limits: how much of what a robot's joints and the hold of the cup allow a recorded run used.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/model/cup_params.hpp"
#include "snug/record/recording.hpp"

namespace snug::replay {

/// Limits that the joints of a run were driven with, base to tool.
struct JointUseLimits {
  std::vector<double> speed;   ///< rad/s (m/s): of the URDF, times the velocity_fraction of robot and controller
  std::vector<double> torque;  ///< Nm (N), of the URDF; infinity where it does not know
  double acceleration = 0.0;   ///< rad/s^2 (m/s^2): the scenario's max_joint_acceleration
};

/// None without a robot, its URDF (the text of it) or a scenario that this version reads, and where a joint of the run
/// has no limit there.
[[nodiscard]] std::optional<JointUseLimits> joint_limits_of(const record::RecordingHeader& header,
                                                            const std::string& urdf);

/// Follows a recording from frame to frame.
class HoldUse {
 public:
  explicit HoldUse(const record::RecordingHeader& header);
  /// Part of what the vacuum and the friction of the lip could carry that the hold of this frame uses, 1 / factor of
  /// cup::find_hold_factor: 1 is where the cup lets go. NaN while nothing is held or the vacuum is off, until it is
  /// established (cup::kEstablishedVacuum), and without a scenario that this version reads.
  [[nodiscard]] double next(const record::Frame& frame);

 private:
  std::optional<model::CupParams> params_;
  bool is_established_ = false;
};

}  // namespace snug::replay
