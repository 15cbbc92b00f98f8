// items: few boxes that stand for many real ones, and sequences of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"
#include "snug/model/items_sheet.hpp"
#include "snug/model/typical_orders.hpp"

namespace snug::app {

struct ItemsReduceOptions {
  std::string orders;
  int count = 4;
  double group_percent = 10.0;
  double cover_percent = 20.0;
  bool json = false;
  std::optional<std::string> output;
};

struct ItemsSequenceOptions {
  std::string scenario;
  std::optional<std::string> types;  ///< file with parcel types: new boxes of these, as many as it takes
  std::string name = "drawn";
  int sequences = 1;
  double fill_percent = 90.0;
  double repeat = 0.4;
  bool any_side_up = false;
  bool all = false;  ///< every box of the scenario once
  std::uint64_t seed = 1;
  std::optional<std::string> output;
};

struct ItemsReadOptions {
  std::string sheet;
  model::SheetAnswers answers;
  std::optional<std::string> output;
};

struct ItemsDrawOptions {
  model::TypicalOrders wanted;
  std::optional<std::string> output;
};

void add_items(CLI::App& app, Action& action);
[[nodiscard]] int run_items_draw(const ItemsDrawOptions& options);
[[nodiscard]] int run_items_read(const ItemsReadOptions& options);
[[nodiscard]] int run_items_reduce(const ItemsReduceOptions& options);
[[nodiscard]] int run_items_sequence(const ItemsSequenceOptions& options);

}  // namespace snug::app
