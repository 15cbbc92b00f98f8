// RecordedRun: a plant's course once more, call by call, written to a recording: what was sent is known by then.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "snug/runs/run.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

namespace snug::simulated_plant {

struct RecordedRunOptions {
  OutputFile* file = nullptr;         ///< taken; not owned
  std::string version;                ///< for the recording
  std::vector<record::Event> events;  ///< what who packed has to say, ordered by time
  std::vector<std::string> warnings;  ///< of the result, by who packed
  bool is_interrupted = false;        ///< who packed was, and ended early
  std::string settings_json = "{}";
  std::function<std::string(const runs::RunResult&)> describe;  ///< JSON to keep in the recording, or none
};

/// The calls of a plant once more, on a new one of the same seed: it comes to the same state. `before`: called before
/// each; may be empty.
void repeat(SimulatedPlant& plant, const std::vector<Call>& calls, const std::function<void(const Call&)>& before = {});
/// The same on a new plant: it comes to the same state. Throws InputError for a recording that
/// cannot be written; OutputError when writing it fails.
runs::RunResult record(const model::Scenario& scenario, const std::string& sequence,
                       const SimulatedPlantOptions& options, const std::vector<Call>& calls,
                       const RecordedRunOptions& recorded);

}  // namespace snug::simulated_plant
