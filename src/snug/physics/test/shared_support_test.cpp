// Faces on several fixed geoms of one plane: what bears does not depend on their order, nor on how the plane is cut.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "scene.hpp"

namespace snug::physics::test {
namespace {

constexpr double kPi = std::numbers::pi;

BodyModel belt_at(double y, double speed) {
  BodyModel body = fixed_box({4.0, 0.5, 0.1}, {0.0, y, -0.05});
  body.geoms[0].surface_velocity = Vector3(speed, 0.0, 0.0);
  return body;
}

struct Turned {
  Vector3 p;
  double yaw = 0.0;  ///< rad, of the last step; below pi
};

Turned on_two_belts(bool swapped, double seconds) {
  WorldModel model = world({0.4, 0.0, 0.0, 0.0}, {0.4, 0.0, 0.0, 0.0});
  model.bodies = {belt_at(0.25, 0.3), belt_at(-0.25, -0.3)};
  if (swapped) std::swap(model.bodies[0], model.bodies[1]);
  model.bodies.push_back(box({0.4, 0.3, 0.1}, 3.0, {0.0, 0.0, 0.05}));
  model.finalize();
  Simulation run(model);
  run.steps(static_cast<int>(std::lround(seconds / model.settings.dt)));
  const Matrix3 R = run.body(2).quat_WB.toRotationMatrix();
  return {run.body(2).p_WBcm, std::atan2(R(1, 0), R(0, 0))};
}

TEST(SharedSupport, TwoBeltsTurnABoxOnTheSpotWhicheverIsListedFirst) {
  const Turned one = on_two_belts(false, 1.0), other = on_two_belts(true, 1.0);
  for (const Turned& turned : {one, other}) {
    EXPECT_LT(turned.p.head<2>().norm(), 1e-3);
    // Corners bear, which are farther out than a whole face: slower than the 58 to 72 degrees of pressure on all of it.
    EXPECT_GT(std::abs(turned.yaw), 40.0 * kPi / 180.0);
    EXPECT_LT(std::abs(turned.yaw), 72.0 * kPi / 180.0);
  }
  EXPECT_LT((one.p - other.p).norm(), 1e-3);
  EXPECT_NEAR(one.yaw, other.yaw, 0.5 * kPi / 180.0);
}

/// Yaw, rad, at which a box that spins at 8 rad/s comes to rest on a floor of n by n slabs of 0.6 m in all.
double spun_on(int n, bool reversed, const Vector3& size = {0.2, 0.2, 0.1}) {
  WorldModel model = world({0.3, 0.0, 0.0, 0.0}, {0.3, 0.0, 0.0, 0.0});
  const double side = 0.6 / n;
  for (int k = 0; k < n * n; ++k) {
    const int i = reversed ? n * n - 1 - k : k;
    model.bodies.push_back(
        fixed_box({side, side, 0.1}, {-0.3 + side * (i % n + 0.5) + 0.0123, -0.3 + side * (i / n + 0.5), -0.05}));
  }
  model.bodies.push_back(box(size, 1.0, {0.0, 0.0, 0.5 * size.z()}));
  model.finalize();
  Simulation run(model);
  const int last = n * n;
  run.body(last).angular_velocity = Vector3(0.0, 0.0, 8.0);
  run.steps(600);
  EXPECT_LT(run.body(last).angular_velocity.norm(), 1e-4);
  EXPECT_NEAR(run.body(last).p_WBcm.z(), 0.5 * size.z(), 1e-5);
  const Matrix3 R = run.body(last).quat_WB.toRotationMatrix();
  return std::atan2(R(1, 0), R(0, 0));
}

TEST(SharedSupport, ABoxSpunOnTilesTurnsAsOnOneSlab) {
  const double slab = spun_on(1, false);
  EXPECT_GT(slab, 20.0 * kPi / 180.0);
  for (const int n : {2, 3, 4, 12}) {
    SCOPED_TRACE(n);
    EXPECT_NEAR(spun_on(n, false), slab, 0.1 * kPi / 180.0);
    EXPECT_NEAR(spun_on(n, true), slab, 0.1 * kPi / 180.0);
  }
}

TEST(SharedSupport, LeavesABoxThatOverhangsOrTipsToItsOwnEdges) {
  // Two tables with a gap of 80 mm; the box bears on their outer parts, and tips off once its middle is past the edge.
  WorldModel model = world({0.4, 0.0, 0.0, 0.0}, {0.4, 0.0, 0.0, 0.0});
  model.bodies = {fixed_box({0.2, 0.4, 0.1}, {-0.14, 0.0, -0.05}), fixed_box({0.2, 0.4, 0.1}, {0.14, 0.0, -0.05}),
                  box({0.2, 0.2, 0.1}, 1.0, {0.0, 0.0, 0.05}), box({0.2, 0.2, 0.1}, 1.0, {0.0, 0.0, 0.15})};
  model.finalize();
  Simulation run(model);
  run.steps(500);
  EXPECT_LT((run.body(2).p_WBcm - Vector3(0.0, 0.0, 0.05)).norm(), 1e-6);
  EXPECT_LT((run.body(3).p_WBcm - Vector3(0.0, 0.0, 0.15)).norm(), 1e-6);

  model.bodies.resize(2);
  model.bodies.push_back(box({0.2, 0.2, 0.1}, 1.0, {0.245, 0.0, 0.05}));
  model.finalize();
  Simulation tips(model);
  tips.steps(1000);
  EXPECT_LT(tips.body(2).p_WBcm.z(), 0.0);
}

TEST(SharedSupport, CarriesTheWholeWeightAndLooksTheSameFromEitherSide) {
  const auto forces = [](bool swapped) {
    WorldModel model = world({0.4, 0.0, 0.0, 0.0}, {0.4, 0.0, 0.0, 0.0});
    model.bodies = {belt_at(0.25, 0.0), belt_at(-0.25, 0.0)};
    if (swapped) std::swap(model.bodies[0], model.bodies[1]);
    model.bodies.push_back(box({0.4, 0.3, 0.1}, 3.0, {0.0, 0.05, 0.05}));
    model.finalize();
    Simulation run(model);
    run.steps(100);
    std::array<double, 2> on{};
    for (const ContactReport& contact : run.work.contacts())
      on[contact.a.index == (swapped ? 1 : 0) ? 0 : 1] += contact.force_W.z();
    return on;
  };
  const auto one = forces(false), other = forces(true);
  // Rim of the box from y = -0.1 to 0.2: the middle, 0.05, is halfway.
  EXPECT_NEAR(one[0] + one[1], 3.0 * 9.81, 1e-3);
  EXPECT_NEAR(one[0], one[1], 1e-3);
  EXPECT_NEAR(one[0], other[0], 1e-3);
}

}  // namespace
}  // namespace snug::physics::test
