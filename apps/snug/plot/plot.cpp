// plot: quantities of a recording as an SVG for papers.
#include "apps/snug/plot/plot.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/robot_files.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/replay/plot.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {

int run_plot(const PlotOptions& options) {
  if (options.recordings.size() > 2) {
    throw InputError("command line", "recordings", std::to_string(options.recordings.size()) + " of them",
                     "one, or one and another to lay over it");
  }
  if (options.width_mm < 40.0 || options.width_mm > 2000.0 || options.height_mm < 10.0 || options.height_mm > 2000.0) {
    throw InputError("command line", "--width, --height", "a drawing that nobody could read",
                     "40 to 2000 mm wide, 10 to 2000 mm high");
  }
  NamedFiles inputs = name_all("a recording", options.recordings);
  add_file(inputs, "--urdf", options.urdf);
  OutputFile output = reserve(inputs, options.output);
  std::vector<record::RecordingReader> readers;
  std::vector<replay::PlotSource> sources;
  readers.reserve(options.recordings.size());
  for (const std::string& path : options.recordings) {
    readers.emplace_back(path);
    sources.push_back({std::filesystem::path(path).filename().string(), &readers.back(), ""});
    if (std::ranges::find(options.what, "limits") != options.what.end()) {
      sources.back().urdf = find_robot(readers.back(), path, options.urdf).urdf;
    }
  }
  report::Figure figure = replay::make_plot(sources, options.what, options.selection);
  figure.width_mm = options.width_mm;
  figure.panel_height_mm = options.height_mm;
  write_file(std::move(output), report::draw_svg(figure));
  std::fprintf(stderr, "%s: %zu panels over %s, %.0f mm wide\n", options.output.c_str(), figure.panels.size(),
               options.recordings.size() > 1 ? "two recordings" : "one recording", figure.width_mm);
  return kSuccess;
}

}  // namespace snug::app
