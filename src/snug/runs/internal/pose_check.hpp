// PoseCheck: what is wrong where an arm stands: joints near their limits, a singularity, links and tool near other
// things.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "snug/control/clearance.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/model/scenario.hpp"
#include "snug/runs/program_check.hpp"

namespace snug::runs::internal {

/// Something that does not move, in W.
struct Obstacle {
  std::string name;
  geometry::Shape shape;
  Pose X_WG;
  geometry::Aabb bounds;
};

/// Shapes that move together and are judged together.
struct Mover {
  std::string name;
  int segment = 0;                         ///< of the arm
  std::vector<model::PlacedShape> shapes;  ///< X_BG in the segment
  double allowance = 0.0;                  ///< m, that it may press into something
};

/// A margin that was measured: to a limit, or to a thing; negative: beyond it, inside it.
struct PoseMargin {
  CheckKind kind = CheckKind::Reach;
  std::string what;  ///< joint, or "part - body"
  double margin = 0.0;
  const char* unit = "m";
  double allowance = 0.0;  ///< how far it may be beyond, in the same unit
  [[nodiscard]] bool is_kept() const;
};

/// Of one scenario's robot. All of it may be called from several threads.
class PoseCheck {
 public:
  using Note = std::function<void(const PoseMargin&)>;

  /// `allowance`, `range`: as in CheckOptions. `arm` and `clearance` must outlive it.
  PoseCheck(const model::Scenario& scenario, const robot::ArmModel& arm, const control::Clearance& clearance,
            double allowance, double range);

  /// Of one joint, to the limit that its damper keeps; nothing for a joint without limits.
  void look_at_limit(int joint, double q, const Note& note) const;
  /// Of the tool's Jacobian: how far from singular.
  void look_at_singularity(double measure, const Note& note) const;
  /// Pairs of self_collision, and every mover to what does not move and to `packed`.
  void look_at_distances(const robot::ArmPose& at, const std::vector<Obstacle>& packed, double packed_allowance,
                         const Note& note) const;
  /// One more mover, at X_WS.
  void look_at(const Mover& mover, const Pose& X_WS, const std::vector<Obstacle>& packed, double packed_allowance,
               const Note& note) const;

 private:
  void look_at_obstacles(const Mover& mover, const Pose& X_WS, const std::vector<Obstacle>& obstacles, double allowance,
                         const Note& note) const;

  const robot::ArmModel& arm_;
  const control::Clearance& clearance_;
  double range_;
  double damper_safety_;
  std::vector<Obstacle> obstacles_;
  std::vector<Mover> movers_;
};

/// Below this measure the controller's task gives way (joint_controller.cpp): the tool is no longer where it should be.
inline constexpr double kSingularPose = 0.05;

}  // namespace snug::runs::internal
