// Primitives: pick, flip and place as waypoints with switches, from what shall happen to the box.
#include "snug/skills/primitives.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/skills/internal/row_parts.hpp"

namespace snug::skills {
namespace {

using internal::at_height;
using internal::kHold;
using internal::kRelease;
using internal::vertical_axis_of;
using motion::MotionClass;

constexpr double kQuarterTurn = 0.5 * std::numbers::pi;

Matrix3 turn(const Vector3& axis, double angle) { return exp_rotation(angle * axis); }

Pose shifted(Pose X, const Vector3& by) {
  X.p += by;
  return X;
}

/// Collects the rows of one box.
class Rows {
 public:
  explicit Rows(std::string box) : box_(std::move(box)) {}
  void add(motion::MotionClass motion_class, const Pose& X_WE, const motion::IO& io, const char* variant = "") {
    rows_.push_back(motion::make_waypoint(motion_class, box_, X_WE, io, variant));
  }
  std::vector<motion::Waypoint> take() { return std::move(rows_); }

 private:
  std::string box_;
  std::vector<motion::Waypoint> rows_;
};

/// m, from the middle of a box to the farthest it reaches along `direction`, a unit vector in W.
double half_along(const Matrix3& R_WP, const Vector3& size, const Vector3& direction) {
  return 0.5 * (R_WP.transpose() * direction).cwiseAbs().dot(size);
}

/// The box of `intent`, tilted so that its low side leads, with its lowest corner at height `z`, shifted by `by`.
Pose tilted_pose(const PlaceIntent& intent, const TiltedEntry& entry, double z, const Vector3& by) {
  const Vector3 axis = Vector3::UnitZ().cross(entry.low_side);  // takes low_side down
  const double angle = intent.params.tilted.angle;
  Pose X_WP{turn(axis, angle) * intent.X_WP.R, intent.X_WP.p};
  // The corner that leads stays where it will be when the box is level.
  const double breadth = half_along(intent.X_WP.R, intent.size, entry.low_side);
  const double height = -lowest_corner(intent.X_WP.R, intent.size);
  const Vector3 corner = breadth * entry.low_side - height * Vector3::UnitZ();
  X_WP.p += corner - turn(axis, angle) * corner;
  X_WP.p += by;
  X_WP.p.z() += z - (X_WP.p.z() + lowest_corner(X_WP.R, intent.size));
  return X_WP;
}

void add_tilted_entry(const PlaceIntent& intent, const TiltedEntry& entry, Rows& rows) {
  const MotionClass place = intent.gentle ? MotionClass::PlaceSlow : MotionClass::Place;
  const double height = -lowest_corner(intent.X_WP.R, intent.size);
  const settings::TiltedParams& tilted = intent.params.tilted;
  const double low = entry.edge_height - tilted.depth;
  const auto tool = [&](const Pose& X_WP) { return intent.tool_for(X_WP); };
  rows.add(MotionClass::PrePlace, tool(tilted_pose(intent, entry, entry.edge_height + tilted.above, intent.come_from)),
           kHold, "_2");
  rows.add(place, tool(tilted_pose(intent, entry, entry.edge_height + tilted.at_edge, entry.push)), kHold, "_tilted");
  rows.add(place, tool(tilted_pose(intent, entry, low, entry.push)), kHold, "_in");
  rows.add(place, tool(shifted(at_height(intent.X_WP, low + height), entry.push)), kHold, "_level");
}

/// Where the box stops before it goes down.
std::optional<Pose> tool_at_entry(const PlaceIntent& intent) {
  if (intent.tool_heights) {
    if (!intent.tool_heights->entry) return std::nullopt;
    return at_height(intent.tool_for(intent.X_WP), *intent.tool_heights->entry);
  }
  const double height = -lowest_corner(intent.X_WP.R, intent.size);
  const double rest = intent.X_WP.p.z() - height;  // z of the lower face
  if (intent.entry_bottom <= rest + intent.params.least_drop) return std::nullopt;
  return intent.tool_for(shifted(at_height(intent.X_WP, intent.entry_bottom + height), intent.come_from));
}

/// The tool turned about its lip, so that the lower edge of what hangs from it goes ahead in the direction of `push`.
Pose lean_into(const Pose& X_WE, const PlaceIntent& intent, const Vector3& push) {
  if (push.isZero() || intent.push_lean == 0.0) return X_WE;
  const Matrix3 R = turn(push.normalized().cross(Vector3::UnitZ()), intent.push_lean);
  const Vector3 p_ELip_W = intent.lip * X_WE.R.col(2);
  return {R * X_WE.R, X_WE.p + p_ELip_W - R * p_ELip_W};
}

}  // namespace

double lowest_corner(const Matrix3& R_WP, const Vector3& size) {
  return -0.5 * R_WP.row(2).cwiseAbs().dot(size.transpose());
}

Vector3 choose_cup_offset(const Matrix3& R_WP, const Vector3& size, const Vector3& com_P, double lip_radius) {
  const int up = vertical_axis_of(R_WP);
  Vector3 offset = com_P;
  for (int i = 0; i < 3; ++i) {
    const double room = i == up ? 0.0 : std::max(0.0, 0.5 * size[i] - lip_radius);
    offset[i] = std::clamp(offset[i], -room, room);
  }
  return offset;
}

Pose tool_on_face(const PickIntent& intent) {
  const int up = vertical_axis_of(intent.X_WP.R);
  const double sign = intent.X_WP.R(2, up) > 0.0 ? 1.0 : -1.0;
  const Vector3 touched = intent.X_WP * (intent.cup_offset_P + 0.5 * sign * intent.size[up] * Vector3::Unit(up));
  return {motion::upright_tool(intent.tool_yaw), touched + Vector3(0.0, 0.0, intent.length)};
}

std::vector<motion::Waypoint> pick_rows(const PickIntent& intent) {
  const Pose X_WE_pick = tool_on_face(intent);
  Rows rows(intent.box);
  rows.add(intent.again ? MotionClass::PreRePick : MotionClass::PrePick, at_height(X_WE_pick, intent.approach_height),
           {});
  rows.add(intent.again ? MotionClass::RePick : MotionClass::Pick, X_WE_pick, {});
  const MotionClass lift = intent.again ? MotionClass::PostRePick : MotionClass::PostPick;
  if (intent.slow_lift > 0.0) rows.add(lift, at_height(X_WE_pick, X_WE_pick.p.z() + intent.slow_lift), kHold, "_off");
  rows.add(lift, at_height(X_WE_pick, intent.lift_height), kHold);
  return rows.take();
}

Matrix3 leveling(const Matrix3& R_WP) {
  const int up = vertical_axis_of(R_WP);
  const Vector3 normal = std::copysign(1.0, R_WP(2, up)) * R_WP.col(up);
  const Vector3 axis = normal.cross(Vector3::UnitZ());
  const double sine = axis.norm();
  return sine > 0.0 ? turn(axis / sine, std::atan2(sine, normal.z())) : Matrix3(Matrix3::Identity());
}

std::vector<motion::Waypoint> leaning_pick_rows(const PickIntent& intent, double leaning_lift) {
  const Matrix3 level = leveling(intent.X_WP.R);
  PickIntent standing = intent;
  standing.X_WP.R = level * intent.X_WP.R;
  const Pose X_WE_level = tool_on_face(standing);
  const Pose X_WE_pick{level.transpose() * X_WE_level.R,
                       intent.X_WP.p + level.transpose() * (X_WE_level.p - intent.X_WP.p)};
  const Pose X_WE_off = shifted(X_WE_pick, -leaning_lift * X_WE_pick.R.col(2));
  const Pose X_WE_over{X_WE_level.R, X_WE_off.p};
  Rows rows(intent.box);
  rows.add(MotionClass::PreRePick, at_height(X_WE_over, intent.approach_height), {});
  rows.add(MotionClass::PreRePick, X_WE_off, {}, "_lean");
  rows.add(MotionClass::RePick, X_WE_pick, {});
  rows.add(MotionClass::PostRePick, X_WE_off, kHold, "_off");
  rows.add(MotionClass::PostRePick, at_height(X_WE_over, intent.lift_height), kHold);
  return rows.take();
}

Matrix3 flipped(const Matrix3& R_WP, const Vector3& direction) {
  return turn(-Vector3::UnitZ().cross(direction), kQuarterTurn) * R_WP;
}

std::vector<motion::Waypoint> flip_rows(const FlipIntent& intent) {
  SNUG_CHECK(std::abs(intent.direction.z()) < 1e-9, "a flip goes about a level edge");
  const settings::PivotParams& params = intent.params;
  const Vector3 axis = -Vector3::UnitZ().cross(intent.direction);  // turns down toward `direction`
  const double half_height = half_along(intent.R_WP, intent.size, Vector3::UnitZ());
  const double along = half_along(intent.R_WP, intent.size, intent.direction);
  // The edge about which the box turns, from the middle of the box: below, on the side away from `direction`.
  const Vector3 edge = -along * intent.direction - half_height * Vector3::UnitZ();
  // Where that edge lies before the box is dragged.
  const Vector3 p_WEdge = intent.p_WF + (half_height + params.dragged) * intent.direction;
  const auto tool = [&](double angle, double height) {
    const Matrix3 R = turn(axis, angle);
    return intent.tool_for({R * intent.R_WP, p_WEdge + Vector3(0.0, 0.0, height) - R * edge});
  };
  Rows rows(intent.box);
  const double above = intent.travel_bottom - intent.p_WF.z();
  rows.add(MotionClass::PreTwist, tool(0.0, above), kHold);
  rows.add(MotionClass::PreTwist, tool(params.tilt_before * params.tilt, params.height_before), kHold, "_2");
  rows.add(MotionClass::Twist, tool(params.tilt - params.left_to_surface, -params.press), kHold);
  // From here on the surface carries the box: the cup is commanded without sag, so that it neither lifts the box nor
  // turns it when it lets go.
  const Matrix3 R_end = turn(axis, params.tilt);
  const Pose X_WE_end =
      Pose{R_end * intent.R_WP, p_WEdge + Vector3(0.0, 0.0, -params.press) - R_end * edge} * intent.X_PE;
  rows.add(MotionClass::Twist, X_WE_end, kHold);
  const Pose X_WE_back = shifted(X_WE_end, -params.drag * intent.direction);
  rows.add(MotionClass::TwistDrag, X_WE_back, kHold);
  rows.add(MotionClass::TwistDrag, X_WE_back, kRelease);
  // Up and upright again before the cup comes over the box.
  const double over = intent.p_WF.z() + 2.0 * along + (intent.X_PE.p.norm() - half_height) + params.retreat;
  rows.add(MotionClass::PreTwist, {intent.R_WP * intent.X_PE.R, Vector3(X_WE_back.p.x(), X_WE_back.p.y(), over)}, {},
           "_back");
  return rows.take();
}

Pose tool_over_place(const PlaceIntent& intent) {
  const double height = -lowest_corner(intent.X_WP.R, intent.size);
  const double rest = intent.X_WP.p.z() - height;  // z of the lower face
  if (intent.tool_heights) return at_height(intent.tool_for(intent.X_WP), intent.tool_heights->travel);
  const double bottom = std::max(intent.travel_bottom, rest + intent.params.least_rise);
  return intent.tool_for(shifted(at_height(intent.X_WP, bottom + height), intent.come_from));
}

std::vector<motion::Waypoint> place_rows(const PlaceIntent& intent) {
  const MotionClass place = intent.gentle ? MotionClass::PlaceSlow : MotionClass::Place;
  const double height = -lowest_corner(intent.X_WP.R, intent.size);
  const double rest = intent.X_WP.p.z() - height;  // z of the lower face
  const auto tool = [&](double bottom, const Vector3& by) {
    return intent.tool_for(shifted(at_height(intent.X_WP, bottom + height), by));
  };
  Rows rows(intent.box);
  const Vector3& from = intent.come_from;
  rows.add(MotionClass::PrePlace, tool_over_place(intent), kHold);
  Vector3 last = Vector3::Zero();
  if (intent.tilted) {
    add_tilted_entry(intent, *intent.tilted, rows);
    last = intent.tilted->push;
  } else {
    if (const auto X_WE_entry = tool_at_entry(intent)) rows.add(MotionClass::PrePlace, *X_WE_entry, kHold, "_2");
    const bool slides = !(intent.overtravel.isZero() && from.isZero());
    if (slides) {
      const double height_of_push = intent.lowered ? rest - *intent.lowered : rest + intent.params.slide_gap;
      rows.add(place, tool(height_of_push, from), kHold, "_down");
      const Pose X_WE_pushed = lean_into(tool(height_of_push, intent.overtravel), intent, intent.overtravel);
      rows.add(MotionClass::PlaceSlow, X_WE_pushed, kHold, "_push");
    }
    // On its support the box stays where it was pushed to; hanging it would follow the tool.
    if (!intent.lowered) last = intent.overtravel;
  }
  const Pose X_WE_end = lean_into(tool(rest - intent.lowered.value_or(intent.params.press), 0.5 * last), intent, last);
  rows.add(place, X_WE_end, kHold);
  rows.add(place, X_WE_end, kRelease);
  const double over = std::max(intent.travel_bottom, X_WE_end.p.z()) + intent.params.retreat;
  rows.add(MotionClass::PostPlace, at_height(X_WE_end, intent.tool_heights ? intent.tool_heights->leave : over), {});
  return rows.take();
}

}  // namespace snug::skills
