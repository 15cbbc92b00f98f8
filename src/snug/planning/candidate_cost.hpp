// CandidateCost: what a place is worth, less what it costs to turn the box for it.
#pragma once

#include <optional>
#include <vector>

#include "snug/planning/grasp.hpp"
#include "snug/planning/scene.hpp"

namespace snug::planning {

/// A box that stands somewhere, to be brought to a place.
struct StandingBox {
  model::ItemIndex item;
  Pose X_WP;
  Location location = Location::Aligner;
};

/// How the grasp begins that is tried first; none: it cannot be picked so. The tool does not pass over the item
/// `without`: the box itself, or one that stands where it will arrive.
[[nodiscard]] std::optional<GraspOutline> outline_of(const Scene& scene, const StandingBox& box,
                                                     const packing::Orientation& orientation, model::ItemIndex without);
/// Percent of the container that turning the box for a place costs; 0 of motions with a lag.
[[nodiscard]] double cost_of(const Scene& scene, const StandingBox& box, const packing::Placement& placement);
/// Percent filled in the end, on average, when this fraction of the worlds goes well and the others end with what is in
/// the container now, less what turning the box costs.
[[nodiscard]] double utility_of(const Scene& scene, const packing::Candidate& candidate, double success_rate,
                                double cost);
/// By utility, were they certain, the largest first. Of motions with a lag they stay in the agent's order.
void sort_by_utility(const Scene& scene, const StandingBox& box, std::vector<packing::Candidate>& candidates);

}  // namespace snug::planning
