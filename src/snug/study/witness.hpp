// Witness: who knows where the boxes of any plant are, so that a session can be scored by it.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/study/trial.hpp"

namespace snug::study {

/// One for each item of the sequence; nothing of those that are not in the cell.
using TruePoses = std::vector<std::optional<Pose>>;

struct Witness {
  std::vector<std::string> items;
  std::function<TruePoses()> poses;
  std::function<Vector3(std::size_t item)> size_of;  ///< m, as it collides
  std::function<std::vector<cell::BoxResult>()> boxes;
  std::function<simulated_plant::MotionTruth()> motion;  ///< of the item brought last; may be empty
  std::function<std::uint64_t()> hash;                   ///< of the plant's state; may be empty
};

/// What is true of a simulated plant, which outlives it.
[[nodiscard]] Witness truth_of(const simulated_plant::SimulatedPlant& plant);

/// A session with any plant, scored by what the witness says: after each item and at the end. Throws InputError as
/// session::pack.
[[nodiscard]] Trial run_trial(const model::Scenario& scenario, const std::string& sequence,
                              const session::SessionOptions& session, plant::Plant& plant, const Witness& witness,
                              const TrialProgress& progress = {});
/// The same with files: a recording of what the plant says (RecordedPlant), the program that it is sent.
[[nodiscard]] Trial run_trial(const model::Scenario& scenario, const std::string& sequence,
                              const session::SessionOptions& session, plant::Plant& plant, const Witness& witness,
                              const TrialProgress& progress, const TrialFiles& files);

}  // namespace snug::study
