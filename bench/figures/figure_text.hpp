// Figures as text: a table for people, JSON for programs and back.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/figures/bench.hpp"

namespace snug::bench {

/// {"results": [...], "settings": {...}}: the figures and the solver's settings, which are those of every scenario.
[[nodiscard]] std::string format_json(const std::vector<Figure>& figures);
/// Of one of `results`. Throws nlohmann::json::exception for what is none; a value of null is no number.
[[nodiscard]] Figure read_figure(const nlohmann::ordered_json& json);
[[nodiscard]] std::string format_table(const std::vector<Figure>& figures);

}  // namespace snug::bench
