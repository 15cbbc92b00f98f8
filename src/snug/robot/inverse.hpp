// InverseKinematics: the joints that bring the tool to a pose: all branches of a UR-like arm, or a search for any
// other.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "snug/core/expected.hpp"
#include "snug/robot/kinematics.hpp"
#include "snug/robot/ur_inverse.hpp"
#include "snug/robot/wrist_inverse.hpp"

namespace snug::robot {

/// Why no joints bring the tool to a pose.
enum class NoReach {
  OutOfReach,    ///< the arm is too short, or the pose too near to its first axis
  BeyondLimits,  ///< there are branches, but each has a joint beyond its limits
  NotConverged,  ///< the search ended without a solution; for an arm without closed form it proves nothing
};

/// "out of reach" and the like.
[[nodiscard]] std::string_view describe(NoReach reason) noexcept;

/// All ways to reach a pose; each in (-pi, pi] for joints that turn, limits not looked at.
struct IkBranches {
  std::array<JointVector, 8> q;
  int count = 0;
  /// How far the wrist is beyond the reach of upper arm and forearm, or too near to the first axis, m; > 0 when no
  /// branch exists, else <= 0: the margin of the best branch. Closed form only.
  double shortfall = 0.0;
};

/// Residual at which joints count as a solution: metres and radians.
inline constexpr double kIkTolerance = 1e-10;

/// Knows one arm. An arm is UR-like when it has six turning joints, the second to fourth axis parallel and the others
/// at right angles to their neighbours; most other arms of six joints have a spherical wrist (wrist_inverse.hpp). Both
/// up to the deviations of a calibration (3 degrees, 20 mm): then the ideal arm is solved in closed form and each
/// branch refined by Newton steps on the exact one. Any other arm is searched by damped least squares from several
/// starts.
class InverseKinematics {
 public:
  explicit InverseKinematics(const ArmModel& arm);

  [[nodiscard]] bool has_closed_form() const noexcept { return ur_.has_value() || wrist_.has_value(); }
  [[nodiscard]] const ArmModel& arm() const noexcept { return arm_; }

  /// All branches (at most 8) of an arm with closed form; for any other what a search from several starts finds.
  /// Where the wrist is singular the sixth joint is free and takes its value from `q_near`. On an arm that is not
  /// ideal, near a singularity (singularity_measure below 0.06), one of two branches that almost meet may be missing.
  [[nodiscard]] IkBranches branches(const Pose& X_WE, const JointVector& q_near) const noexcept;

  /// Of all branches and full turns within the joint limits, the one nearest to q_near (sum of squares). Of an arm
  /// without closed form the one to which a search from q_near leads; only where that does not arrive, the nearest of
  /// those that other starts lead to.
  [[nodiscard]] Expected<JointVector, NoReach> nearest(const Pose& X_WE, const JointVector& q_near) const noexcept;

  /// Newton steps (damped near singularities) from q to the pose, limits not looked at; nothing when they do not
  /// arrive within kIkTolerance.
  [[nodiscard]] std::optional<JointVector> refine(const Pose& X_WE, const JointVector& q) const noexcept;

 private:
  /// Refines `start`; false when that does not arrive or arrives at a branch that is known.
  bool add_branch(const Pose& X_WE, const JointVector& start, IkBranches& found) const noexcept;
  /// By damped least squares from one start, refined; nothing when it does not arrive.
  [[nodiscard]] std::optional<JointVector> search_from(const Pose& X_WE, const JointVector& q_start) const noexcept;
  [[nodiscard]] IkBranches search(const Pose& X_WE, const JointVector& q_near) const noexcept;

  ArmModel arm_;
  std::optional<UrGeometry> ur_;
  std::optional<WristGeometry> wrist_;  ///< of an arm that is not UR-like
};

}  // namespace snug::robot
