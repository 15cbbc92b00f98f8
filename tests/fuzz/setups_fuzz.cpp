// What is told of an experiment: tasks of identification, sensors and studies (YAML), by the first byte.
#include "fuzz.hpp"
#include "snug/model/scene_task.hpp"
#include "snug/model/sensors.hpp"
#include "snug/study/design.hpp"
#include "snug/study/table.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  fuzz::expect_answer(data, size, [](char kind, const std::string& text) {
    switch (kind) {
      case 't':
        (void)model::parse_scene_task(text, std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/tosses/task.yaml");
        break;
      case 's':
        (void)model::parse_sensors(text, "x.yaml");
        break;
      case 'r':
        (void)study::parse_line(text);
        break;
      default:
        (void)study::parse_study(text, std::string(SNUG_SOURCE_DIR) + "/scenarios/x.yaml");
    }
  });
  return 0;
}
