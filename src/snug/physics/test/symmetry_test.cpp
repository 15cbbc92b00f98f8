// Symmetry: physics knows no left and right, no place, no direction in the plane and no order of bodies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scene.hpp"

namespace snug::physics::test {
namespace {

const Matrix3 kMirror = Vector3(1.0, -1.0, 1.0).asDiagonal();

struct Start {
  BodyModel body;
  Twist twist;
};

struct Scene {
  double restitution;
  std::vector<Start> starts;
};

/// A plate on three feet, its own mirror image: unlike on four corners, how it shares its weight is determined.
BodyModel tripod(const Vector3& p_WB) {
  BodyModel body = box({0.2, 0.15, 0.02}, 0.6, p_WB);
  const Vector3 feet[] = {{0.09, 0.0, -0.03}, {-0.08, 0.06, -0.03}, {-0.08, -0.06, -0.03}};
  for (const Vector3& foot : feet) {
    body.geoms.push_back({geometry::Capsule{0.01, 0.01}, Pose{Matrix3::Identity(), foot}, 0, true});
  }
  return body;
}

/// Bodies that slide and turn, hit each other off centre, or fall on an edge: 0.4 s before chaos matters. Not flat
/// boxes on a plane that slide while they turn: rigid bodies on four points leave open how these share the weight, and
/// with it the friction; results differ by millimetres then.
std::vector<Scene> scenes() {
  const Vector3 size(0.2, 0.15, 0.1);
  std::vector<Scene> all;
  all.push_back({0.0, {{tripod({0.0, 0.0, 0.05}), {Vector3(1.5, 0.4, 0.0), Vector3(0.0, 0.0, 6.0)}}}});
  all.push_back({0.4,
                 {{box(size, 0.5, {-0.2, 0.04, 0.5}), {Vector3(1.0, 0.2, 0.0), Vector3(1.0, -2.0, 0.5)}},
                  {box(size, 0.5, {0.2, 0.0, 0.5}), {Vector3(-1.0, 0.0, 0.3), Vector3(0.3, 0.0, -1.0)}}}});
  Start tilted{box(size, 0.5, {0.0, 0.0, 0.2}), {Vector3(0.2, 0.1, 0.0), Vector3::Zero()}};
  tilted.body.X_WB.R = exp_rotation(Vector3(0.3, 0.2, 0.1));
  all.push_back({0.0, {tilted}});
  return all;
}

/// Where bodies are after 0.4 s, in the order of the scene, when the scene was first changed by `change`.
template <class F>
std::vector<Pose> result(const Scene& scene, const std::vector<int>& order, const F& change) {
  std::vector<BodyModel> boxes;
  for (const int i : order) {
    BodyModel body = scene.starts[static_cast<std::size_t>(i)].body;
    body.X_WB = change(body.X_WB);
    boxes.push_back(body);
  }
  const WorldModel model = on_plane({0.3, scene.restitution, 0.0, 0.0}, boxes);
  Simulation run(model);
  for (std::size_t k = 0; k < order.size(); ++k) {
    Twist twist = scene.starts[static_cast<std::size_t>(order[k])].twist;
    const Pose zero = change(Pose{});
    const Vector3 tip = change(Pose{Matrix3::Identity(), twist.linear}).p - zero.p;
    // A rotation vector as the change sees it: through the rotation that it makes.
    const Matrix3 turned = change(Pose{exp_rotation(0.1 * twist.angular), Vector3::Zero()}).R * zero.R.transpose();
    set_twist(model, run.state, BodyId{static_cast<int>(k) + 1}, Twist{tip, 10.0 * log_rotation(turned)});
  }
  run.steps(400);
  std::vector<Pose> poses(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    poses[static_cast<std::size_t>(order[k])] = pose_of(model, run.state, BodyId{static_cast<int>(k) + 1});
  }
  return poses;
}

std::vector<int> natural_order(const Scene& scene) {
  std::vector<int> order;
  for (std::size_t i = 0; i < scene.starts.size(); ++i) order.push_back(static_cast<int>(i));
  return order;
}

/// Every step may leave 1e-7 m/s of residual at a contact, which adds up in 400 steps to 4e-5 m/s, over 0.4 s half of
/// that as way; a rocking box of 0.1 m half length multiplies it by e^(t sqrt(g / l)) = 52 at most.
constexpr double kWay = 0.5 * 4e-5 * 0.4 * 52.0;
constexpr double kTurn = kWay / 0.05;  // rad, on the shortest half edge

void expect_same(const std::vector<Pose>& poses, const std::vector<Pose>& expected) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_LT((poses[i].p - expected[i].p).norm(), kWay) << i;
    EXPECT_LT(angle_between(poses[i].R, expected[i].R), kTurn) << i;
  }
}

Pose same(const Pose& X) { return X; }
Pose mirrored(const Pose& X) { return {kMirror * X.R * kMirror, kMirror * X.p}; }

TEST(Symmetry, ScenesMove) {
  for (const Scene& scene : scenes()) {
    const std::vector<Pose> end = result(scene, natural_order(scene), same);
    for (std::size_t i = 0; i < end.size(); ++i) {
      EXPECT_GT((end[i].p - scene.starts[i].body.X_WB.p).norm(), 50.0 * kWay);  // otherwise the rest proves nothing
    }
  }
}

TEST(Symmetry, AMirroredSceneHasAMirroredResult) {
  for (const Scene& scene : scenes()) {
    std::vector<Pose> expected = result(scene, natural_order(scene), same);
    std::transform(expected.begin(), expected.end(), expected.begin(), mirrored);
    expect_same(result(scene, natural_order(scene), mirrored), expected);
  }
}

TEST(Symmetry, ASceneTurnedInThePlaneHasATurnedResult) {
  for (const Scene& scene : scenes()) {
    for (const double angle : {0.5, 1.5707963267948966, -2.8}) {
      const Pose g{exp_rotation(Vector3(0.0, 0.0, angle)), Vector3(0.7, -1.3, 0.0)};
      const auto moved = [&g](const Pose& X) { return g * X; };
      std::vector<Pose> expected = result(scene, natural_order(scene), same);
      std::transform(expected.begin(), expected.end(), expected.begin(), moved);
      expect_same(result(scene, natural_order(scene), moved), expected);
    }
  }
}

TEST(Symmetry, TheOrderOfBodiesDoesNotMatter) {
  for (const Scene& scene : scenes()) {
    std::vector<int> order = natural_order(scene);
    const std::vector<Pose> expected = result(scene, order, same);
    while (std::next_permutation(order.begin(), order.end())) expect_same(result(scene, order, same), expected);
  }
}

}  // namespace
}  // namespace snug::physics::test
