// Typical orders: boxes drawn by a seed as parcels of the trade are, to begin with where there are no orders yet.
#include "snug/model/typical_orders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::model {
namespace {

/// Outer sizes, mm.
constexpr std::array<std::array<int, 3>, 10> kFoldingBoxes = {{{120, 100, 60},
                                                               {150, 100, 70},
                                                               {160, 120, 80},
                                                               {180, 130, 90},
                                                               {200, 150, 90},
                                                               {200, 150, 120},
                                                               {220, 160, 100},
                                                               {250, 175, 100},
                                                               {250, 200, 120},
                                                               {300, 200, 120}}};
constexpr double kLightest = 120.0, kHeaviest = 350.0;  // kg/m^3, of packed goods
constexpr double kLeastMass = 0.05;                     // kg

void require_count(const char* key, int count, int most) {
  if (count < 1 || count > most)
    throw InputError("typical orders", key, std::to_string(count), "1 to " + std::to_string(most));
}

}  // namespace

std::string draw_typical_orders(const TypicalOrders& wanted) {
  require_count("orders", wanted.orders, kMostTypicalOrders);
  require_count("boxes", wanted.boxes, kMostTypicalBoxes);
  const Rng seeded(wanted.seed);
  Rng densities = seeded.split("typical densities"), draws = seeded.split("typical orders");
  std::array<double, kFoldingBoxes.size()> masses{};
  for (std::size_t i = 0; i < masses.size(); ++i) {
    const auto& [length, width, height] = kFoldingBoxes[i];
    masses[i] = std::max(kLeastMass, 1e-9 * length * width * height * densities.uniform(kLightest, kHeaviest));
  }
  std::string text = "order,article,length_mm,width_mm,height_mm,mass_kg,count\n";
  for (int order = 1; order <= wanted.orders; ++order) {
    const long count = std::max(1L, std::lround(wanted.boxes * draws.uniform(2.0 / 3.0, 4.0 / 3.0)));
    std::array<int, kFoldingBoxes.size()> counts{};
    for (long i = 0; i < count; ++i) {
      const double u = draws.uniform();
      ++counts[static_cast<std::size_t>(static_cast<double>(kFoldingBoxes.size()) * u * std::sqrt(u))];
    }
    for (std::size_t i = 0; i < counts.size(); ++i) {
      const auto& [length, width, height] = kFoldingBoxes[i];
      if (counts[i] > 0)
        text += fmt::format("order-{},box-{}x{}x{},{},{},{},{:.2f},{}\n", order, length, width, height, length, width,
                            height, masses[i], counts[i]);
    }
  }
  return text;
}

}  // namespace snug::model
