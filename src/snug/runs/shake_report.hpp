// What became of a load that was shaken, for people and programs; the load of a recording.
#pragma once

#include <string>

#include "snug/runs/shake.hpp"

namespace snug::runs {

/// A load and the scenario it is of.
struct RecordedLoad {
  model::Scenario scenario;
  std::vector<model::PlacementEntry> boxes;
};

/// What lies in the target in the last frame of a recording. Throws InputError for one without frames, scenario,
/// container or load.
[[nodiscard]] RecordedLoad load_recorded(const std::string& path);

/// What was asked, as people say it.
struct ShakeWords {
  std::string load, profile, hold;
  double tilt_deg = 6.0;  ///< allowed
};

/// One sentence.
[[nodiscard]] std::string shake_verdict(const ShakeResult& result, const ShakeWords& words);
/// A line for each motion, with the friction with which it went worst.
[[nodiscard]] std::string format_shake_text(const ShakeResult& result, const ShakeWords& words);
[[nodiscard]] std::string format_shake_json(const ShakeResult& result, const ShakeWords& words);
/// A page with the worst moment, from above and from the side.
[[nodiscard]] std::string format_shake_page(const ShakeResult& result, const ShakeWords& words);

}  // namespace snug::runs
