// watched_boxes: a session in a cell that is elsewhere, scored by what an observer says of its boxes.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/perception/perception.hpp"
#include "snug/study/witness.hpp"

namespace snug::study {

/// What an observer says, for each item of the sequence.
struct BoxSource {
  std::function<std::vector<std::optional<perception::SceneBox>>()> boxes;  ///< nothing of those that are not there
  std::function<Vector3(std::size_t item)> size_of;                         ///< m
  std::function<bool(std::size_t item)> was_brought;
};

/// Follows the boxes: what was never seen away from where it came is waiting. The scenario outlives the witness.
[[nodiscard]] Witness watch_boxes(const model::Scenario& scenario, const std::string& sequence, BoxSource source);

}  // namespace snug::study
