// plot: quantities of a recording as an SVG for papers.
#include "apps/snug/command_line/verbs.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/replay/plot.hpp"
#include "snug/replay/replay.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {
namespace {

struct PlotOptions {
  std::vector<std::string> recordings;  ///< one, or one and a second to lay over it
  std::vector<std::string> what;
  std::string output;
  double width_mm = 180.0;
  double height_mm = 45.0;          ///< of each pair of axes
  std::optional<std::string> urdf;  ///< of the robot in them, for limits; absent: looked for
  replay::Selection selection;
};

int run_plot(const PlotOptions& options) {
  expect_one_or_two(options.recordings);
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

constexpr const char* kPlotExamples = R"(Examples:
  snug plot run.h5 --what wrench -o wrench.svg
  snug plot run.h5 --what limits -o limits.svg
  snug plot run.h5 --what pose:BOX027 --from 2 --to 20 -o box.svg
  snug plot run.h5 again.h5 --what tool --what speed --width 85 -o compare.svg)";

}  // namespace

void add_plot(CLI::App& app, Action& action) {
  const Verb verb(app, action, "plot", "draw quantities of a recording over time as SVG", kPlotExamples);
  PlotOptions& options = verb.runs(run_plot);
  verb.option("recordings", options.recordings, "FILE.h5", "a recording, and optionally another to overlay (dashed)")
      .required();
  verb.option("--what", options.what, "WORD",
              "wrench (of the cup), flange (wrench on it), tool (position), error (to the command), speed, cup (length "
              "and bend), deformation (pose of the lip), vacuum, contacts, solver, joints (of a robot), limits (used "
              "of the joints' and of the hold), pose:BODY; several are drawn one below the other")
      .required();
  verb.option("-o,--output", options.output, "FILE.svg", "the drawing to write").required();
  verb.option("--width", options.width_mm, "MM", "width of the drawing; one column of a paper is about 85", positive());
  verb.option("--height", options.height_mm, "MM", "height of each pair of axes", positive());
  verb.option("--urdf", options.urdf, "FILE.urdf",
              "arm whose joint limits are used (default: the file that the scenario names)");
  add_selection(verb, options.selection);
}

}  // namespace snug::app
