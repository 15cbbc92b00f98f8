// MotionTruth: how an item was really moved: hold of the cup, swing before contact, how much the joints were asked.
#pragma once

#include <limits>

#include "snug/cell/simulation.hpp"

namespace snug::simulated_plant {

/// Of all motions for one item, at the worst instant.
struct MotionTruth {
  /// cup::find_hold_factor; infinity: never held.
  double hold_factor = std::numeric_limits<double>::infinity();
  /// Amplitudes of the box in the tool's frame while the tool went straight down with it the last time, until it
  /// touched anything: half of what it moved, level, m, and turned, rad.
  double swing = 0.0, swing_angle = 0.0;
  /// Of any joint while it moves, as a share of what it may: of its speed (velocity_fraction of the limit) and of
  /// `max_joint_acceleration`, from tick to tick. 0 without joints. Brakes, which close when a motion is broken off, do
  /// not count.
  double joint_speed = 0.0, joint_acceleration = 0.0;
  bool operator==(const MotionTruth&) const = default;
};

/// Looks at a plant after each tick.
class MotionWitness {
 public:
  /// Another item is brought.
  void begin() { *this = {}; }
  /// The tool stands: the next motion begins from rest.
  void stand() { last_speed_.resize(0); }
  /// `row`: aimed at.
  void follow(const cell::Simulation& simulation, const cell::CellState& state, const cell::CellWorkspace& work,
              const motion::Waypoint& row, double dt);
  [[nodiscard]] const MotionTruth& truth() const { return truth_; }

 private:
  void follow_joints(const cell::Simulation& simulation, const cell::CellState& state, double dt);
  void follow_swing(const cell::Simulation& simulation, const cell::CellState& state, const cell::CellWorkspace& work,
                    const motion::Waypoint& row);

  MotionTruth truth_;
  robot::JointVector last_speed_;
  bool is_inserting_ = false, has_touched_ = false;
  Matrix3 R_EP_ = Matrix3::Identity();  ///< where the way in began
  Vector3 low_ = Vector3::Zero(), high_ = Vector3::Zero(), turn_low_ = Vector3::Zero(),
          turn_high_ = Vector3::Zero();  ///< in E
};

}  // namespace snug::simulated_plant
