// Measurement: one repetition of an experiment on the clock and in the frame of the simulation it is compared with.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/record/archive.hpp"
#include "snug/validation/clock.hpp"
#include "snug/validation/simulated_run.hpp"

namespace snug::validation {

/// Shifts given by hand, s: what a source's clock shows at time 0 of the simulation.
struct HandShifts {
  std::optional<double> motion_capture, force_torque, robot;
};

/// Of words SOURCE=SECONDS, a source being mocap, ft or robot. Throws InputError with the nearest name.
[[nodiscard]] HandShifts parse_hand_shifts(const std::vector<std::string>& words);

/// How one source's clock was found, or why it was not.
struct SourceClock {
  std::string source;  ///< "motion capture", "force/torque", "robot"
  std::optional<ClockFit> fit;
  std::string failure;  ///< empty when there is a fit
};

struct Measurement {
  std::string name;  ///< of the recording
  std::string note;
  std::vector<SourceClock> clocks;  ///< of the sources that were recorded
  std::vector<double> pose_times;   ///< s, simulation's clock
  /// Standard errors, each axis, of the pose of the robot base that poses were brought into W by; 0 without one.
  double base_position_error = 0.0;  ///< m
  double base_rotation_error = 0.0;  ///< rad
  /// X_WB by body of the simulation's header, as long as `pose_times`; empty where the body was not measured.
  std::vector<std::vector<record::PoseSample>> bodies;
  std::vector<double> wrench_times;  ///< s, simulation's clock; empty when there is no clock for them
  std::vector<Wrench> wrenches;      ///< without `bias`
  Wrench bias;                       ///< median of measured less simulated while the cup holds nothing
  [[nodiscard]] bool has_poses() const { return !pose_times.empty(); }
};

/// Poses are brought into W by the mean pose of the robot base where the recording has one (interfaces: all motion
/// capture poses are multiplied by its inverse), and taken to be in W otherwise. Throws InputError, naming `where`,
/// when no body of the recording is one of the simulation's, and for a base that is lost all along.
[[nodiscard]] Measurement align(const SimulatedRun& run, const record::ArchiveRecording& recording,
                                const HandShifts& shifts, const std::string& where);

}  // namespace snug::validation
