// Rpy: each order reads back the rotation it wrote, and xyz is that of URDF.
#include "snug/click/rpy.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "snug/core/rng.hpp"

namespace snug::click {
namespace {

TEST(Rpy, ReadsBackEveryRotationInEveryOrder) {
  Rng rng = Rng(2).split("rpy");
  for (const char* word : {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"}) {
    const RpyOrder order = *parse_rpy_order(word);
    for (int i = 0; i < 200; ++i) {
      const Matrix3 R = exp_rotation(Vector3(rng.uniform(-3, 3), rng.uniform(-3, 3), rng.uniform(-3, 3)));
      EXPECT_LT((rotation_of(rpy_of(R, order), order) - R).norm(), 1e-9) << word;
    }
    Vector3 locked(0.4, 0.4, 0.4);  // the second angle at its end: the others turn about one line
    locked[order.axes[1]] = 0.5 * std::numbers::pi;
    const Matrix3 R = rotation_of(locked, order);
    EXPECT_LT((rotation_of(rpy_of(R, order), order) - R).norm(), 1e-7) << word;
  }
}

TEST(Rpy, IsThatOfUrdfByDefault) {
  const Matrix3 R = (Eigen::AngleAxisd(0.3, Vector3::UnitZ()) * Eigen::AngleAxisd(0.2, Vector3::UnitY()) *
                     Eigen::AngleAxisd(0.1, Vector3::UnitX()))
                        .toRotationMatrix();
  EXPECT_LT((rpy_of(R, RpyOrder{}) - Vector3(0.1, 0.2, 0.3)).norm(), 1e-12);
}

TEST(Rpy, KnowsSixOrders) {
  for (const char* word : {"", "xy", "xyx", "XYZ", "xyzz"}) EXPECT_FALSE(parse_rpy_order(word)) << word;
}

}  // namespace
}  // namespace snug::click
