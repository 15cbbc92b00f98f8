// measure: a virtual experiment: a simulation becomes measurements with stated sensors.
#include "apps/snug/command_line/verbs.hpp"

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/validation/measure.hpp"

namespace snug::app {
namespace {

struct MeasureOptions {
  std::vector<std::string> recordings;
  std::string sensors;
  std::string output;
  std::optional<std::string> truth;  ///< JSON file for what was drawn
  std::string date = "20000101T000000Z";
  std::uint64_t seed = 1;
  int repetitions = 1;
};

using Json = nlohmann::ordered_json;

int run_measure(const MeasureOptions& options) {
  if (options.recordings.size() > 1 && options.repetitions > 1)
    throw InputError("command line", "--repetitions", "several recordings", "one recording: each is a repetition");
  NamedFiles inputs = name_all("a recording", options.recordings), outputs = {{"-o", options.output}};
  inputs.push_back({"--sensors", options.sensors});
  add_file(outputs, "--truth", options.truth);
  expect_distinct(inputs, outputs);
  OutputFile archive(options.output);
  std::optional<OutputFile> truth_file = reserve(options.truth);
  const model::Sensors sensors = model::load_sensors(options.sensors);
  validation::MeasureOptions settings;
  settings.seed = options.seed;
  settings.date = options.date;
  settings.repetitions =
      options.recordings.size() > 1 ? static_cast<int>(options.recordings.size()) : options.repetitions;
  record::ArchiveWriter writer(std::move(archive));
  Json truth = {{"seed", options.seed}, {"repetitions", Json::array()}};
  std::string sequence;
  for (std::size_t i = 0; i < options.recordings.size(); ++i) {
    const validation::SimulatedRun run = validation::load_run(options.recordings[i]);
    if (i == 0) sequence = run.header.sequence;
    if (run.header.sequence != sequence)
      throw InputError(options.recordings[i], "", "sequence '" + run.header.sequence + "'",
                       "that of the first recording, '" + sequence + "'");
    for (int k = 0; k < options.repetitions; ++k) {
      settings.repetition = static_cast<int>(i) + k + 1;
      const validation::VirtualMeasurement measured = validation::measure(run, sensors, settings);
      writer.add(measured.recording);
      truth["repetitions"].push_back(Json::parse(validation::format_json(measured.truth, measured.recording.name)));
    }
  }
  writer.close();
  if (truth_file) write_file(std::move(*truth_file), truth.dump(2) + "\n");
  return kSuccess;
}

constexpr const char* kMeasureHelp =
    R"(The archive has the layout of the demonstrator's (docs/formats.md): poses of motion capture with noise, losses and a frame
of its own, wrenches with bias and drift, encoders; each source on a clock of its own. Several recordings become one
repetition each; --repetitions measures one recording that often, with noise, losses and clocks drawn anew.
Examples:
  snug measure run.h5 --sensors scenarios/sensors/demonstrator.yaml -o measured.h5 --repetitions 3
  snug measure run.h5 again.h5 --sensors scenarios/sensors/demonstrator.yaml --seed 7 -o two.h5 --truth truth.json)";

}  // namespace

void add_measure(CLI::App& app, Action& action) {
  const Verb verb(app, action, "measure", "make a virtual experiment: what sensors would have measured in a simulation",
                  kMeasureHelp);
  MeasureOptions& options = verb.runs(run_measure);
  verb.option("recordings", options.recordings, "RECORDING.h5", "recordings of runs, each a repetition").required();
  verb.option("--sensors", options.sensors, "SENSORS.yaml", "rates, noise, losses and clocks").required();
  verb.option("-o,--output", options.output, "FILE.h5", "the archive to write").required();
  verb.option("--repetitions", options.repetitions, "N", "repetitions of each recording", whole(1, 100));
  verb.option("--seed", options.seed, "N", "seed of noise, losses, clocks and frames", whole(0));
  verb.option("--date", options.date, "YYYYMMDDTHHMMSSZ",
              "date in the name of the first repetition; the next ones are 20 minutes apart");
  verb.option("--truth", options.truth, "FILE.json", "write what was drawn: clocks, bias, frames, losses");
}

}  // namespace snug::app
