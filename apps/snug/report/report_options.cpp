// report: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/report/report.hpp"

namespace snug::app {
namespace {

constexpr const char* kReportExamples = R"(Examples:
  snug report run.h5 -o run.html
  snug report run.h5 again.h5 -o both.html       # the second is laid over the first
  snug report run.h5 -o part.html --from 10 --to 20)";

}  // namespace

void add_selection_options(CLI::App& verb, replay::Selection& selection) {
  verb.add_option("--from", selection.from, "leave out what was before this time")
      ->check(finite())
      ->type_name("SECONDS");
  verb.add_option("--to", selection.to, "leave out what was after this time")->check(finite())->type_name("SECONDS");
  verb.add_option("--every", selection.every,
                  "take every Nth frame only (default: all; in a page as many as it can hold)")
      ->check(whole(1, kMostThings))
      ->type_name("N");
}

void add_report(CLI::App& app, Action& action) {
  CLI::App& verb =
      *app.add_subcommand("report", "make one HTML file of a recording: replay, events of each box, plots");
  const auto options = std::make_shared<ReportOptions>();
  verb.add_option("recordings", options->recordings, "a recording, and another one to lay over it")
      ->required()
      ->type_name("FILE.h5");
  verb.add_option("-o,--output", options->output, "the page to write")->required()->type_name("FILE.html");
  add_selection_options(verb, options->selection);
  verb.add_option("--urdf", options->urdf, "how the robot in it looks (default: the file that its scenario names)")
      ->type_name("FILE.urdf");
  verb.footer(kReportExamples);
  verb.callback([options, &action] { action = [options] { return run_report(*options); }; });
}

}  // namespace snug::app
