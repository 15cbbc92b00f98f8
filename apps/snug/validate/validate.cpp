// validate: a simulation beside the measurements of its experiment.
#include "apps/snug/command_line/verbs.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "snug/core/write_file.hpp"
#include "snug/validation/page.hpp"

namespace snug::app {
namespace {

struct ValidateOptions {
  std::string simulated, measured;
  std::optional<std::string> page, svg, csv, windows;
  std::vector<std::string> shifts;  ///< "SOURCE=SECONDS"
  bool json = false;
};

void write_figures(const std::string& folder, const std::vector<validation::NamedFigure>& figures) {
  for (const validation::NamedFigure& figure : figures)
    write_file(std::filesystem::path(folder) / figure.file, report::draw_svg(figure.figure));
}

int run_validate(const ValidateOptions& options) {
  NamedFiles inputs = {{"--simulated", options.simulated}, {"--measured", options.measured}}, outputs;
  add_file(inputs, "--windows", options.windows);
  add_file(outputs, "-o", options.page);
  add_file(outputs, "--csv", options.csv);
  expect_distinct(inputs, outputs);
  std::optional<OutputFile> csv = reserve(options.csv), page = reserve(options.page);
  if (options.svg) make_folder("--svg", *options.svg);
  const validation::HandShifts shifts = validation::parse_hand_shifts(options.shifts);
  const validation::SimulatedRun run = validation::load_run(options.simulated);
  std::vector<validation::Window> windows;
  if (options.windows) windows = validation::load_windows(*options.windows, run);
  const validation::Validation result =
      validation::validate(run, validation::load_repetitions(options.measured, run, shifts), windows);
  if (options.svg) {
    write_figures(*options.svg, validation::make_figures(run, result, false));
    write_figures(*options.svg, validation::make_figures(run, result, true));
  }
  if (csv) write_file(std::move(*csv), validation::as_csv(result));
  if (page) write_file(std::move(*page), validation::make_page(run, result));
  print(options.json ? validation::as_json(result) : validation::as_text(result));
  return kSuccess;
}

constexpr const char* kValidateHelp =
    R"(The four criteria of the report's section 4.4.1: execution, rest poses (its Table 4), poses over the motion (Table 5),
wrenches (Table 6), and the key moments of Table 3; repetitions together. Each in two forms: clean (geodesic angle, nothing
dropped, lost markers counted) and report (the demonstrator's rules). Clocks are found by cross-correlation over all bodies.
Examples:
  snug validate --simulated run.h5 --measured measured.h5 -o validation.html
  snug validate --simulated run.h5 --measured measured.h5 --svg figures --csv errors.csv --json
  snug export run.h5 --format csv -o log.csv
  snug validate --simulated run.h5 --measured log.csv --shift mocap=0.35 --windows scenarios/sensors/report-windows.csv)";

}  // namespace

void add_validate(CLI::App& app, Action& action) {
  const Verb verb(app, action, "validate", "compare a simulation with the measurements of its experiment",
                  kValidateHelp);
  ValidateOptions& options = verb.runs(run_validate);
  verb.option("--simulated", options.simulated, "RECORDING.h5", "recording of the run").required();
  verb.option("--measured", options.measured, "ARCHIVE.h5|LOG.csv",
              "archive with the repetitions, or one log with names of mc_rtc")
      .required();
  verb.option("-o,--output", options.page, "FILE.html",
              "write a page with all tables and the figures of the key moments");
  verb.option("--svg", options.svg, "FOLDER",
              "write the figures of all boxes, poses and wrenches into this folder (created if missing)");
  verb.option("--csv", options.csv, "FILE.csv", "write a row for each box, repetition and form");
  verb.option("--windows", options.windows, "FILE.csv",
              "time spans to compare, instead of those found: body,start_s,end_s[,sequence]");
  verb.option(
      "--shift", options.shifts, "SOURCE=SECONDS",
      "time that the clock of a source (mocap, ft, robot) shows at time 0 of the simulation, instead of finding it");
  add_json(verb, options.json);
}

}  // namespace snug::app
