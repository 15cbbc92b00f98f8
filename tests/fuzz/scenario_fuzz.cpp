// Scenarios (YAML): read, and read again from the text that goes into recordings.
#include "fuzz.hpp"
#include "snug/model/scenario.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  snug::fuzz::expect_answer([&] {
    const snug::model::Scenario scenario = snug::model::parse_scenario(snug::fuzz::text_of(data, size), "x.yaml");
    SNUG_CHECK(snug::is_utf8(scenario.name) && snug::is_utf8(scenario.source_text), "names in UTF-8");
  });
  return 0;
}
