// Sensors: what an experiment is measured with, read from YAML.
#include "snug/model/sensors.hpp"

#include "snug/core/read_file.hpp"
#include "snug/model/internal/fields.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::model {
namespace {

using internal::MapReader;
using internal::Value;

constexpr double kHighestRate = 10'000.0;  // Hz: beyond it a rate is taken for a slip
constexpr double kLongestOffset = 60.0;    // s: what synchronisation looks for

/// The settings of a sensor and what all sensors must keep to. `more`: keys that only this one has.
template <class Params>
void read_sensor(const Value& value, const std::string& kind, const std::vector<std::string>& more, Params& params) {
  const MapReader map = value.map(kind, internal::keys_with<Params>(more));
  internal::read_fields(map, params);
  if (params.rate > kHighestRate) map.require("rate").fail("a rate in Hz, at most 10000");
  if (params.clock.offset > kLongestOffset) map.require("clock").fail("an offset of at most 60 s");
  if (params.clock.rate_ppm > 1000.0) map.require("clock").fail("a rate_ppm of at most 1000");
}

Sensors read(const Value& root) {
  Sensors sensors;
  const MapReader map = root.map("sensors", {"motion_capture", "force_torque", "encoders"});
  if (const auto value = map.find("motion_capture")) {
    read_sensor(*value, "motion_capture", {"when_lost"}, sensors.motion_capture);
    const MapReader more = value->map("motion_capture", internal::keys_with<MotionCaptureParams>({"when_lost"}));
    if (const auto word = more.find("when_lost"))
      sensors.motion_capture.when_lost = word->choice({"missing", "held"}) == 0 ? WhenLost::Missing : WhenLost::Held;
  }
  if (const auto value = map.find("force_torque")) read_sensor(*value, "force_torque", {}, sensors.force_torque);
  if (const auto value = map.find("encoders")) read_sensor(*value, "encoders", {}, sensors.encoders);
  return sensors;
}

}  // namespace

Sensors load_sensors(const std::filesystem::path& path) {
  return parse_sensors(read_file(path, "a sensors file (YAML)", kLargestYaml), path.string());
}

Sensors parse_sensors(std::string_view text, std::string_view name) {
  internal::Document document{std::string(name), {}};
  check_yaml(text, name);
  try {
    return read(Value(YAML::Load(std::string(text)), "", document, 1));
  } catch (const YAML::Exception& error) {
    throw InputError(document.name + ":" + std::to_string(error.mark.line + 1), "", error.msg,
                     "YAML that can be parsed");
  }
}

}  // namespace snug::model
