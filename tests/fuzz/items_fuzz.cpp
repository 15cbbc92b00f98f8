// Orders (CSV, JSON) and items (YAML), by the first byte: what they add to a scenario can be written down and read
// again.
#include "base_scenario.hpp"
#include "fuzz.hpp"
#include "snug/model/items_file.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  if (size == 0) return 0;
  const std::string text(fuzz::text_of(data + 1, size - 1));
  model::Scenario scenario = fuzz::base_scenario();
  const std::size_t before = scenario.parcels.size();
  bool is_added = false;
  fuzz::expect_answer([&] {
    switch (data[0]) {
      case 'c':
        model::add_orders(scenario, model::parse_orders_csv(text, "x.csv"), "x.csv");
        break;
      case 'j':
        model::add_orders(scenario, model::parse_orders_json(text, "x.json"), "x.json");
        break;
      default:
        model::add_items_yaml(scenario, text, "x.yaml");
    }
    is_added = true;
  });
  // Few at a time: what is written down is a thousand times as slow to read as the line that asks for it.
  if (!is_added || scenario.parcels.size() > before + 200) return 0;
  const model::Scenario again = model::parse_scenario(scenario.source_text, "written down");
  SNUG_CHECK(again.parcels == scenario.parcels && again.sequences == scenario.sequences, "the same boxes");
  return 0;
}
