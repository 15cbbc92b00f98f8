// SimulatedRun: what of a recording can be measured, as columns over time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "snug/record/archive.hpp"
#include "snug/record/recording.hpp"

namespace snug::validation {

/// The clock of a simulated run is the simulation's; everything is in W.
struct SimulatedRun {
  std::string name;  ///< file name
  record::RecordingHeader header;
  std::vector<double> times;                             ///< s, strictly increasing
  std::vector<std::vector<record::PoseSample>> bodies;   ///< X_WB by body of the header; lost where it is absent
  std::vector<record::PoseSample> tool;                  ///< X_WE
  std::vector<record::PoseSample> lip;                   ///< X_WS
  std::vector<Twist> tool_twist;                         ///< V_WE in W
  std::vector<Wrench> wrench;                            ///< on the flange, in F
  std::vector<int> attached;                             ///< body that the cup holds, or -1
  std::vector<std::uint8_t> vacuum;                      ///< command, 0 or 1
  std::vector<std::uint8_t> blow_off;                    ///< the same; empty: never
  std::vector<std::vector<record::JointSample>> joints;  ///< by joint of the header
  std::vector<record::Event> events;
  std::string result;  ///< JSON, or empty
};

/// Throws InputError for a file that is no whole recording, and for one of less than two frames.
[[nodiscard]] SimulatedRun load_run(const std::filesystem::path& path);
/// The same of a recording in memory.
[[nodiscard]] SimulatedRun make_run(const record::Recording& recording, const std::string& name);

/// Indices of the bodies that are boxes to be packed: dynamic and of a type. All dynamic ones where none has a type.
[[nodiscard]] std::vector<std::size_t> find_boxes(const record::RecordingHeader& header);

/// Walks through samples at instants that grow, and says what is between two of them: positions on a line, rotations on
/// the shortest turn. Between a sample and a lost one, and outside of the samples, the body is lost.
class PoseCursor {
 public:
  PoseCursor(const std::vector<double>& times, const std::vector<record::PoseSample>& poses)
      : times_(times), poses_(poses) {}
  /// `longest_gap`, s: two samples further apart than this have nothing between them.
  [[nodiscard]] record::PoseSample at(double time, double longest_gap);

 private:
  const std::vector<double>& times_;
  const std::vector<record::PoseSample>& poses_;
  std::size_t next_ = 0;  ///< first sample after the last instant asked for
};

}  // namespace snug::validation
