// Unwinding: rows in between that keep a robot's wrist from winding up and its tool from its own base.
#include "snug/skills/unwinding.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/motion/tool_yaw.hpp"
#include "snug/motion/way.hpp"

namespace snug::skills {
namespace {

/// rad: a row may be left up to 25 degrees before it is reached (precision 0.05 m), so turns up to this are sure.
constexpr double kSureTurn = 145.0 * std::numbers::pi / 180.0;

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace

std::vector<motion::Waypoint> with_turns(const motion::Waypoint& before, const std::vector<motion::Waypoint>& rows,
                                         double neutral_yaw, bool on_the_way, const std::optional<Vector3>& p_WB) {
  std::vector<motion::Waypoint> turned;
  const motion::Waypoint* last = &before;
  for (const motion::Waypoint& row : rows) {
    const std::optional<double> from = motion::yaw_of(last->X_WE.R), to = motion::yaw_of(row.X_WE.R);
    if (from && to) {
      const double turn = wrapped(*to - neutral_yaw) - wrapped(*from - neutral_yaw);
      const motion::Way way(last->X_WE, on_the_way ? row.X_WE : last->X_WE, p_WB);
      const int parts = static_cast<int>(std::ceil(std::abs(turn - way.pan()) / kSureTurn));
      for (int i = 1; i < parts; ++i) {
        const double share = static_cast<double>(i) / parts;
        motion::Waypoint between = *last;
        between.X_WE.R = exp_rotation(Vector3(0.0, 0.0, share * turn)) * last->X_WE.R;
        between.X_WE.p = way.at(share).p;
        if (on_the_way) between.io = row.io;
        between.name += "_turn";
        turned.push_back(between);
      }
    }
    turned.push_back(row);
    last = &row;
  }
  return turned;
}

std::vector<motion::Waypoint> with_detours(const motion::Waypoint& before, const std::vector<motion::Waypoint>& rows,
                                           const Vector3& p_WB, double least, double room) {
  std::vector<motion::Waypoint> led;
  const motion::Waypoint* last = &before;
  for (const motion::Waypoint& row : rows) {
    const Vector3 from = last->X_WE.p, way = row.X_WE.p - from;
    const double length = way.head<2>().norm();
    const double share = length > 0.0 ? way.head<2>().dot((p_WB - from).head<2>()) / (length * length) : 0.0;
    const Vector3 off = from + share * way - p_WB;
    const double distance = off.head<2>().norm();
    const bool points_down = motion::yaw_of(last->X_WE.R) && motion::yaw_of(row.X_WE.R);
    if (points_down && length > least && share > 0.0 && share < 1.0 && distance < least && distance > 1e-6) {
      motion::Waypoint between = *last;
      between.X_WE.p.head<2>() = p_WB.head<2>() + (room / distance) * off.head<2>();
      between.X_WE.p.z() = std::max(from.z(), row.X_WE.p.z());
      between.X_WE.R = exp_rotation(share * log_rotation(row.X_WE.R * last->X_WE.R.transpose())) * last->X_WE.R;
      between.name += "_around";
      led.push_back(between);
    }
    led.push_back(row);
    last = &row;
  }
  return led;
}

}  // namespace snug::skills
