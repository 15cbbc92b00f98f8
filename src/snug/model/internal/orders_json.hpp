// read_orders_json: orders in the JSON form of BED-BPP, read as a stream, so that each complaint has its line.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "snug/model/items_file.hpp"

namespace snug::model::internal {

/// Bounds of what an order may ask for, whatever form it has.
inline constexpr double kShortestMm = 1.0;
inline constexpr double kLongestMm = 1e5;
inline constexpr double kLightest = 1e-3;  ///< kg
inline constexpr double kHeaviest = 1e5;   ///< kg
inline constexpr std::size_t kMostBoxes = 100'000;

/// {"ORDER": {"item_sequence": {"1": {"length/mm": ...}}}}: orders by name, items by number; other keys are skipped.
[[nodiscard]] std::vector<OrderLine> read_orders_json(std::string_view text, const std::string& name);

}  // namespace snug::model::internal
