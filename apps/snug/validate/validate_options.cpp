// validate: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/validate/validate.hpp"

namespace snug::app {
namespace {

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
  CLI::App& verb = *app.add_subcommand("validate", "how far a simulation is from the measurements of its experiment");
  const auto options = std::make_shared<ValidateOptions>();
  verb.add_option("--simulated", options->simulated, "recording of the run")->required()->type_name("RECORDING.h5");
  verb.add_option("--measured", options->measured, "archive with the repetitions, or one log with names of mc_rtc")
      ->required()
      ->type_name("ARCHIVE.h5|LOG.csv");
  verb.add_option("-o,--output", options->page, "a page with all tables and the figures of the key moments")
      ->type_name("FILE.html");
  verb.add_option("--svg", options->svg, "folder for the figures of all boxes, poses and wrenches (made if needed)")
      ->type_name("FOLDER");
  verb.add_option("--csv", options->csv, "a row for each box, repetition and form")->type_name("FILE.csv");
  verb.add_option("--windows", options->windows,
                  "spans to compare, instead of those found: body,start_s,end_s[,sequence]")
      ->type_name("FILE.csv");
  verb.add_option("--shift", options->shifts,
                  "what a source's clock (mocap, ft, robot) shows at time 0 of the simulation, instead of finding it")
      ->type_name("SOURCE=SECONDS");
  verb.add_flag("--json", options->json, "print JSON instead of tables");
  verb.footer(kValidateHelp);
  verb.callback([options, &action] { action = [options] { return run_validate(*options); }; });
}

}  // namespace snug::app
