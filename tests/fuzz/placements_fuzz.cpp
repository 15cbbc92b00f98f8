// Placements (YAML) for the boxes of a scenario.
#include "base_scenario.hpp"
#include "fuzz.hpp"
#include "snug/model/placements.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  snug::fuzz::expect_answer([&] {
    (void)snug::model::parse_placements(snug::fuzz::text_of(data, size), "x.yaml", snug::fuzz::base_scenario());
  });
  return 0;
}
