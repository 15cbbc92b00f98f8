// What became of a program in a simulator elsewhere, as text: a table for people, JSON for programs.
#include "snug/remote_plant/program_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::remote_plant {

std::string format_json(const ProgramClientResult& result) {
  nlohmann::ordered_json document = {{"duration_s", result.duration},
                                     {"simulated_s", result.simulated},
                                     {"wall_s", result.wall},
                                     {"real_time_factor", result.simulated / result.wall},
                                     {"ticks", result.ticks},
                                     {"row", result.row},
                                     {"objects", nlohmann::ordered_json::object()}};
  for (const auto& [name, object] : result.last.objects) {
    for (const click::SensorValue& value : object.object) {
      if (value.type != click::ValueType::Position) continue;
      document["objects"][name] = {{"position_m", {value.vector.x(), value.vector.y(), value.vector.z()}}};
    }
  }
  document["failure"] = result.failure;
  return document.dump(2) + "\n";
}

std::string format_table(const ProgramClientResult& result) {
  constexpr double kMm = 1e3;
  std::string text = fmt::format("{:<16} {:>9} {:>9} {:>9}\n", "object", "x_W mm", "y_W mm", "z_W mm");
  for (const auto& [name, object] : result.last.objects) {
    for (const click::SensorValue& value : object.object) {
      if (value.type != click::ValueType::Position) continue;
      const Vector3 p = kMm * value.vector;
      text += fmt::format("{:<16} {:>9.2f} {:>9.2f} {:>9.2f}\n", printable(name, 100), p.x(), p.y(), p.z());
    }
  }
  text += fmt::format("\nprogram            {:.2f} s, {} ticks in {:.2f} s, real-time factor {:.0f}\n", result.duration,
                      result.ticks, result.wall, result.simulated / result.wall);
  if (!result.failure.empty())
    text += fmt::format("failed             toward waypoint {}: {}\n", result.row + 1,
                        printable(result.failure, kLongestMessage));
  return text;
}

}  // namespace snug::remote_plant
