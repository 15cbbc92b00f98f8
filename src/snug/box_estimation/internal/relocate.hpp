// relocate: boxes that are not where they were believed to be, all of them together.
#pragma once

#include <optional>

#include "snug/box_estimation/internal/search.hpp"

namespace snug::box_estimation::internal {

struct Lost {
  Wanted box;
  double gone = 1.0;  ///< of the points that tell whether it is where it was believed to be, those behind it
  bool is_seen_in_place = false;      ///< something as high as it is seen where it was believed to be
  std::optional<TrackedBox> tracked;  ///< where it is if it is what was taken for it
};

struct Place {
  std::size_t lost = 0;  ///< index into the list
  TrackedBox box;
  double gain = 0.0;  ///< px, that agree with the frame because it is there; beliefs and sizes count as pixels too
};

/// Poses for lost boxes, at most one each, that explain the frame best together.
[[nodiscard]] std::vector<Place> relocate(const Known& known, const std::vector<Lost>& lost);

/// Of places that do not exclude each other (one for each box, solids apart), those with the largest sum of gains.
[[nodiscard]] std::vector<Place> best_together(const std::vector<Place>& places, std::size_t lost,
                                               const RelocationSettings& settings);

}  // namespace snug::box_estimation::internal
