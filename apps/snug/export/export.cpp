// export: one function for each format.
#include "apps/snug/export/export.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <string_view>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/recorded_instant.hpp"
#include "apps/snug/common/robot_files.hpp"
#include "apps/snug/export/export_program.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/csv.hpp"
#include "snug/replay/glb_export.hpp"
#include "snug/replay/mcap_export.hpp"

namespace snug::app {
namespace {

int write_mcap(const ExportOptions& options, OutputFile output) {
  record::RecordingReader reader(options.input);
  const replay::McapTotals totals =
      replay::export_mcap(reader, file_name(options.input), options.selection, std::move(output),
                          {.compression = options.compression}, find_robot(reader, options.input, options.urdf));
  std::fprintf(stderr, "%s: %zu frames, %llu messages, %.2f MB\n", options.output.c_str(), totals.frames,
               static_cast<unsigned long long>(totals.messages), static_cast<double>(totals.bytes) / 1e6);
  return kSuccess;
}

int write_csv(const ExportOptions& options, OutputFile output) {
  record::RecordingReader reader(options.input);
  record::CsvWriter writer(std::move(output), reader.header());
  record::Frame frame;
  const std::vector<std::size_t> frames = replay::select_frames(reader, file_name(options.input), options.selection);
  for (const std::size_t index : frames) {
    reader.read_frame(index, frame);
    writer.append(frame);
  }
  writer.close();
  std::fprintf(stderr, "%s: %zu rows, %.3f s to %.3f s\n", options.output.c_str(), frames.size(),
               reader.times()[frames.front()], reader.times()[frames.back()]);
  return kSuccess;
}

int write_glb(const ExportOptions& options, OutputFile output) {
  record::RecordingReader reader(options.input);
  expect_recorded(reader, options.input, options.time);
  const replay::RobotDescription robot =
      options.is_load_only ? replay::RobotDescription{} : find_robot(reader, options.input, options.urdf);
  const replay::GlbTotals totals = replay::export_glb(reader, file_name(options.input),
                                                      {options.time, options.is_load_only}, std::move(output), robot);
  std::fprintf(stderr, "%s: %zu bodies at %.3f s, %zu triangles, %.2f MB\n", options.output.c_str(), totals.bodies,
               totals.time, totals.triangles, static_cast<double>(totals.bytes) / 1e6);
  return kSuccess;
}

constexpr std::array kFormats = {
    ExportFormat{"mcap", "a recording for Foxglove, Lichtblick and other viewers of MCAP", write_mcap},
    ExportFormat{"csv", "a recording as one table with the column names of mc_rtc logs", write_csv},
    ExportFormat{"glb", "an instant of a recording, or the load alone, as binary glTF for slides, Blender and viewers",
                 write_glb},
    ExportFormat{"urscript", "a program for the controller of a UR robot (no other); needs --scenario", write_urscript},
    ExportFormat{"ros-trajectory",
                 "a program as trajectory_msgs/JointTrajectory and times of the outputs, YAML; needs --scenario",
                 write_ros_trajectory},
    ExportFormat{"mc-rtc-csv", "a program through the joints as a log of mc_rtc, CSV; needs --scenario",
                 write_mc_rtc_csv},
    ExportFormat{"mc-rtc-flat", "the same in the columnar form that mc_log_ui reads", write_mc_rtc_flat},
};

}  // namespace

std::span<const ExportFormat> export_formats() { return kFormats; }

int run_export(const ExportOptions& options) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(), [&](const ExportFormat& format) {
    return std::string_view(format.name) == options.format;
  });
  SNUG_CHECK(found != kFormats.end(), "a format that the parser let pass");
  if (options.scenario.empty() && options.changes.any()) {
    throw InputError("command line", "--items, --container, --pallet", "without --scenario", "a scenario to change");
  }
  NamedFiles inputs = {{"the input", options.input}};
  add_file(inputs, "--urdf", options.urdf);
  if (!options.scenario.empty()) add_file(inputs, "--scenario", options.scenario);
  for (NamedFile& items : name_all("--items", options.changes.items)) inputs.push_back(std::move(items));
  return found->write(options, reserve(inputs, options.output));
}

}  // namespace snug::app
