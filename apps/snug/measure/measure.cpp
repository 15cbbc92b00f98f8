// measure: a virtual experiment: a simulation becomes measurements with stated sensors.
#include "apps/snug/measure/measure.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/validation/measure.hpp"

namespace snug::app {
namespace {

using Json = nlohmann::ordered_json;

Json clock_as_json(const validation::ClockTruth& clock) {
  return {{"offset_s", clock.offset}, {"rate_ppm", 1e6 * clock.rate}};
}

Json truth_as_json(const std::string& name, const validation::MeasureTruth& truth) {
  const Vector6 bias = as_vector(truth.bias);
  const Quaternion quat(truth.X_MW.R);
  return {{"name", name},
          {"clocks",
           {{"motion_capture", clock_as_json(truth.motion_capture)},
            {"force_torque", clock_as_json(truth.force_torque)},
            {"encoders", clock_as_json(truth.encoders)}}},
          {"bias", {{"force_N", {bias[0], bias[1], bias[2]}}, {"torque_Nm", {bias[3], bias[4], bias[5]}}}},
          {"X_MW",
           {{"p", {truth.X_MW.p.x(), truth.X_MW.p.y(), truth.X_MW.p.z()}},
            {"quat_wxyz", {quat.w(), quat.x(), quat.y(), quat.z()}}}},
          {"lost_bodies", truth.lost_bodies}};
}

}  // namespace

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
      truth["repetitions"].push_back(truth_as_json(measured.recording.name, measured.truth));
    }
  }
  writer.close();
  if (truth_file) write_file(std::move(*truth_file), truth.dump(2) + "\n");
  return kSuccess;
}

}  // namespace snug::app
