// Footprint: a rectangle on the floor, turned.
#include "snug/runs/internal/footprint.hpp"

#include <algorithm>
#include <limits>

namespace snug::runs::internal {
namespace {

/// Whether the other is less than `gap` beyond every edge of this one.
bool is_across(const Footprint& one, const Footprint& other, double gap) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Eigen::Vector2d& corner : other.corners()) {
    const Eigen::Vector2d p = Eigen::Rotation2Dd(-one.yaw) * (corner - one.middle);
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (low.array() < one.half.array() + gap).all() && (high.array() > -one.half.array() - gap).all();
}

}  // namespace

std::array<Eigen::Vector2d, 4> Footprint::corners() const {
  const Eigen::Rotation2Dd turn(yaw);
  std::array<Eigen::Vector2d, 4> all;
  for (std::size_t i = 0; i < all.size(); ++i)
    all[i] =
        middle + turn * Eigen::Vector2d((i & 1U) != 0 ? half.x() : -half.x(), (i & 2U) != 0 ? half.y() : -half.y());
  return all;
}

bool Footprint::is_near(const Footprint& other, double gap) const {
  return is_across(*this, other, gap) && is_across(other, *this, gap);
}

bool Footprint::holds(const Footprint& other) const {
  constexpr double kRounding = 1e-9;  // m
  return std::ranges::all_of(other.corners(), [&](const Eigen::Vector2d& corner) {
    const Eigen::Vector2d p = Eigen::Rotation2Dd(-yaw) * (corner - middle);
    return (p.cwiseAbs().array() <= half.array() + kRounding).all();
  });
}

}  // namespace snug::runs::internal
