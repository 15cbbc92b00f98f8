// export: what snug has in its own formats, for other programs.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/replay/mcap_writer.hpp"
#include "snug/replay/replay.hpp"
#include "snug/runs/robot_export.hpp"

namespace snug::app {

struct ExportOptions {
  std::string input;   ///< a recording, or what else the format is made from
  std::string format;  ///< name in export_formats()
  std::string output;
  replay::Selection selection;
  std::string compression = "zstd";   ///< or none
  std::string encoding = "protobuf";  ///< or json
  std::optional<std::string> urdf;    ///< of the robot in a recording; absent: looked for
  std::optional<double> time;         ///< s, of one instant; absent: the end
  bool is_load_only = false;          ///< the container and the boxes in it
  // of programs
  std::string scenario;  ///< its robot, limits and gains
  ScenarioChanges changes;
  std::string sequence;              ///< whose gain; empty: the first
  std::string corrections = "none";  ///< layer of the scenario
  MotionWords motion;                ///< absent: as the program was packed
  double period = 0.04;              ///< s, between the points of a trajectory
  bool is_unchecked = false;         ///< not simulated before it is written
  control::UrScriptOptions script;
  runs::StandardWiring wiring;  ///< of urscript, instead of what the scenario says
  std::string from_box;         ///< id; empty: the program's first
};

/// Programs, for the controllers of real robots.
[[nodiscard]] int write_urscript(const ExportOptions& options, OutputFile output);
[[nodiscard]] int write_ros_trajectory(const ExportOptions& options, OutputFile output);
[[nodiscard]] int write_mc_rtc_csv(const ExportOptions& options, OutputFile output);
[[nodiscard]] int write_mc_rtc_flat(const ExportOptions& options, OutputFile output);

}  // namespace snug::app
