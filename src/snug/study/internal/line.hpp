// Line: JSON on one line, ending with a sum over the rest, so that a line cut short is known as such. Internal.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace snug::study::internal {

/// With the line's end.
[[nodiscard]] std::string with_sum(const nlohmann::ordered_json& json);
/// Of a line without its end; nothing for one that is not whole.
[[nodiscard]] std::optional<nlohmann::ordered_json> without_sum(const std::string& line);

}  // namespace snug::study::internal
