// Representatives: a few boxes that stand for many real ones, and sequences of them: report sections 3.1.1, 3.1.2.
#pragma once

#include <string>
#include <vector>

#include "snug/core/rng.hpp"
#include "snug/model/items_file.hpp"

namespace snug::packing {

/// A box that stands for others of nearly its size and mass.
struct Representative {
  Vector3 size = Vector3::Zero();  ///< m, longest edge first: means of its boxes
  double mass = 0.0;               ///< kg, mean
  int boxes = 0;                   ///< how many it stands for
  bool operator==(const Representative&) const = default;
};

struct Reduction {
  std::vector<Representative> representatives;  ///< the most frequent first
  int groups = 0;                               ///< before only the most frequent were kept
  int boxes = 0;
  double covered_percent = 0.0;  ///< of all boxes: each edge within `cover_tolerance` of one of the representatives
  bool operator==(const Reduction&) const = default;
};

struct ReductionSettings {
  int count = 4;                 ///< representatives wanted
  double group_tolerance = 0.1;  ///< boxes join a group when each edge and the mass differ by at most this share
  double cover_tolerance = 0.2;
};

/// Groups boxes of nearly equal size (edges sorted) and mass, most frequent first, and keeps the largest groups.
/// Throws InputError for settings out of range.
[[nodiscard]] Reduction reduce_items(const std::vector<model::OrderLine>& lines, const ReductionSettings& settings);

/// Draws boxes of the scenario, each at most once and equally likely, as few as reach `fill_percent` of the container;
/// with probability `repeat` the next is one of the same type as the last, as in real orders. All stand with Z up
/// unless `any_side_up`. With `all` it goes on until every box is taken. Throws InputError when all boxes together do
/// not reach the filling.
struct SequenceSettings {
  double fill_percent = 90.0;
  double repeat = 0.4;
  bool any_side_up = false;
  bool all = false;
};
[[nodiscard]] model::Sequence draw_sequence(const model::Scenario& scenario, const std::string& name,
                                            const SequenceSettings& settings, Rng rng);
/// Every box of the scenario in an order drawn by seed and name. Throws InputError where a sequence has this name.
[[nodiscard]] model::Sequence draw_order(const model::Scenario& scenario, const std::string& name, std::uint64_t seed);

}  // namespace snug::packing
