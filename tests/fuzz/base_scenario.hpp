// A small scenario that other files refer to: boxes, a container, a sequence.
#pragma once

#include "snug/model/scenario.hpp"

namespace snug::fuzz {

inline const model::Scenario& base_scenario() {
  static const model::Scenario scenario =
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "tests/fuzz/seeds/scenario/cell.yaml");
  return scenario;
}

}  // namespace snug::fuzz
