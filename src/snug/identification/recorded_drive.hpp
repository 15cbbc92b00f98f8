// RecordedDrive: how a recorded run was driven: the tool's path, the vacuum's switch, boxes that came.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/motion/tool_path.hpp"
#include "snug/record/archive.hpp"
#include "snug/validation/measurement.hpp"

namespace snug::identification {

struct RecordedDrive {
  /// A box that came to stand where the tool picked it from.
  struct Arrival {
    std::string parcel;
    double time = 0.0;  ///< s
    Pose X_WP;          ///< measured
    bool operator==(const Arrival&) const = default;
  };
  double tick = 0.0;                    ///< s
  std::vector<motion::ToolState> tool;  ///< at 0, tick, 2 tick ..
  std::vector<bool> vacuum, blow_off;   ///< throughout the tick that ends there
  std::vector<Arrival> arrivals;        ///< in order of time
  bool operator==(const RecordedDrive&) const = default;
};

/// Whether a recording holds what a drive is made of: the tool's poses and the outputs of the robot's controller.
[[nodiscard]] bool has_drive(const record::ArchiveRecording& recording);

/// What the robot's log tells as a simulated run with these parcels, that nothing was seen of: what the other sources'
/// clocks are brought to. Time 0 is the log's first sample. Needs has_drive.
[[nodiscard]] validation::SimulatedRun run_of_log(const record::ArchiveRecording& recording,
                                                  const std::vector<std::string>& parcels);

/// `measured`: the same recording on the clock of run_of_log. Poses between samples are those of cubics through the
/// seven nearest ones (least squares: noise of single samples would shake the load). A switch acts within a tick of
/// where the log has it: bit 0 of `actual_digital_output_bits` is the vacuum, bit 1 the blow-off.
[[nodiscard]] RecordedDrive make_drive(const record::ArchiveRecording& recording, const validation::SimulatedRun& run,
                                       const validation::Measurement& measured, double tick);

}  // namespace snug::identification
