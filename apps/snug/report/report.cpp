// report: recordings as one HTML file that opens anywhere.
#include "apps/snug/report/report.hpp"

#include <cstdio>
#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/robot_files.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {

int run_report(const ReportOptions& options) {
  if (options.recordings.size() > 2) {
    throw InputError("command line", "recordings", std::to_string(options.recordings.size()) + " of them",
                     "one, or one and another to lay over it");
  }
  NamedFiles inputs = name_all("a recording", options.recordings);
  add_file(inputs, "--urdf", options.urdf);
  OutputFile output = reserve(inputs, options.output);
  const std::string_view page = viewer_page();
  std::vector<report::PageRecording> recordings;
  for (const std::string& path : options.recordings) {
    record::RecordingReader reader(path);
    const std::string name = std::filesystem::path(path).filename().string();
    const replay::RobotDescription robot = find_robot(reader, path, options.urdf);
    recordings.push_back({name, replay::encode_recording(reader, name, options.selection, robot)});
  }
  const std::string html = report::assemble_page(page, recordings);
  write_file(std::move(output), html);
  std::fprintf(stderr, "%s: %.2f MB\n", options.output.c_str(), static_cast<double>(html.size()) / 1e6);
  return kSuccess;
}

}  // namespace snug::app
