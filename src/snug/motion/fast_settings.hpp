// FastSettings: how our own programs move the tool, and what ends a motion or a wait: what is felt.
#pragma once

#include <limits>
#include <optional>

#include "snug/motion/paced_segment.hpp"

namespace snug::motion {

/// What the robot's sensors say. A controller that is told nothing waits and goes by time and place alone.
struct Sensed {
  double pressure_gauge = 0.0;        ///< Pa, in the cup; vacuum is negative
  Vector3 force_W = Vector3::Zero();  ///< N, on the tool, from what it carries and touches
  /// How many times what it has to the cup could hold; infinity: nothing is held, or not known.
  double hold_factor = std::numeric_limits<double>::infinity();
  bool operator==(const Sensed&) const = default;
};

/// Settings of FastTracking. Speeds count at tempo 1.
struct FastSettings {
  /// Rows that touch nothing, the cup empty. The joints limit the speed too.
  Pace empty = {2.0, 10.0, 4.0, 20.0, 0.06};
  /// The same with a box: averaged over a window in which most boxes swing a whole number of times (3 to 8 Hz).
  Pace held = {2.0, 5.0, 4.0, 12.0, 0.25};
  /// The same of boxes that are hard to turn.
  Pace held_gently = {2.0, 5.0, 2.5, 6.0, 0.25, 0.0, 1.0};
  /// A held box on its way in (Place). Straight down, half of the motion comes later by half the period of its slow
  /// swing. Other rows that touch something have the scenario's limits for their names.
  Pace insert = {0.9, 4.0, 1.5, 3.0, 0.10};
  /// The empty cup off a box that it let go, blowing: faster, the bellows would draw air in and the box with them.
  Pace detach = {0.4, 4.0, 1.0, 3.0, 0.04};
  /// m: so far a box that is lifted by its side swings at most when it leaves what it stood on. It tilts about its far
  /// edge until the cup carries it; then it has the lift's speed, which is 2 pi / (slow period) times this.
  double lift_swing = 0.015;
  /// Ways that touch nothing go around it (Way). None: straight.
  std::optional<PanAxis> pan_axis;
  double contact_window = 0.05;  ///< s, of those others
  double blend = 0.05;        ///< m, and 1 m per `convergence_deg_per_metre`: so near to a row the next one may begin
  double level_blend = 0.15;  ///< m, the same where neither way goes up or down: nothing is met by a short cut
  double feel_within = 0.02;  ///< m, before a row's end: what is felt earlier is not what was meant
  double pick_force = 30.0;   ///< N, against the motion: a pick is pressed
  double press_force = 40.0;  ///< N: a held box stands on something
  double push_force = 25.0;   ///< N: a held box leans on its neighbour (PlaceSlow)
  double felt_hold = 3.0;     ///< Sensed::hold_factor below which a held box meets something, too
  /// The same of a box that is heavy for its cup: this fraction of the factor at the start of the motion.
  double felt_hold_share = 0.7;
  double sealed_pressure = -std::numeric_limits<double>::infinity();  ///< Pa, gauge: the box may be lifted
  /// Pa, gauge: the same of a box that is carried at a pace below 1. It hangs from all of the vacuum.
  double fully_sealed_pressure = -std::numeric_limits<double>::infinity();
  double released_pressure = std::numeric_limits<double>::infinity();  ///< Pa, gauge: the tool may leave the box
  bool operator==(const FastSettings&) const = default;
};

}  // namespace snug::motion
