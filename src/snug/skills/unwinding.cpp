// Unwinding: rows in between that keep a robot's wrist from winding up and its tool from its own base.
#include "snug/skills/unwinding.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/motion/tool_yaw.hpp"

namespace snug::skills {
namespace {

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace

std::vector<motion::Waypoint> with_turns(const motion::Waypoint& before, const std::vector<motion::Waypoint>& rows,
                                         const Unwinding& unwinding) {
  const double neutral_yaw = unwinding.neutral_yaw;
  const bool on_the_way = unwinding.on_the_way;
  std::vector<motion::Waypoint> turned;
  const motion::Waypoint* last = &before;
  Pose X_WE_last = before.X_WE;
  for (const motion::Waypoint& row : rows) {
    const Pose X_WE = row.X_WE;
    const std::optional<double> from = motion::yaw_of(X_WE_last.R), to = motion::yaw_of(X_WE.R);
    if (from && to) {
      const double turn = wrapped(*to - neutral_yaw) - wrapped(*from - neutral_yaw);
      const motion::Way way(X_WE_last, on_the_way ? X_WE : X_WE_last, unwinding.pan_axis);
      const int parts = static_cast<int>(std::ceil(std::abs(turn - way.pan()) / unwinding.sure_turn));
      for (int i = 1; i < parts; ++i) {
        const double share = static_cast<double>(i) / parts;
        motion::Waypoint between = *last;
        between.X_WE = {exp_rotation(Vector3(0.0, 0.0, share * turn)) * X_WE_last.R, way.at(share).p};
        if (on_the_way) between.io = row.io;
        between.variant += "_turn";
        turned.push_back(between);
      }
    }
    turned.push_back(row);
    last = &row;
    X_WE_last = X_WE;
  }
  return turned;
}

std::vector<motion::Waypoint> with_detours(const motion::Waypoint& before, const std::vector<motion::Waypoint>& rows,
                                           const Vector3& p_WB, double least, double room) {
  std::vector<motion::Waypoint> led;
  const motion::Waypoint* last = &before;
  Pose X_WE_last = before.X_WE;
  for (const motion::Waypoint& row : rows) {
    const Pose X_WE = row.X_WE;
    const Vector3 from = X_WE_last.p, way = X_WE.p - from;
    const double length = way.head<2>().norm();
    const double share = length > 0.0 ? way.head<2>().dot((p_WB - from).head<2>()) / (length * length) : 0.0;
    const Vector3 off = from + share * way - p_WB;
    const double distance = off.head<2>().norm();
    const bool points_down = motion::yaw_of(X_WE_last.R) && motion::yaw_of(X_WE.R);
    if (points_down && length > least && share > 0.0 && share < 1.0 && distance < least && distance > 1e-6) {
      Pose X_WE_between;
      X_WE_between.p.head<2>() = p_WB.head<2>() + (room / distance) * off.head<2>();
      X_WE_between.p.z() = std::max(from.z(), X_WE.p.z());
      X_WE_between.R = exp_rotation(share * log_rotation(X_WE.R * X_WE_last.R.transpose())) * X_WE_last.R;
      motion::Waypoint between = *last;
      between.X_WE = X_WE_between;
      between.variant += "_around";
      led.push_back(between);
    }
    led.push_back(row);
    last = &row;
    X_WE_last = X_WE;
  }
  return led;
}

}  // namespace snug::skills
