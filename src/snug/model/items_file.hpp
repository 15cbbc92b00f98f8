// ItemsFile: boxes and the orders in which they come, from files of other people, added to a scenario.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/model/scenario.hpp"

namespace snug::model {

/// A line of an order: `count` equal boxes. The third edge stands upright as the box arrives.
struct OrderLine {
  std::string order;                      ///< which order (or file) it belongs to
  std::string article;                    ///< what it is
  Vector3 size = Vector3::Constant(0.1);  ///< m: length, width, height
  double mass = 1.0;                      ///< kg
  int count = 1;
  Handling handling;
  int line = 0;  ///< in the file, from 1; 0: not from a file
  bool operator==(const OrderLine&) const = default;
};

/// Reads a CSV with a header (docs/formats.md, orders), or orders in the BED-BPP form (JSON); by the ending of the
/// name. Throws InputError with file and line for anything else.
[[nodiscard]] std::vector<OrderLine> load_orders(const std::filesystem::path& path);
[[nodiscard]] std::vector<OrderLine> parse_orders_csv(std::string_view text, const std::string& name);
[[nodiscard]] std::vector<OrderLine> parse_orders_json(std::string_view text, const std::string& name);

/// Adds the boxes of orders as parcels (uniform density, surface of the scenario's first parcel) and each order as a
/// sequence of its name; the scenario's text then holds them too. They may be too large for the target container.
/// Throws InputError for a scenario without parcels (whose material could be used), for names that are taken or cannot
/// be written, and for boxes smaller than parcel_clearance.
void add_orders(Scenario& scenario, const std::vector<OrderLine>& lines, const std::string& name);

/// Adds what a file holds: .csv and .json as orders; .yaml as `parcel_types`, `parcels` and `sequences` written as in a
/// scenario.
void add_items(Scenario& scenario, const std::filesystem::path& path);
/// The last of these from a text called `name`.
void add_items_yaml(Scenario& scenario, const std::string& text, const std::string& name);

}  // namespace snug::model
