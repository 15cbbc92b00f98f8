// The page of a search for places: what was found, with a map of the best.
#pragma once

#include <string>

#include "snug/runs/cell_place.hpp"

namespace snug::runs {

[[nodiscard]] std::string make_place_page(const model::Scenario& scenario, const PlaceSearch& search,
                                          const PlaceOptions& options);

}  // namespace snug::runs
