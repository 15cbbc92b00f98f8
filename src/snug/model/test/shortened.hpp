// The demonstrator's cell with few items, for the tests of modules that pack it.
#pragma once

#include <cstddef>

#include "snug/model/scenario.hpp"

namespace snug::model::test {

/// With the first `count` items of its first sequence.
inline Scenario shortened(std::size_t count) {
  Scenario scenario = load_scenario(SNUG_SOURCE_DIR "/scenarios/box-demonstrator.yaml");
  scenario.sequences.front().items.resize(count);
  return scenario;
}

}  // namespace snug::model::test
