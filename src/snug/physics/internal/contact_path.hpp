// Contact path: where a contact that lasts goes within the step, so that arms are those of its middle and its end.
#pragma once

#include "snug/physics/internal/scratch.hpp"

namespace snug::physics::internal {

/// Contacts of bodies that turn by less than 1e-7 rad in the step stay where they are.
[[nodiscard]] inline bool turns_within(double dt, const Vector3& angular) { return dt * angular.norm() > 1e-7; }

/// rad/s, about an axis in the plane of a contact: from there on a body rocks.
inline constexpr double kRocks = 0.01;

/// Arms of one contact from the centres of mass of its bodies, m, W.
struct ContactArms {
  Vector3 a_mid, a_end, b_mid, b_end;
};

/// Whether points of contact move along the surface of the geom while its body turns. `geom`: of WorldModel::geoms.
[[nodiscard]] bool is_round(const WorldModel& model, std::uint32_t geom);

/// Whether the arms of a contact are those of the middle and the end of the step, as where motion is smooth: it bore in
/// the step before and neither closes nor opens fast, between a body that the solver moves and one that it does not,
/// and something round rolls, something rides on what turns, or a lone body rocks. Elsewhere the arms of the start
/// serve.
[[nodiscard]] bool follows_path(const WorldModel& model, const WorldState& state, const Scratch& work,
                                const Patch& patch, const Contact& contact);
[[nodiscard]] ContactArms arms_of(const WorldModel& model, const WorldState& state, const Scratch& work,
                                  const Patch& patch, const Contact& contact);

}  // namespace snug::physics::internal
