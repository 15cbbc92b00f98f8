// The demonstrator's cell, for the tests of this module.
#pragma once

#include <filesystem>

#include "snug/model/scenario.hpp"

namespace snug::cell {

inline const std::filesystem::path kSource = SNUG_SOURCE_DIR;

inline const model::Scenario& demonstrator() {
  static const model::Scenario scenario = model::load_scenario(kSource / "scenarios/box-demonstrator.yaml");
  return scenario;
}

}  // namespace snug::cell
