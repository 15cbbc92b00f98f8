// Unwinding: which way a tool turns that points down, so that the wrist of a robot never winds up.
#include "snug/motion/unwinding.hpp"

#include <cmath>
#include <numbers>

namespace snug::motion {
namespace {

constexpr double kSteepest = 0.866;  ///< cosine of 30 degrees
/// rad: a row may be left up to 25 degrees before it is reached (precision 0.05 m), so turns up to this are sure.
constexpr double kLargestTurn = 145.0 * std::numbers::pi / 180.0;

double wrapped(double angle) { return std::remainder(angle, 2.0 * std::numbers::pi); }

}  // namespace

std::optional<double> yaw_of(const Matrix3& R_WE) {
  if (R_WE(2, 2) > -kSteepest) return std::nullopt;
  return std::atan2(-R_WE(1, 0) - R_WE(0, 1), R_WE(1, 1) - R_WE(0, 0));
}

std::vector<Waypoint> with_turns(const Waypoint& before, const std::vector<Waypoint>& rows, double neutral_yaw) {
  std::vector<Waypoint> turned;
  const Waypoint* last = &before;
  for (const Waypoint& row : rows) {
    const std::optional<double> from = yaw_of(last->X_WE.R), to = yaw_of(row.X_WE.R);
    if (from && to) {
      const double turn = wrapped(*to - neutral_yaw) - wrapped(*from - neutral_yaw);
      const int parts = static_cast<int>(std::ceil(std::abs(turn) / kLargestTurn));
      for (int i = 1; i < parts; ++i) {
        Waypoint between = *last;
        between.X_WE.R = exp_rotation(Vector3(0.0, 0.0, turn * i / parts)) * last->X_WE.R;
        between.name += "_turn";
        turned.push_back(between);
      }
    }
    turned.push_back(row);
    last = &row;
  }
  return turned;
}

}  // namespace snug::motion
