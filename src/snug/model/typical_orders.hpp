// Typical orders: boxes drawn by a seed as parcels of the trade are, to begin with where there are no orders yet.
#pragma once

#include <cstdint>
#include <string>

namespace snug::model {

inline constexpr int kMostTypicalOrders = 100;
inline constexpr int kMostTypicalBoxes = 200;  ///< of an order, on average

struct TypicalOrders {
  int orders = 3;
  int boxes = 20;  ///< of an order, on average: a third more or less
  std::uint64_t seed = 1;
};

/// A CSV as parse_orders_csv() reads it: orders `order-1`, `order-2`, ... of ten sizes of folding boxes that shops
/// stock (assumed, none is a standard; smaller ones are more frequent), each article with one mass at 120 to 350
/// kg/m^3. The same on every machine. Throws InputError for numbers that are less than 1 or more than the most.
[[nodiscard]] std::string draw_typical_orders(const TypicalOrders& wanted);

}  // namespace snug::model
