// The demonstrator's cell, for the tests of this module.
#pragma once

#include "snug/model/scenario.hpp"

namespace snug::planning {

inline const model::Scenario& demonstrator() {
  static const model::Scenario scenario = model::load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  return scenario;
}

}  // namespace snug::planning
