// program_from_placements: plain pick-and-place waypoints for boxes that need no flip.
#include "snug/skills/placements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "snug/skills/primitives.hpp"

namespace snug::skills {
namespace {

using Refusal = Unexpected<NoProgramReason>;

// rad; a box standing on a face is upright to rounding, one that leans on something is off by far more.
constexpr double kUprightTolerance = 1e-3;
// m; stops nearer to each other than this are one.
constexpr double kSameHeight = 1e-3;

/// One box of the plan.
struct Move {
  PickIntent pick;    ///< heights are set when it is known what is passed over
  PlaceIntent place;  ///< the same
  Pose X_WE_pick;
  Pose X_WE_place;
  double pick_top = 0.0;      ///< m, z in W of the top face at the aligner
  double height = 0.0;        ///< m, of the standing box
  double place_bottom = 0.0;  ///< m, z in W of the bottom face at rest
};

Refusal refuse(NoProgram reason, const std::string& box, const std::string& detail = {}) {
  std::string text = fmt::format("{}: {}", box, describe(reason));
  if (!detail.empty()) text += ": " + detail;
  return Refusal(NoProgramReason{reason, box, std::move(text)});
}

bool is_finite(const Pose& X) { return X.p.allFinite() && X.R.allFinite(); }

/// Up, seen from the box.
Vector3 up_in_box(const Pose& X_WP) { return X_WP.R.row(2).transpose(); }

bool is_along_an_axis(const Vector3& unit) { return unit.cwiseAbs().maxCoeff() >= std::cos(kUprightTolerance); }

bool is_same_direction(const Vector3& a, const Vector3& b) {
  return a.cross(b).norm() <= kUprightTolerance && a.dot(b) > 0.0;
}

double standing_height(const Pose& X_WP, const Vector3& size) { return up_in_box(X_WP).cwiseAbs().dot(size); }

std::optional<Refusal> find_problem(const PickSpec& pick, const Pose& X_WP_place) {
  const auto bad = [&](const char* detail) { return refuse(NoProgram::BadNumber, pick.box, detail); };
  if (!is_finite(pick.X_WP) || !is_finite(X_WP_place)) return bad("a pose is not finite");
  if (!pick.size.allFinite() || pick.size.minCoeff() <= 0.0) return bad("its size must be positive");
  if (!std::isfinite(pick.tool_yaw.value_or(0.0))) return bad("the tool's yaw is not finite");
  const Vector3 up_pick = up_in_box(pick.X_WP);
  if (!is_along_an_axis(up_pick)) return refuse(NoProgram::NotUpright, pick.box);
  const Vector3 offset_in_face = pick.cup_offset - pick.cup_offset.dot(up_pick) * up_pick;
  if (!(((2.0 * offset_in_face).cwiseAbs() - pick.size).maxCoeff() < 0.0))
    return bad("the cup would miss the top face");
  const Vector3 up_place = up_in_box(X_WP_place);
  if (is_same_direction(up_pick, up_place)) return std::nullopt;
  return refuse(is_along_an_axis(up_place) ? NoProgram::NeedsFlip : NoProgram::TiltedPlacement, pick.box);
}

bool is_finite(const PlacementSettings& s) {
  return is_finite(s.X_WT) && is_finite(s.X_WE_home) && std::isfinite(s.rim_height) && std::isfinite(s.obstacle_top) &&
         std::isfinite(s.pick_length) && std::isfinite(s.hold_length) && std::isfinite(s.free_length) &&
         std::isfinite(s.release_gap) && std::isfinite(s.travel_clearance) && std::isfinite(s.tool_yaw) &&
         std::isfinite(s.entry_clearance.value_or(0.0));
}

Move plan_move(const PickSpec& pick, const Pose& X_WP_place, const PlacementSettings& settings) {
  Move move;
  move.height = standing_height(pick.X_WP, pick.size);
  move.pick_top = pick.X_WP.p.z() + 0.5 * move.height;
  move.place_bottom = X_WP_place.p.z() - 0.5 * move.height;

  const Vector3 up_P = up_in_box(pick.X_WP);
  move.pick.box = pick.box;
  move.pick.X_WP = pick.X_WP;
  move.pick.size = pick.size;
  move.pick.cup_offset_P = pick.cup_offset - pick.cup_offset.dot(up_P) * up_P;
  move.pick.tool_yaw = pick.tool_yaw.value_or(settings.tool_yaw);
  move.pick.length = settings.pick_length;
  move.X_WE_pick = tool_on_face(move.pick);

  PickIntent touch = move.pick;
  touch.length = 0.0;
  move.place.box = pick.box;
  move.place.X_WP = X_WP_place;
  move.place.size = pick.size;
  move.place.params.press = 0.0;
  // Rigidly held: the sag of the cup is not made up for.
  move.place.tool_for = [X_PE = pick.X_WP.inverse() * tool_on_face(touch),
                         lift = settings.hold_length + settings.release_gap](const Pose& X_WP) {
    Pose X_WE = X_WP * X_PE;
    X_WE.p.z() += lift;
    return X_WE;
  };
  move.X_WE_place = move.place.tool_for(X_WP_place);
  return move;
}

class Writer {
 public:
  Writer(const PlacementSettings& settings, std::vector<Move> moves) : settings_(settings), moves_(std::move(moves)) {
    rim_ = settings.X_WT.p.z() + settings.rim_height * settings.X_WT.R(2, 2);
  }

  motion::Program write() {
    for (std::size_t i = 0; i < moves_.size(); ++i) {
      Move& move = moves_[i];
      move.pick.approach_height = empty_height(move.pick_top);
      move.pick.lift_height = loaded_height(move);
      add(pick_rows(move.pick));
      ToolHeights heights{move.pick.lift_height, entry_height(move), 0.0};
      stack_top_ = std::max(stack_top_, move.place_bottom + move.height);
      const double next_top = i + 1 < moves_.size() ? moves_[i + 1].pick_top : kNothing;
      heights.leave = std::max(empty_height(next_top), move.X_WE_place.p.z());
      move.place.tool_heights = heights;
      add(place_rows(move.place));
    }
    add({motion::make_waypoint(motion::MotionClass::Home, {}, settings_.X_WE_home)});
    return std::move(program_);
  }

 private:
  static constexpr double kNothing = -1.0e9;  // m, lower than anything

  void add(const std::vector<motion::Waypoint>& rows) {
    program_.waypoints.insert(program_.waypoints.end(), rows.begin(), rows.end());
  }

  double packed_top() const { return std::max(rim_, stack_top_); }
  double crossing_bottom() const { return std::max(packed_top(), settings_.obstacle_top) + settings_.travel_clearance; }

  /// z of E when crossing with a free cup, over a box of this top at the aligner too.
  double empty_height(double waiting_top) const {
    return std::max(crossing_bottom(), waiting_top + settings_.travel_clearance) + settings_.free_length;
  }

  /// z of E when crossing with this box.
  double loaded_height(const Move& move) const {
    const double over_obstacles = crossing_bottom() + move.height + settings_.hold_length;
    return std::max({over_obstacles, move.X_WE_pick.p.z() + settings_.travel_clearance, move.X_WE_place.p.z()});
  }

  /// Just over rim and packed boxes, where that is between crossing and place.
  std::optional<double> entry_height(const Move& move) const {
    if (!settings_.entry_clearance) return std::nullopt;
    const double entry = packed_top() + *settings_.entry_clearance + move.height + settings_.hold_length;
    const bool is_between = entry < loaded_height(move) - kSameHeight && entry > move.X_WE_place.p.z() + kSameHeight;
    return is_between ? std::optional<double>(entry) : std::nullopt;
  }

  const PlacementSettings& settings_;
  std::vector<Move> moves_;
  motion::Program program_{"placements", {}};
  double rim_ = 0.0;
  double stack_top_ = kNothing;
};

}  // namespace

const char* describe(NoProgram reason) {
  switch (reason) {
    case NoProgram::UnknownBox:
      return "there is no such box to pick";
    case NoProgram::PlacedTwice:
      return "it is placed twice";
    case NoProgram::NotUpright:
      return "it does not stand on a face at the aligner";
    case NoProgram::NeedsFlip:
      return "it needs a flip: another face is up in the placement than at the aligner";
    case NoProgram::TiltedPlacement:
      return "its placement is tilted";
    case NoProgram::BadNumber:
      return "a number is out of range";
  }
  return "unknown reason";
}

Expected<motion::Program, NoProgramReason> program_from_placements(std::span<const PickSpec> picks,
                                                                   std::span<const Placement> placements,
                                                                   const PlacementSettings& settings) {
  if (!is_finite(settings)) return refuse(NoProgram::BadNumber, "settings", "every number must be finite");
  std::vector<Move> moves;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    const Placement& placement = placements[i];
    const auto same_box = [&](const auto& other) { return other.box == placement.box; };
    const auto pick = std::ranges::find_if(picks, same_box);
    if (pick == picks.end()) return refuse(NoProgram::UnknownBox, placement.box);
    if (std::ranges::any_of(placements.first(i), same_box)) return refuse(NoProgram::PlacedTwice, placement.box);
    const Pose X_WP_place = settings.X_WT * placement.X_TP;
    if (std::optional<Refusal> problem = find_problem(*pick, X_WP_place)) return *problem;
    moves.push_back(plan_move(*pick, X_WP_place, settings));
  }
  return Writer(settings, std::move(moves)).write();
}

}  // namespace snug::skills
