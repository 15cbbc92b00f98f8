// The demonstrator's cell at the tick of a CB3 controller, for tests.
#pragma once

#include <filesystem>

#include "snug/cell/simulation.hpp"

namespace snug::served_ur::test {

inline const cell::Simulation& demonstrator_cell() {
  static const cell::Simulation simulation(
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml"), "1",
      {motion::LaggedTracking{}, cup::CupMode::Phases, "ur10"});
  return simulation;
}

}  // namespace snug::served_ur::test
