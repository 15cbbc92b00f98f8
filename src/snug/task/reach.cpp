// Reach: whether the scenario's robot can bring a box to a place, by its joints alone.
#include "snug/task/reach.hpp"

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "snug/robot/inverse.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/task/uncertainty.hpp"

namespace snug::task {
namespace {

constexpr int kMostFlips = 2;
constexpr double kUpright = 0.97;  ///< cosine of 15 degrees

struct Known {
  PlannedBox box;
  Matrix3 R_WP;  ///< at the aligner
};

class Reach {
 public:
  Reach(const model::Scenario& scenario, CellLayout layout, const model::Sequence& sequence)
      : layout_(std::move(layout)),
        cup_(scenario.cup),
        inverse_(robot::load_arm(scenario)),
        posture_(robot::joint_vector(scenario.robot->posture)) {
    for (std::size_t i = 0; i < sequence.items.size(); ++i) {
      boxes_[sequence.items[i].parcel] = {make_planned_box(scenario, sequence, static_cast<int>(i)),
                                          arrival_pose(scenario, sequence.items[i]).R};
    }
  }

  [[nodiscard]] bool can(const packing::Placement& placement) const {
    const auto found = boxes_.find(placement.item);
    if (found == boxes_.end()) return true;
    const Known& known = found->second;
    const Pose X_WP = layout_.X_WT * placement.X_TP;
    const Matrix3 R_before = orientation_before_place(layout_, known.R_WP, placement.orientation);
    const double height = -2.0 * motion::lowest_corner(X_WP.R, known.box.size);
    const double radius = 0.5 * cup_.effective_diameter + 0.001;
    const Vector3 offset = motion::choose_cup_offset(X_WP.R, known.box.size, known.box.inertia.com, radius);
    Pose X_WE{tool_at_place(layout_, R_before, X_WP.R), X_WP.p + X_WP.R * offset};
    for (const double bottom : {X_WP.p.z() - 0.5 * height, travel_bottom(layout_, 0.0)}) {
      X_WE.p.z() = bottom + height + cup_.hold_length;
      if (!inverse_.nearest(X_WE, posture_)) return false;
    }
    return true;
  }

 private:
  CellLayout layout_;
  model::CupParams cup_;
  robot::InverseKinematics inverse_;
  robot::JointVector posture_;
  std::map<std::string, Known> boxes_;
};

bool has_arm(const model::Scenario& scenario) {
  if (!scenario.robot) return false;
  const std::filesystem::path urdf = scenario.robot->urdf;
  const std::filesystem::path folder = std::filesystem::path(scenario.source_name).parent_path();
  std::error_code error;
  return std::filesystem::exists(urdf.is_relative() ? folder / urdf : urdf, error);
}

}  // namespace

Matrix3 orientation_before_place(const CellLayout& layout, const Matrix3& R_WP,
                                 const packing::Orientation& orientation) {
  const Vector3 up_P = orientation.up_sign * Vector3::Unit(static_cast<int>(orientation.up));
  Matrix3 R = R_WP;
  for (int flip = 0; flip < kMostFlips && layout.flip_place && (R * up_P).z() < kUpright; ++flip) {
    Vector3 next_up = up_P;
    if ((R * up_P).z() < -kUpright) {
      int axis = 0;
      R.row(2).cwiseAbs().minCoeff(&axis);
      next_up = Vector3::Unit(axis);
    }
    const Vector3& direction = layout.flip_place->direction;
    R = motion::flipped(orientation_before_flip(R, next_up, direction), direction);
  }
  return R;
}

std::function<bool(const Pose&)> make_tool_reach(const model::Scenario& scenario) {
  if (!has_arm(scenario)) return {};
  const auto inverse = std::make_shared<const robot::InverseKinematics>(robot::load_arm(scenario));
  const robot::JointVector posture = robot::joint_vector(scenario.robot->posture);
  return [inverse, posture](const Pose& X_WE) { return inverse->nearest(X_WE, posture).has_value(); };
}

std::function<bool(const packing::Placement&)> make_reach(const model::Scenario& scenario, const CellLayout& layout,
                                                          const model::Sequence& sequence) {
  if (!has_arm(scenario)) return {};
  const auto reach = std::make_shared<const Reach>(scenario, layout, sequence);
  return [reach](const packing::Placement& placement) { return reach->can(placement); };
}

}  // namespace snug::task
