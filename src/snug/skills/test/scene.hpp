// A box of the demonstrator on its way: what hangs where, and scenes seen from elsewhere, for the tests of this module.
#pragma once

#include <gtest/gtest.h>

#include "snug/core/rng.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/cup/statics.hpp"
#include "snug/packing/item.hpp"
#include "snug/skills/item_plan.hpp"
#include "snug/skills/test/demonstrator.hpp"

namespace snug::skills {

/// BOX027, with its centre of mass there.
inline PlannedBox box_with(const Vector3& com) {
  PlannedBox box;
  box.id = "BOX027";
  box.size = Vector3(0.170, 0.234, 0.094);
  box.inertia = model::find_parcel(demonstrator(), box.id)->inertia;
  box.inertia.com = com;
  return box;
}

inline Matrix3 about_vertical(double angle) { return exp_rotation(Vector3(0.0, 0.0, angle)); }

/// Standing on any of its faces, turned by `yaw`.
inline Matrix3 standing(Rng& rng, double yaw) {
  const model::UpAxis ups[] = {model::UpAxis::X, model::UpAxis::Y, model::UpAxis::Z};
  const packing::Orientation orientation{ups[rng.index(3)], rng.index(2) == 0 ? 1 : -1, rng.index(4)};
  return about_vertical(yaw) * packing::rotation(orientation);
}

/// The lip on a box that was picked by a tool there, pressed to `length`.
inline Pose lip_on(const Pose& X_WP, const Pose& X_WE, double length) {
  return X_WP.inverse() * X_WE * Pose{Matrix3::Identity(), Vector3(0.0, 0.0, length)};
}

/// Where the box comes to rest under a tool that stands still.
inline Pose hung(const PlannedBox& box, const Pose& X_PS, const Pose& X_WE) {
  const model::CupParams& cup = demonstrator().cup;
  cup::HeldLoad load;
  load.R_WE = X_WE.R;
  load.mass = box.inertia.mass;
  load.p_SScm = X_PS.inverse() * box.inertia.com;
  load.stiffness = cup::as_matrix(cup.stiffness);
  load.X_ES2.p.z() = cup.hold_length - cup.centre_from_lip;
  load.X_SS1.p.z() = -cup.centre_from_lip;
  const cup::SettleResult result = cup::settle(load);
  EXPECT_EQ(result.status, cup::SettleStatus::Converged);
  return X_WE * result.X_ES * X_PS.inverse();
}

/// z of the lowest corner.
inline double bottom_of(const PlannedBox& box, const Pose& X_WP) {
  return X_WP.p.z() + lowest_corner(X_WP.R, box.size);
}

}  // namespace snug::skills
