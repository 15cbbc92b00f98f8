// HeldBoxes: which box hangs in the cup while a program runs, and how, as far as its waypoints tell.
#include "snug/cell/held_boxes.hpp"

#include "snug/cell/aligner_feed.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::cell {
namespace {

/// R with the axis that is nearest to the vertical made vertical.
Matrix3 upright(const Matrix3& R_WP) {
  const int axis = vertical_axis(R_WP);
  const Vector3 up = R_WP.col(axis);
  const Vector3 goal = Vector3(0.0, 0.0, up.z() < 0.0 ? -1.0 : 1.0);
  return orthonormalized(rotation_between(up, goal).toRotationMatrix() * R_WP);
}

/// A box that is picked at X_EP, once the vacuum has drawn it to where the cup ends then, flat against the lip: a cup
/// that comes at an angle turns the box, about the point where it touches.
Pose hanging(const Pose& X_EP, const Vector3& size, double hold_length) {
  int axis = 0;
  X_EP.R.row(2).cwiseAbs().maxCoeff(&axis);
  const double sign = X_EP.R(2, axis) > 0.0 ? 1.0 : -1.0;
  const Vector3 normal = sign * X_EP.R.col(axis);  // into the box
  const Vector3 face = X_EP.p - 0.5 * size[axis] * normal;
  const Vector3 lip(0.0, 0.0, face.dot(normal) / normal.z());
  const Matrix3 turn = rotation_between(normal, Vector3::UnitZ()).toRotationMatrix();
  return {orthonormalized(turn * X_EP.R), Vector3(0.0, 0.0, hold_length) + turn * (X_EP.p - lip)};
}

}  // namespace

void HeldBoxes::depart(const motion::Program& program, int row, const Pose& X_WE) {
  const bool vacuum = program.waypoints[static_cast<std::size_t>(row)].io.vacuum;
  if (vacuum == vacuum_) return;
  vacuum_ = vacuum;
  if (!vacuum) {
    if (!held_) return;
    X_WP_released_ = X_WE * held_->X_EP;
    standing_.push_back({held_->item, held_->size, {upright(X_WP_released_.R), X_WP_released_.p}});
    released_ = held_;
    held_.reset();
    return;
  }
  if (row == 0) return;
  const motion::Waypoint& pick = program.waypoints[static_cast<std::size_t>(row) - 1];
  const int item = pick.motion_class == motion::MotionClass::Pick ? find_item(*sequence_, pick) : -1;
  Pose X_WP;
  if (item >= 0) {
    const model::Item& fed = sequence_->items[static_cast<std::size_t>(item)];
    held_ = HeldBox{item, model::collision_size(*scenario_, *model::find_parcel(*scenario_, fed.parcel)), {}};
    X_WP = pose_at_aligner(*scenario_, fed, X_WE);
  } else if (released_) {
    held_ = released_;
    X_WP = {upright(X_WP_released_.R), X_WP_released_.p};
  } else {
    return;
  }
  std::erase_if(standing_, [this](const StandingBox& box) { return box.item == held_->item; });
  held_->X_EP = hanging(X_WE.inverse() * X_WP, held_->size, scenario_->cup.hold_length);
}

}  // namespace snug::cell
