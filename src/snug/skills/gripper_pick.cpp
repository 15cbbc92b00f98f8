// GripperPick: where a gripper of several cups takes a box by its top face: which cups seal there, and how well.
#include "snug/skills/gripper_pick.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/cup/phases.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/skills/internal/row_parts.hpp"
#include "snug/skills/primitives.hpp"

namespace snug::skills {
namespace {

/// Hold factors nearer than this are equal: the nearer yaw then counts.
constexpr double kEqual = 0.01;

/// The face's two axes in P, and half its size along them.
struct Axes {
  Vector3 a, b;
  double half_a = 0.0, half_b = 0.0;
};

Axes axes_of(const TopFace& face) {
  const int up = internal::vertical_axis_of(face.X_WP.R);
  const int a = (up + 1) % 3, b = (up + 2) % 3;
  return {Vector3::Unit(a), Vector3::Unit(b), 0.5 * face.size[a], 0.5 * face.size[b]};
}

/// Sinking and tilt of the box, d + alpha a + beta b, under its weight at (com_a, com_b) on springs along the vertical.
Vector3 settle(const Matrix3& stiffness, double weight, double com_a, double com_b) {
  // Symmetric and positive definite as the cups' bending is: Cramer's rule.
  const Vector3 load = weight * Vector3(1.0, com_a, com_b);
  const Vector3 c0 = stiffness.col(0), c1 = stiffness.col(1), c2 = stiffness.col(2);
  const double det = c0.dot(c1.cross(c2));
  return Vector3(load.dot(c1.cross(c2)), c0.dot(load.cross(c2)), c0.dot(c1.cross(load))) / det;
}

}  // namespace

GripperPick judge_gripper_pick(const model::GripperParams& gripper, double seal_margin, const TopFace& face,
                               double tool_yaw, const Vector3& offset_P, double gravity) {
  const Axes axes = axes_of(face);
  const Matrix3 R_PE = face.X_WP.R.transpose() * motion::upright_tool(tool_yaw);
  GripperPick pick{tool_yaw, offset_P, {}, 0.0};
  std::vector<model::LineState> lines;
  Matrix3 stiffness = Matrix3::Zero();
  std::vector<Vector3> at;  // 1, a, b of each sealed cup
  for (std::size_t i = 0; i < gripper.cups.size(); ++i) {
    const model::MountedCup& cup = gripper.cups[i];
    const Vector3 p = offset_P + R_PE * cup.p_EC;
    const double radius = 0.5 * cup.cup.effective_diameter + seal_margin;
    const bool seals =
        std::abs(p.dot(axes.a)) + radius <= axes.half_a && std::abs(p.dot(axes.b)) + radius <= axes.half_b;
    lines.push_back(seals ? model::LineState::Sealed : model::LineState::Open);
    if (!seals) continue;
    pick.cups.push_back(i);
    at.emplace_back(1.0, p.dot(axes.a), p.dot(axes.b));
    stiffness += cup.cup.stiffness.axial * at.back() * at.back().transpose();
    stiffness(1, 1) += cup.cup.stiffness.bend;
    stiffness(2, 2) += cup.cup.stiffness.bend;
  }
  if (pick.cups.empty()) return pick;
  model::SupplyBalance balance;
  model::balance_supply(gripper, lines, balance);
  const Vector3 sunk = settle(stiffness, face.mass * gravity, face.com_P.dot(axes.a), face.com_P.dot(axes.b));
  pick.hold_factor = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < pick.cups.size(); ++k) {
    const model::CupParams& cup = gripper.cups[pick.cups[k]].cup;
    const Vector3 force(0.0, 0.0, -cup.stiffness.axial * sunk.dot(at[k]));
    const Vector3 torque = cup.stiffness.bend * Vector3(sunk[1], sunk[2], 0.0);
    pick.hold_factor =
        std::min(pick.hold_factor, cup::find_hold_factor(cup, -balance.cups[pick.cups[k]], {force, torque}));
  }
  return pick;
}

std::optional<GripperPick> choose_gripper_pick(const model::GripperParams& gripper, double seal_margin,
                                               const TopFace& face, double tool_yaw, double gravity) {
  const Axes axes = axes_of(face);
  const Vector3 half_E = model::footprint(gripper) + Vector3::Constant(seal_margin);
  const Vector3 along_W = face.X_WP.R * axes.a;
  const Vector3 x_W = motion::upright_tool(tool_yaw).col(0);
  // From the tool's x to an edge of the face, within an eighth of a turn: yaw turns about the vertical.
  const double turn =
      std::remainder(std::atan2(along_W.y(), along_W.x()) - std::atan2(x_W.y(), x_W.x()), 0.5 * std::numbers::pi);
  std::optional<GripperPick> best;
  for (const int quarter : {0, 1, -1, 2}) {  // nearest first
    const double yaw = tool_yaw + turn + 0.5 * std::numbers::pi * quarter;
    const Matrix3 R_PE = face.X_WP.R.transpose() * motion::upright_tool(yaw);
    const Vector3 com = face.com_P.dot(axes.a) * axes.a + face.com_P.dot(axes.b) * axes.b;
    const auto within = [&](const Vector3& axis, double half) {
      const double room = std::max(0.0, half - (R_PE.transpose() * axis).cwiseAbs().head<2>().dot(half_E.head<2>()));
      return std::clamp(com.dot(axis), -room, room);
    };
    std::vector<Vector3> offsets{within(axes.a, axes.half_a) * axes.a + within(axes.b, axes.half_b) * axes.b, com};
    for (const model::MountedCup& cup : gripper.cups) {
      const Vector3 p = R_PE * cup.p_EC;
      offsets.emplace_back(com - p.dot(axes.a) * axes.a - p.dot(axes.b) * axes.b);
    }
    for (const Vector3& offset : offsets) {
      const GripperPick pick = judge_gripper_pick(gripper, seal_margin, face, yaw, offset, gravity);
      if (pick.cups.empty()) continue;
      Vector3 middle = Vector3::Zero();  // of those that seal, over the centre of mass
      for (const std::size_t cup : pick.cups) middle += R_PE * gripper.cups[cup].p_EC;
      middle /= static_cast<double>(pick.cups.size());
      const Vector3 centred = com - middle.dot(axes.a) * axes.a - middle.dot(axes.b) * axes.b;
      for (const GripperPick& one :
           std::array{pick, judge_gripper_pick(gripper, seal_margin, face, yaw, centred, gravity)}) {
        if (!one.cups.empty() && (!best || one.hold_factor > (1.0 + kEqual) * best->hold_factor)) best = one;
      }
    }
  }
  return best;
}

}  // namespace snug::skills
