// Clearance: how near parts of an arm come to each other, and where.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "snug/geometry/shape.hpp"
#include "snug/model/robot_params.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::control {

/// Shapes fixed to the tool frame E (their X_BG is X_EG) under a name, beside the links of the arm.
struct CarriedShapes {
  std::string name;
  std::vector<model::PlacedShape> shapes;
};

/// A convex shape that moves with a segment of the arm.
struct ArmShape {
  int segment = 0;
  Pose X_SG;
  geometry::Shape shape;
  double radius = 0.0;  ///< m, of the ball around the origin of G that contains it
};

/// All shapes of a link, or carried ones, under one name.
struct ArmPart {
  std::string name;
  int segment = 0;
  std::vector<ArmShape> shapes;
};

/// Where two parts are nearest.
struct Nearest {
  int index = -1;                     ///< of the pair; -1: none within its range
  double distance = 0.0;              ///< m, negative when they overlap
  Vector3 p_WA = Vector3::Zero();     ///< m
  Vector3 p_WB = Vector3::Zero();     ///< m
  Vector3 n_AB_W = Vector3::UnitZ();  ///< unit, from A to B
};

/// Smallest distance of two sets of shapes if it is at most `range`, else index -1.
[[nodiscard]] Nearest nearest_points(std::span<const ArmShape> A, const Pose& X_WA, std::span<const ArmShape> B,
                                     const Pose& X_WB, double range) noexcept;

class Clearance {
 public:
  struct Pair {
    int part_a = 0, part_b = 0;
    double interaction = 0.0;  ///< m
    double safety = 0.0;       ///< m
  };

  Clearance() = default;
  /// Parts of all links with shapes and of what is carried. Throws InputError for a pair of unknown names.
  Clearance(const robot::ArmModel& arm, std::span<const CarriedShapes> carried,
            std::span<const model::SelfCollisionPair> pairs, const std::string& where);

  [[nodiscard]] const std::vector<ArmPart>& parts() const { return parts_; }
  [[nodiscard]] const std::vector<Pair>& pairs() const { return pairs_; }
  [[nodiscard]] std::string name_of(int pair) const;
  /// Nearest points of one pair within its interaction distance, else index -1.
  [[nodiscard]] Nearest nearest(const robot::ArmPose& at, int pair) const noexcept;

 private:
  std::vector<ArmPart> parts_;
  std::vector<Pair> pairs_;
};

}  // namespace snug::control
