// Candidate, NoPlace: what was decided, and words for the reasons.
#include "snug/packing/placement.hpp"

#include <algorithm>
#include <utility>

#include "snug/core/check.hpp"

namespace snug::packing {

ContainerState with_candidate(ContainerState state, const Item& item, const Candidate& candidate) {
  state.boxes.push_back({item, candidate.placement.X_TP});
  if (candidate.rearranged.empty()) return state;
  std::vector<PlacedBox> anew;
  for (const Placement& placement : candidate.rearranged) {
    const auto box = std::find_if(state.boxes.begin(), state.boxes.end(),
                                  [&](const PlacedBox& known) { return known.item.id == placement.item; });
    SNUG_CHECK(box != state.boxes.end(), "a re-arrangement names a box that is not there");
    anew.push_back({box->item, placement.X_TP});
  }
  state.boxes = std::move(anew);
  return state;
}

bool stands_free(const Candidate& candidate) {
  constexpr double kFree = 0.004;  // m
  const auto room = [&](Side low, Side high) {
    return std::max(candidate.side_gap[static_cast<std::size_t>(low)],
                    candidate.side_gap[static_cast<std::size_t>(high)]);
  };
  return room(Side::LowX, Side::HighX) >= kFree && room(Side::LowY, Side::HighY) >= kFree;
}

bool is_infeasible(NoPlace reason) {
  return reason == NoPlace::TooBig || reason == NoPlace::TooHeavy || reason == NoPlace::NotPickable;
}

std::string_view describe(NoPlace reason) {
  switch (reason) {
    case NoPlace::TooBig:
      return "too big for the container";
    case NoPlace::TooHeavy:
      return "too heavy to be carried (max_item_mass)";
    case NoPlace::NotPickable:
      return "no face that the cup can hold";
    case NoPlace::NoSpace:
      return "no space left";
    case NoPlace::NoStablePlace:
      return "no place where it stands";
    case NoPlace::OverLoad:
      return "only places on boxes that must not carry it";
    case NoPlace::NotReachable:
      return "no place within reach";
  }
  return "no reason";
}

}  // namespace snug::packing
