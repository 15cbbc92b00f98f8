// measure: a virtual experiment: what sensors would have recorded of a simulated run.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "snug/model/sensors.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/simulated_run.hpp"

namespace snug::validation {

/// Names that the demonstrator's archives use for what is not a box.
inline constexpr const char* kBaseBody = "Base005";           ///< robot base: W
inline constexpr const char* kContainerBody = "Tote001";      ///< T
inline constexpr const char* kToolBody = "FittingCollar001";  ///< E
inline constexpr const char* kLipBody = "SuctionCup004";      ///< S

struct MeasureOptions {
  std::uint64_t seed = 1;
  int repetition = 1;                     ///< from 1; draws noise and clocks anew, but not the bodies' frames
  int repetitions = 1;                    ///< of how many, for the note
  std::string date = "20000101T000000Z";  ///< of the first repetition; each next one is 20 minutes later
};

/// What was drawn: what a tool that reads the archive should find.
struct ClockTruth {
  double offset = 0.0;  ///< s: the source's clock at time 0 of the simulation
  double rate = 0.0;    ///< 1: its seconds per second of the simulation, less 1
};
struct MeasureTruth {
  ClockTruth motion_capture, force_torque, encoders;
  Wrench bias;                           ///< of the force/torque sensor at its first sample
  Pose X_MW;                             ///< W in the frame of motion capture
  std::vector<std::string> lost_bodies;  ///< those that are lost deep in the container
};

struct VirtualMeasurement {
  record::ArchiveRecording recording;
  MeasureTruth truth;
};

/// Times, noise and losses come from the seed, the repetition and the names of the bodies alone: the same input makes
/// the same numbers, and another body changes nothing for the rest. Throws InputError for a date of another form.
[[nodiscard]] VirtualMeasurement measure(const SimulatedRun& run, const model::Sensors& sensors,
                                         const MeasureOptions& options);

/// What was drawn for the recording `name`: clocks, bias, frame, lost bodies.
[[nodiscard]] std::string format_json(const MeasureTruth& truth, const std::string& name);

}  // namespace snug::validation
