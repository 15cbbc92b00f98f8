// find_contradiction: orders that pairs of settings keep.
#include "snug/settings/contradiction.hpp"

#include <fmt/format.h>

namespace snug::settings {
namespace {

/// "key value" where `value` is larger than `most`, or no number.
std::optional<Contradiction> find_larger(const char* key, double value, const char* most_key, double most) {
  if (value <= most) return std::nullopt;
  return Contradiction{fmt::format("{} {}", key, value), fmt::format("no more than {}", most_key)};
}

}  // namespace

std::optional<Contradiction> find_contradiction(const SkillParams& skills) {
  if (auto found = find_larger("pivot.dragged", skills.pivot.dragged, "pivot.drag", skills.pivot.drag)) return found;
  if (auto found = find_larger("travel.shortest_swing", skills.travel.shortest_swing, "travel.longest_swing",
                               skills.travel.longest_swing)) {
    return found;
  }
  return find_larger("travel.near_base", skills.travel.near_base, "travel.base_radius", skills.travel.base_radius);
}

std::optional<Contradiction> find_contradiction(const RehearsalSettings& rehearsal) {
  if (!(rehearsal.least_rate <= rehearsal.good_rate && rehearsal.good_rate <= rehearsal.accepted_rate)) {
    return Contradiction{"rates in another order", "least_rate <= good_rate <= accepted_rate"};
  }
  return find_larger("max_attempts", rehearsal.max_attempts, "most_attempts", rehearsal.most_attempts);
}

}  // namespace snug::settings
