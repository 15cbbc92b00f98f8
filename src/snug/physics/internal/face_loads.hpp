// Face loads: how a face shares what it carries among the points of its contact patch, and how far out that acts.
#pragma once

#include <span>

namespace snug::physics {
struct WorldModel;
enum class Bearing;
}  // namespace snug::physics

namespace snug::physics::internal {

struct Contact;

/// A point of a patch, in the plane of the patch.
struct FaceLoad {
  double x = 0.0, y = 0.0;  ///< m
  double load = 0.0;        ///< N s, of the step before
  double weight = 1.0;      ///< of its share, as the area that belongs to it
  bool bears = true;
  int index = 0;  ///< of the contact, within its patch
};

/// Whether the contact carried something in the step before, or touches in this one.
[[nodiscard]] bool bears(const WorldModel& model, const Contact& contact, double load);

/// Weights of the points of one patch: its area over their number, 0 where they do not bear.
void weigh_by_area(std::span<FaceLoad> points);

/// The loads with the same sum and moments and the least sum of load^2 / weight, none negative: affine in the place but
/// for points that carry nothing. False: they were that already, or could not be found; the loads are as before.
bool even_loads(std::span<FaceLoad> points);

/// What loads are together.
struct FaceWrench {
  double sum = 0.0, x = 0.0, y = 0.0;  ///< N s; N s m, load times place
};
[[nodiscard]] FaceWrench wrench_of(std::span<const FaceLoad> points);
/// The same for loads that are to have another sum and other moments.
bool even_loads(std::span<FaceLoad> points, const FaceWrench& wrench);

/// Where a patch bears, and how far out.
struct FaceSpread {
  double x = 0.0, y = 0.0;  ///< m, middle of the area, of the rim
  double distance = 0.0;    ///< m, mean distance of an even pressure from the middle
};

/// Of a convex polygon with the given corners, at least 1 and at most kMaxManifoldPoints. Puts these in order around
/// it.
[[nodiscard]] FaceSpread spread_of(std::span<FaceLoad> corners, Bearing bearing);

/// Loads of the corners that together are 1 in the middle, as even as can be.
void share_unit_load(std::span<FaceLoad> corners, const FaceSpread& middle);

}  // namespace snug::physics::internal
