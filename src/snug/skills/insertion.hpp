// Insertion: the ways to bring a box to its place that what is beside it asks for.
#pragma once

#include <vector>

#include "snug/packing/placement.hpp"
#include "snug/settings/skill_params.hpp"

namespace snug::skills {

/// How a box is brought to its place.
enum class InsertionSkill {
  TopDown,         ///< straight down
  SlideToContact,  ///< beside its place, then pushed against its neighbours
  Tilted,          ///< one side first, levelled while it is pushed
  SlideOnSupport,  ///< set down beside its place, then pushed while what is below carries it
};
[[nodiscard]] const char* name_of(InsertionSkill skill);

/// A skill and how much of it.
struct Insertion {
  InsertionSkill skill = InsertionSkill::TopDown;
  Vector3 come_from_T = Vector3::Zero();   ///< m
  Vector3 overtravel_T = Vector3::Zero();  ///< m
  Vector3 low_side_T = Vector3::Zero();    ///< Tilted: unit
  Vector3 push_T = Vector3::Zero();        ///< Tilted: m
  double edge_height_T = 0.0;              ///< Tilted: m
  bool gentle = false;
};
/// Insertions worth trying for a candidate, the most promising first; never empty.
[[nodiscard]] std::vector<Insertion> choose_insertions(const packing::Candidate& candidate, const Vector3& size,
                                                       const settings::InsertionParams& params);
/// The same for a box that is heavy for its cup: nothing beside it is touched while it hangs from the cup alone.
/// Never empty.
[[nodiscard]] std::vector<Insertion> choose_insertions_on_support(const packing::Candidate& candidate,
                                                                  const settings::InsertionParams& params);

}  // namespace snug::skills
