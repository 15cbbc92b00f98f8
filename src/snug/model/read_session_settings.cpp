// Reading by what rules boxes are packed: skills, limits, settings of sessions.
#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"

namespace snug::model::internal {
namespace {

void check(const Value& at, const SkillParams& skills) {
  if (!(skills.pivot.dragged <= skills.pivot.drag))
    at.fail("pivot.dragged " + to_text(skills.pivot.dragged), "no more than pivot.drag");
  if (!(skills.travel.shortest_swing <= skills.travel.longest_swing))
    at.fail("travel.shortest_swing " + to_text(skills.travel.shortest_swing), "no more than travel.longest_swing");
  if (!(skills.travel.near_base <= skills.travel.base_radius))
    at.fail("travel.near_base " + to_text(skills.travel.near_base), "no more than travel.base_radius");
}

void check(const Value& at, const RehearsalSettings& rehearsal) {
  if (!(rehearsal.least_rate <= rehearsal.good_rate && rehearsal.good_rate <= rehearsal.accepted_rate))
    at.fail("rates in another order", "least_rate <= good_rate <= accepted_rate");
  if (!(rehearsal.max_attempts <= rehearsal.most_attempts))
    at.fail("max_attempts " + std::to_string(rehearsal.max_attempts), "no more than most_attempts");
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
