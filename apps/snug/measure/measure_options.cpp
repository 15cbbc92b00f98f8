// measure: what may be said after the verb.
#include <CLI/CLI.hpp>
#include <memory>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/measure/measure.hpp"

namespace snug::app {
namespace {

constexpr const char* kMeasureHelp =
    R"(The archive has the layout of the demonstrator's (docs/formats.md): poses of motion capture with noise, losses and a frame
of its own, wrenches with bias and drift, encoders; each source on a clock of its own. Several recordings become one
repetition each; --repetitions measures one recording that often, with noise, losses and clocks drawn anew.
Examples:
  snug measure run.h5 --sensors scenarios/sensors/demonstrator.yaml -o measured.h5 --repetitions 3
  snug measure run.h5 again.h5 --sensors scenarios/sensors/demonstrator.yaml --seed 7 -o two.h5 --truth truth.json)";

}  // namespace

void add_measure(CLI::App& app, Action& action) {
  CLI::App& verb = *app.add_subcommand("measure", "a virtual experiment: what sensors would have seen of a simulation");
  const auto options = std::make_shared<MeasureOptions>();
  verb.add_option("recordings", options->recordings, "recordings of runs, each a repetition")
      ->required()
      ->type_name("RECORDING.h5");
  verb.add_option("--sensors", options->sensors, "rates, noise, losses and clocks")
      ->required()
      ->type_name("SENSORS.yaml");
  verb.add_option("-o,--output", options->output, "the archive to write")->required()->type_name("FILE.h5");
  verb.add_option("--repetitions", options->repetitions, "of one recording")
      ->check(whole(1, 100))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--seed", options->seed, "of noise, losses, clocks and frames")
      ->check(whole(0))
      ->type_name("N")
      ->capture_default_str();
  verb.add_option("--date", options->date, "of the first repetition, for its name; the next ones are 20 minutes apart")
      ->type_name("YYYYMMDDTHHMMSSZ")
      ->capture_default_str();
  verb.add_option("--truth", options->truth, "a file for what was drawn: clocks, bias, frames, losses")
      ->type_name("FILE.json");
  verb.footer(kMeasureHelp);
  verb.callback([options, &action] { action = [options] { return run_measure(*options); }; });
}

}  // namespace snug::app
