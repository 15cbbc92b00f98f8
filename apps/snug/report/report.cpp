// report: recordings as one HTML file that opens anywhere.
#include "apps/snug/command_line/verbs.hpp"

#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/core/write_file.hpp"
#include "snug/replay/replay.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {
namespace {

struct ReportOptions {
  std::vector<std::string> recordings;  ///< one, or one and a second to lay over it
  std::string output;
  replay::Selection selection;
  std::optional<std::string> urdf;  ///< of the robot in it; absent: looked for
};

int run_report(const ReportOptions& options) {
  expect_one_or_two(options.recordings);
  NamedFiles inputs = name_all("a recording", options.recordings);
  add_file(inputs, "--urdf", options.urdf);
  OutputFile output = reserve(inputs, options.output);
  const std::string_view page = viewer_page();
  const std::string html =
      report::assemble_page(page, encode_recordings(options.recordings, options.selection, options.urdf));
  write_file(std::move(output), html);
  std::fprintf(stderr, "%s: %.2f MB\n", options.output.c_str(), static_cast<double>(html.size()) / 1e6);
  return kSuccess;
}

constexpr const char* kReportExamples = R"(Examples:
  snug report run.h5 -o run.html
  snug report run.h5 again.h5 -o both.html       # the second is laid over the first
  snug report run.h5 -o part.html --from 10 --to 20)";

}  // namespace

void add_report(CLI::App& app, Action& action) {
  const Verb verb(app, action, "report", "write one HTML file from a recording: replay, events of each box, plots",
                  kReportExamples);
  ReportOptions& options = verb.runs(run_report);
  verb.option("recordings", options.recordings, "FILE.h5", "a recording, and optionally another to overlay").required();
  verb.option("-o,--output", options.output, "FILE.html", "the page to write").required();
  add_selection(verb, options.selection);
  add_urdf(verb, options.urdf);
}

}  // namespace snug::app
