// DecisionList: what a session decided, item by item: candidates, why others lost, predicted against what happened.
#pragma once

#include <string>
#include <string_view>

namespace snug::workspace {

/// JSON of a log of events (`snug pack --log`), as far as it goes: docs/ui-interface.md has its keys. A last line that
/// is broken off is left out. Throws InputError with `name:line` for others that are no events.
[[nodiscard]] std::string format_decisions(std::string_view log, const std::string& name);

}  // namespace snug::workspace
