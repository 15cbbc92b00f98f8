// Insertion: the ways to bring a box to its place that what is beside it asks for.
#include "snug/skills/insertion.hpp"

#include <algorithm>
#include <cmath>

#include "snug/skills/primitives.hpp"

namespace snug::skills {
namespace {

/// What is beside a place along one axis of the container.
struct AxisView {
  double low = 1.0, high = 1.0;          ///< m, gaps
  double low_top = 0.0, high_top = 0.0;  ///< m, of the neighbours over the lower face
  [[nodiscard]] bool low_near(const settings::InsertionParams& params) const {
    return low < params.near && low_top > params.least_neighbour;
  }
  [[nodiscard]] bool high_near(const settings::InsertionParams& params) const {
    return high < params.near && high_top > params.least_neighbour;
  }
};

AxisView view(const packing::Candidate& candidate, int axis) {
  const auto low = static_cast<std::size_t>(2 * axis), high = low + 1;
  return {candidate.side_gap[low], candidate.side_gap[high], candidate.side_height[low], candidate.side_height[high]};
}

/// Straight down, away from neighbours on one side, then against them.
struct Approach {
  Insertion base;       ///< top-down or slide to contact
  int tight_axis = -1;  ///< with near neighbours on both sides; of two the tighter one
};

Approach approach_to(const packing::Candidate& candidate, const settings::InsertionParams& params) {
  Approach approach;
  Insertion& base = approach.base;
  int& tight_axis = approach.tight_axis;
  for (int axis = 0; axis < 2; ++axis) {
    const AxisView v = view(candidate, axis);
    if (v.low_near(params) && v.high_near(params)) {
      if (tight_axis < 0 || view(candidate, tight_axis).low + view(candidate, tight_axis).high > v.low + v.high) {
        tight_axis = axis;
      }
    } else if (v.low_near(params) && v.high > params.slide_room) {
      base.come_from_T[axis] = std::clamp(v.high - params.slide_margin, 0.0, params.slide_start);
      base.overtravel_T[axis] = -params.overtravel;
      base.skill = InsertionSkill::SlideToContact;
    } else if (v.high_near(params) && v.low > params.slide_room) {
      base.come_from_T[axis] = -std::clamp(v.low - params.slide_margin, 0.0, params.slide_start);
      base.overtravel_T[axis] = params.overtravel;
      base.skill = InsertionSkill::SlideToContact;
    }
  }
  return approach;
}

}  // namespace

const char* name_of(InsertionSkill skill) {
  switch (skill) {
    case InsertionSkill::TopDown:
      return "top-down";
    case InsertionSkill::SlideToContact:
      return "slide to contact";
    case InsertionSkill::Tilted:
      return "tilted";
    case InsertionSkill::SlideOnSupport:
      return "slide on support";
  }
  return "";
}

std::vector<Insertion> choose_insertions(const packing::Candidate& candidate, const Vector3& size,
                                         const settings::InsertionParams& params) {
  const auto [base, tight_axis] = approach_to(candidate, params);
  std::vector<Insertion> insertions{base};
  if (tight_axis >= 0) {
    const AxisView v = view(candidate, tight_axis);
    const double bottom = candidate.placement.X_TP.p.z() + lowest_corner(candidate.placement.X_TP.R, size);
    Insertion tilted = base;
    tilted.skill = InsertionSkill::Tilted;
    tilted.edge_height_T = bottom + std::min(v.low_top, v.high_top);
    const double low_side = v.low_top > v.high_top ? 1.0 : -1.0;
    tilted.low_side_T[tight_axis] = low_side;
    // A taller neighbour is what the box is pushed against; among equals the side that goes in first.
    const double taller = std::abs(v.low_top - v.high_top) > params.tilted.taller ? -low_side : low_side;
    tilted.push_T = base.overtravel_T;
    tilted.push_T[tight_axis] = taller * params.tilted.push;
    tilted.come_from_T[tight_axis] = -taller * params.tilted.push;
    insertions.push_back(tilted);
    tilted.low_side_T = -tilted.low_side_T;
    tilted.push_T[tight_axis] = -tilted.push_T[tight_axis];
    tilted.come_from_T[tight_axis] = -tilted.come_from_T[tight_axis];
    insertions.push_back(tilted);
  } else if (base.skill == InsertionSkill::SlideToContact) {
    Insertion gentle = base;
    gentle.overtravel_T *= params.gentle;
    gentle.gentle = true;
    insertions.push_back(gentle);
  }
  return insertions;
}

std::vector<Insertion> choose_insertions_on_support(const packing::Candidate& candidate,
                                                    const settings::InsertionParams& params) {
  Insertion one = approach_to(candidate, params).base;
  if (one.skill == InsertionSkill::SlideToContact) one.skill = InsertionSkill::SlideOnSupport;
  return {one};
}

}  // namespace snug::skills
