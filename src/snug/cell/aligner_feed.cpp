// AlignerFeed: how a box of the sequence stands at the aligner when the robot comes for it.
#include "snug/cell/aligner_feed.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/check.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::cell {
namespace {

/// Does the box stand as the sequence wants its heavy side?
bool agrees_with_heavy_side(const model::Item& item, const model::Aligner& aligner, const Matrix3& R_AP) {
  if (item.up == model::UpAxis::Z) return true;
  switch (item.heavy_side.value_or(aligner.heavy_side)) {
    case model::HeavySide::Any:
      return true;
    case model::HeavySide::Corner:
      return model::has_heavy_side_at_corner(R_AP);
    case model::HeavySide::Away:
      return !model::has_heavy_side_at_corner(R_AP);
  }
  return true;
}

/// Of the face that a tool pointing along `direction` comes to, seen from above.
Vector3 face_middle(const Pose& X_WP, const Vector3& size, const Vector3& direction) {
  int axis = 0;
  const double along = (X_WP.R.transpose() * direction).cwiseAbs().maxCoeff(&axis);
  const bool from_above = std::abs(direction.z()) > along - 1e-6;
  if (from_above) return X_WP.p;
  const double sign = X_WP.R.col(axis).dot(direction) > 0.0 ? -1.0 : 1.0;
  return X_WP.p + 0.5 * sign * size[axis] * X_WP.R.col(axis);
}

Matrix3 rotation_in_corner(const model::Item& item, int quarter) {
  return model::standing_rotation(item.up, item.up_sign, item.yaw.value_or(quarter * 0.5 * std::numbers::pi));
}

Vector3 size_of(const model::Scenario& scenario, const model::Item& item) {
  return model::collision_size(scenario, *model::find_parcel(scenario, item.parcel));
}

}  // namespace

int choose_quarter(const model::Scenario& scenario, const model::Item& item, const std::optional<Pose>& X_WE_pick) {
  SNUG_CHECK(scenario.aligner.has_value(), "a sequence needs an aligner");
  const model::Aligner& aligner = *scenario.aligner;
  if (item.yaw || aligner.yaw_rule != model::YawRule::NearestPick || !X_WE_pick) return 0;
  const Vector3 size = size_of(scenario, item);
  // Where the tool touches, as far as its waypoint tells.
  const Vector3 direction = X_WE_pick->R.col(2);
  const Vector3 touched = X_WE_pick->p + cup::pick_length(scenario.cup) * direction;
  int best = 0;
  double best_distance = std::numeric_limits<double>::infinity();
  for (int quarter = 0; quarter < 4; ++quarter) {
    const Matrix3 R_AP = rotation_in_corner(item, quarter);
    if (!agrees_with_heavy_side(item, aligner, R_AP)) continue;
    const Pose X_WP = model::standing_pose(aligner, size, R_AP);
    const double distance = (face_middle(X_WP, size, direction) - touched).head<2>().norm();
    if (distance < best_distance - 1e-9) {
      best_distance = distance;
      best = quarter;
    }
  }
  return best;
}

Pose pose_at_aligner(const model::Scenario& scenario, const model::Item& item, int quarter) {
  SNUG_CHECK(scenario.aligner.has_value(), "a sequence needs an aligner");
  const model::Aligner& aligner = *scenario.aligner;
  Pose X_WP = model::standing_pose(aligner, size_of(scenario, item), rotation_in_corner(item, quarter));
  if (item.turn != 0.0) X_WP.R = exp_rotation(Vector3(0.0, 0.0, item.turn)) * X_WP.R;
  X_WP.p += aligner.X_WA.R * item.shift_A;
  return X_WP;
}

Pose pose_at_aligner(const model::Scenario& scenario, const model::Item& item, const std::optional<Pose>& X_WE_pick) {
  return pose_at_aligner(scenario, item, choose_quarter(scenario, item, X_WE_pick));
}

std::optional<Pose> next_pick(const motion::Program& program, int row) {
  const auto& rows = program.waypoints;
  for (auto i = static_cast<std::size_t>(row) + 1; i < rows.size(); ++i) {
    if (rows[i].io.vacuum) return rows[i - 1].X_WE;
  }
  return std::nullopt;
}

int find_item(const model::Sequence& sequence, const motion::Waypoint& waypoint) {
  int best = -1;
  std::size_t most = 0;
  for (std::size_t i = 0; i < sequence.items.size(); ++i) {
    const std::size_t fit = motion::fit_of(waypoint, sequence.items[i].parcel);
    if (fit <= most) continue;
    most = fit;
    best = static_cast<int>(i);
  }
  return best;
}

int vertical_axis(const Matrix3& R_WP) {
  int axis = 0;
  R_WP.row(2).cwiseAbs().maxCoeff(&axis);
  return axis;
}

char axis_letter(int axis) { return static_cast<char>('X' + axis); }

}  // namespace snug::cell
