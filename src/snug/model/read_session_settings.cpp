// Reading by what rules boxes are packed: skills, limits, settings of sessions.
#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/settings/contradiction.hpp"

namespace snug::model::internal {
namespace {

template <class Settings>
void check(const Value& at, const Settings& read) {
  if (const auto found = settings::find_contradiction(read)) at.fail(found->got, found->expected);
}

}  // namespace

void ScenarioReader::read_session_settings(const MapReader& map) {
  const auto read = [&map](const char* key, auto& settings) {
    const auto value = map.find(key);
    if (value) read_fields(*value, key, settings);
    return value;
  };
  if (const auto value = read("skills", scenario_.skills)) check(*value, scenario_.skills);
  (void)read("packing", scenario_.packing);
  (void)read("place_limits", scenario_.place_limits);
  if (const auto value = read("rehearsal", scenario_.rehearsal)) check(*value, scenario_.rehearsal);
  (void)read("belief", scenario_.belief);
  (void)read("recovery", scenario_.recovery);
  (void)read("motion_guards", scenario_.motion_guards);
}

}  // namespace snug::model::internal
