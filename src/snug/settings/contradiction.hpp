// find_contradiction: settings whose values lie in their ranges and do not go together.
#pragma once

#include <optional>
#include <string>

#include "snug/settings/session_settings.hpp"
#include "snug/settings/skill_params.hpp"

namespace snug::settings {

struct Contradiction {
  std::string got;       ///< key and value, "pivot.dragged 0.4"
  std::string expected;  ///< "no more than pivot.drag"
};

/// The first that there is.
[[nodiscard]] std::optional<Contradiction> find_contradiction(const SkillParams& skills);
[[nodiscard]] std::optional<Contradiction> find_contradiction(const RehearsalSettings& rehearsal);

}  // namespace snug::settings
