#include "peers/many_boxes.hpp"

#include <numbers>
#include <utility>

#include "peers/penetration.hpp"
#include "peers/timed_run.hpp"
#include "snug/core/rng.hpp"

namespace snug::peers {

namespace {

std::vector<Pose> poses_of(const Engine& engine, const Scene& scene) {
  std::vector<Pose> poses;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const BoxBody& box = scene.bodies[i];
    poses.push_back(box.mass > 0 ? engine.pose(static_cast<int>(i)) : box.X_WB);
  }
  return poses;
}

/// A pose above everything present, inside the walls, at a random yaw.
Pose drop_pose(const Scene& scene, const std::vector<Pose>& poses, std::size_t body, Rng& rng) {
  const Vector3& half = scene.bodies[body].half;
  const double yaw = rng.uniform(0.0, 2.0 * std::numbers::pi), c = std::abs(std::cos(yaw)), s = std::abs(std::sin(yaw));
  const double room_x = kContainerHalf.x() - (c * half.x() + s * half.y());
  const double room_y = kContainerHalf.y() - (s * half.x() + c * half.y());
  double top = 0.0;
  for (std::size_t i = 0; i < body; ++i) {
    top = std::max(top, 2.0 * poses[i].p.z() - lowest_corner(scene.bodies[i].half, poses[i]));
  }
  Pose X_WB{exp_rotation({0, 0, yaw}), Vector3::Zero()};
  X_WB.p.x() = rng.uniform(-room_x, room_x);
  X_WB.p.y() = rng.uniform(-room_y, room_y);
  X_WB.p.z() = top + 0.050 + half.z();
  return X_WB;
}

constexpr int kDropSeeds = 5;

struct DropFigures {
  Largest depth, late_speed;
  double mean_us = 0.0;
  int failures = 0;
};

void drop_boxes(Engine& engine, unsigned seed, DropFigures& figures) {
  constexpr int kInterval = 500, kSteps = 8000, kLate = 1000;  // steps
  const Scene scene = dropped_scene(seed);
  Rng rng = Rng(seed).split("places");
  engine.build(scene, kDt);
  std::vector<bool> present;
  for (const BoxBody& box : scene.bodies) present.push_back(box.is_present);
  std::vector<Pose> poses(scene.bodies.size());
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = scene.bodies[i].X_WB;
  StepTimer timer(engine);
  for (int k = 0; k < kSteps; ++k) {
    const std::size_t next = static_cast<std::size_t>(k / kInterval);
    if (k % kInterval == 0 && next < 12) {
      engine.insert(static_cast<int>(next), drop_pose(scene, poses, next, rng));
      present[next] = true;
    }
    timer.time(1, [&] { engine.step(); });
    if (engine.has_failed()) {
      ++figures.failures;
      break;
    }
    for (std::size_t i = 0; i < 12 && present[i]; ++i) {
      poses[i] = engine.pose(static_cast<int>(i));
      const bool is_late = k >= static_cast<int>(i) * kInterval + kLate;
      if (is_late) figures.late_speed.see(engine.velocity(static_cast<int>(i)).linear.norm());
    }
    figures.depth.see(worst_depth(scene, poses, present));
  }
  figures.mean_us += timer.mean_us() / kDropSeeds;
}

}  // namespace

std::vector<Result> measure_stack(Engine& engine) {
  const Scene scene = stacked_scene();
  const std::vector<bool> present(scene.bodies.size(), true);
  engine.build(scene, kDt);
  StepTimer timer(engine);
  Largest depth, drift;
  std::vector<Pose> start;
  for (int tenth = 1; tenth <= 100; ++tenth) {
    timer.time(100, [&] { run(engine, 0.1); });
    if (tenth < 20) continue;
    const std::vector<Pose> poses = poses_of(engine, scene);
    if (tenth == 20) start = poses;
    depth.see(worst_depth(scene, poses, present));
    for (std::size_t i = 0; i < poses.size(); ++i) drift.see((poses[i].p - start[i].p).norm());
  }
  return {{"s1.awake.us_per_step", timer.best_us(), "us"},
          {"s1.awake.penetration_mm", 1e3 * depth.value(), "mm"},
          {"s1.awake.drift_mm", 1e3 * drift.value(), "mm"}};
}

std::vector<Result> measure_drop(Engine& engine) {
  DropFigures figures;
  for (unsigned seed = 1; seed <= kDropSeeds; ++seed) drop_boxes(engine, seed, figures);
  return {{"s2.worst_penetration_mm", 1e3 * figures.depth.value(), "mm"},
          {"s2.late_speed_m_s", figures.late_speed.value(), "m/s"},
          {"s2.failed_runs", static_cast<double>(figures.failures), "1"},
          {"s2.mean_us_per_step", figures.mean_us, "us"}};
}

std::vector<Result> measure_standing(Engine& engine, const std::string& name, const Scene& scene) {
  const std::vector<bool> present(scene.bodies.size(), true);
  engine.build(scene, kDt);
  StepTimer timer(engine);
  Largest depth, drift;
  for (int tenth = 1; tenth <= 50; ++tenth) {
    timer.time(100, [&] { run(engine, 0.1); });
    const std::vector<Pose> poses = poses_of(engine, scene);
    depth.see(engine.has_failed() ? std::numeric_limits<double>::quiet_NaN() : worst_depth(scene, poses, present));
    for (std::size_t i = 0; i < poses.size(); ++i) drift.see((poses[i].p - scene.bodies[i].X_WB.p).norm());
  }
  return {{name + ".us_per_body_and_step", timer.mean_us() / static_cast<double>(scene.bodies.size()), "us"},
          {name + ".penetration_mm", 1e3 * depth.value(), "mm"},
          {name + ".drift_mm", 1e3 * drift.value(), "mm"}};
}

std::vector<Result> measure_pile(Engine& engine, const std::string& name, const PileSettings& pile, double duration) {
  constexpr double kStep = 2e-3;                       // s
  constexpr int kLookEvery = 20, kLooksPerWindow = 5;  // steps; at depths, which take long
  const Scene scene = pile_scene(pile.count, pile.side, pile.seed);
  engine.build(scene, kStep);
  const std::vector<bool> present(scene.bodies.size(), true);
  const double steps_and_bodies = kLookEvery * static_cast<double>(pile.count);
  const int looks = static_cast<int>(std::lround(duration / kStep)) / kLookEvery;
  Largest depth, worst;
  double spent = 0.0, window = 0.0;
  for (int k = 1; k <= looks; ++k) {
    const double begin = engine.cpu_seconds();
    for (int i = 0; i < kLookEvery; ++i) engine.step();
    window += engine.cpu_seconds() - begin;
    depth.see(engine.has_failed() ? std::numeric_limits<double>::quiet_NaN()
                                  : worst_depth(scene, poses_of(engine, scene), present));
    if (k % kLooksPerWindow != 0) continue;
    worst.see(1e6 * window / (kLooksPerWindow * steps_and_bodies));
    spent += std::exchange(window, 0.0);
  }
  return {{name + ".us_per_body_and_step", 1e6 * spent / (looks * steps_and_bodies), "us"},
          {name + ".worst_window_us", worst.value(), "us"},
          {name + ".worst_penetration_mm", 1e3 * depth.value(), "mm"}};
}

}  // namespace snug::peers
