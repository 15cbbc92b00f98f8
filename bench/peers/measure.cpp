// Measure: which scene is measured how, and the figures of S3 to S8.
#include "peers/measure.hpp"

#include <ctime>
#include <numbers>
#include <optional>

#include "peers/many_boxes.hpp"
#include "peers/planar.hpp"
#include "peers/spring.hpp"
#include "peers/timed_run.hpp"

namespace snug::peers {

namespace {

constexpr double kSettle = 0.5;  // s, before a push
constexpr double kDegree = std::numbers::pi / 180.0;

std::vector<Result> measure_slide(Engine& engine) {
  constexpr double kFriction = 0.2;
  std::vector<Result> results;
  for (const double heading_deg : {0.0, 22.5, 45.0}) {
    engine.build(sliding_scene(0.0), kDt);
    run(engine, kSettle);
    const double heading = heading_deg * kDegree;
    const Pose from = engine.pose(0);
    engine.set_motion(0, from, {{std::cos(heading), std::sin(heading), 0.0}, Vector3::Zero()});
    run(engine, 1.0);
    const Vector3 way = engine.pose(0).p - from.p;
    const double expected = 1.0 / (2.0 * kFriction * kGravity);
    const std::string name = "s3." + std::to_string(static_cast<int>(heading_deg));
    results.push_back({name + ".error_percent", 100.0 * (way.head<2>().norm() / expected - 1.0), "%"});
    results.push_back({name + ".heading_error_deg", (std::atan2(way.y(), way.x()) - heading) / kDegree, "deg"});
  }
  engine.build(sliding_scene(kFriction / 2.0), kDt);
  run(engine, kSettle);
  const Vector3 from = engine.pose(0).p;
  run(engine, 10.0);
  results.push_back({"s3.creep_mm", 1e3 * (engine.pose(0).p - from).head<2>().norm(), "mm"});
  return results;
}

/// Height of the lower face's middle where it first turns back after the first impact, m; 0 if it never rises.
double rebound_height(Engine& engine, const Scene& scene) {
  double speed = 0.0;
  bool has_hit = false;
  for (int i = 0; i < 1500; ++i) {
    engine.step();
    const double next = engine.velocity(0).linear.z();
    has_hit = has_hit || next > speed;
    if (has_hit && speed > 0.0 && next <= 0.0) return engine.pose(0).p.z() - scene.bodies[0].half.z();
    speed = next;
  }
  return 0.0;
}

std::vector<Result> measure_bounce(Engine& engine) {
  const Scene scene = bouncing_scene();
  engine.build(scene, kDt);
  const double expected = 0.5 * 0.5 * 0.5;  // m, e^2 h
  return {{"s4.error_percent", 100.0 * (rebound_height(engine, scene) / expected - 1.0), "%"}};
}

/// Largest deflection of the swing at a step size; nothing if one exceeds `lost`, m.
std::optional<double> swing_peak(Engine& engine, const HeldScene& held, double dt, double lost) {
  engine.build(held.scene, dt);
  double peak = 0.0;
  for (int i = 0; i < std::lround(held.end / dt); ++i) {
    const HolderMotion end = held.holder((i + 1) * dt);
    engine.pull(held.held, held.spring, held.holder(i * dt), end);
    engine.step();
    const double deflection = spring_deflection(held.spring, end, engine.pose(held.held)).norm();
    if (!(deflection < lost)) return std::nullopt;
    peak = std::max(peak, deflection);
  }
  return peak;
}

std::vector<Result> measure_swing(Engine& engine) {
  const HeldScene held = swing_scene();
  const double converged = converged_peak_deflection(held);
  const auto error_percent = [&](double dt) {
    const std::optional<double> peak = swing_peak(engine, held, dt, 2.0 * converged);
    return peak ? 100.0 * (*peak / converged - 1.0) : std::numeric_limits<double>::quiet_NaN();
  };
  double stable = 0.0;
  for (int quarter = 4; quarter <= 80; ++quarter) {
    const double dt = 0.25e-3 * quarter;
    if (!swing_peak(engine, held, dt, 2.0 * converged)) break;
    stable = dt;
  }
  return {{"s5.converged_peak_mm", 1e3 * converged, "mm"},
          {"s5.peak_error_percent_at_1ms", error_percent(1e-3), "%"},
          {"s5.peak_error_percent_at_4ms", error_percent(4e-3), "%"},
          {"s5.stable_up_to_ms", 1e3 * stable, "ms"}};
}

struct GapFigures {
  Largest peak{};              ///< N
  double smallest_hold = 0.0;  ///< N, least mean over 0.1 s of the held box's most loaded pair, last 5 s
  double held_for = 0.0;       ///< s, from the end of the drive, that this mean stays above 200 N
  bool is_complete = false;
  double best_us = 0.0;
};

double most_loaded_pair(const Engine& engine, const HeldScene& held) {
  double force = engine.normal_force(held.held, kPlane);
  for (int other = 0; other < static_cast<int>(held.scene.bodies.size()); ++other) {
    if (other != held.held) force = std::max(force, engine.normal_force(held.held, other));
  }
  return force;
}

bool has_arrived(const HeldScene& held, const Pose& X_WB) {
  const Vector3& half = held.scene.bodies[static_cast<std::size_t>(held.held)].half;
  double highest = std::numeric_limits<double>::lowest();
  for (const double x : {-half.x(), half.x()}) {
    for (const double y : {-half.y(), half.y()}) highest = std::max(highest, (X_WB * Vector3(x, y, -half.z())).z());
  }
  return highest < 3e-3 && std::acos(std::min(1.0, X_WB.R(2, 2))) < kDegree;
}

GapFigures press_into_gap(Engine& engine, const HeldScene& held) {
  constexpr int kWindow = 100, kSkipped = 100, kHold = 5000;  // steps
  constexpr double kJam = 200.0;                              // N, of the 245 with which the spring can press
  engine.build(held.scene, kDt);
  GapFigures figures{.smallest_hold = std::numeric_limits<double>::max()};
  StepTimer timer(engine);
  double window = 0.0;
  const int steps = static_cast<int>(std::lround(held.end / kDt));
  for (int i = 0; i < steps; ++i) {
    timer.time(1, [&] {
      engine.pull(held.held, held.spring, held.holder(i * kDt), held.holder((i + 1) * kDt));
      engine.step();
    });
    const double force = most_loaded_pair(engine, held);
    if (i >= kSkipped) figures.peak.see(force);
    window += force / kWindow;
    if ((i + 1) % kWindow != 0) continue;
    if (i >= steps - kHold) {
      figures.smallest_hold = std::isnan(window) ? window : std::min(figures.smallest_hold, window);
      if (figures.smallest_hold > kJam) figures.held_for += kWindow * kDt;
    }
    window = 0.0;
  }
  figures.is_complete = has_arrived(held, engine.pose(held.held));
  figures.best_us = timer.best_us();
  return figures;
}

std::vector<Result> measure_gap(Engine& engine) {
  const GapFigures a = press_into_gap(engine, gap_scene(GapVariant::A));
  const GapFigures b = press_into_gap(engine, gap_scene(GapVariant::B));
  const GapFigures c = press_into_gap(engine, gap_scene(GapVariant::C));
  return {{"s6a.peak_force_N", a.peak.value(), "N"},
          {"s6a.completes", a.is_complete ? 1.0 : 0.0, "1"},
          {"s6b.peak_force_N", b.peak.value(), "N"},
          {"s6b.completes", b.is_complete ? 1.0 : 0.0, "1"},
          {"s6b.us_per_step", b.best_us, "us"},
          {"s6c.jam_force_N", c.smallest_hold, "N"},
          {"s6c.held_for_s", std::isnan(c.smallest_hold) ? c.smallest_hold : c.held_for, "s"},
          {"s6c.peak_force_N", c.peak.value(), "N"},
          {"s6c.passes_through", c.is_complete ? 1.0 : 0.0, "1"}};
}

/// Slides and turns on a plane, as the planar integral of an even pressure has it.
std::vector<Result> measure_turns(Engine& engine) {
  Largest way_percent, yaw_percent;
  const Scene scene = turning_scene();
  for (const PlanarMotion& start : {PlanarMotion{.velocity = {0.5, 0.0}, .rate = 4.0},
                                    {.velocity = {0.8, 0.3}, .rate = 3.0},
                                    {.velocity = {0.3, 0.0}, .rate = 6.0},
                                    {.velocity = {0.0, 1.0}, .rate = 10.0}}) {
    const PlanarMotion expected = planar_rest(start, scene.bodies[0].half.head<2>(), scene.box_container.friction);
    engine.build(scene, kDt);
    run(engine, kSettle);
    const Pose from = engine.pose(0);
    engine.set_motion(0, from, {{start.velocity.x(), start.velocity.y(), 0.0}, {0.0, 0.0, start.rate}});
    run(engine, 1.5);
    const Pose to = engine.pose(0);
    const Matrix3 turned = to.R * from.R.transpose();
    way_percent.see(100.0 * ((to.p - from.p).head<2>() - expected.position).norm() / expected.position.norm());
    yaw_percent.see(100.0 * std::abs(std::atan2(turned(1, 0), turned(0, 0)) / expected.yaw - 1.0));
  }
  return {{"s7.way_error_percent", way_percent.value(), "%"}, {"s7.turn_error_percent", yaw_percent.value(), "%"}};
}

/// Energy of a free body on a plane, over that of the same lying flat at rest, J.
double energy_above_flat(const Engine& engine, const Scene& scene) {
  const BoxBody& body = scene.bodies[0];
  const Pose X_WB = engine.pose(0);
  const Twist V_WB = engine.velocity(0);
  const Vector3 rate_B = X_WB.R.transpose() * V_WB.angular;
  return 0.5 * body.mass * V_WB.linear.squaredNorm() + 0.5 * moments_of(body).dot(rate_B.cwiseAbs2()) +
         body.mass * kGravity * (X_WB.p.z() - body.half.z());
}

/// Euler's disc: in steady motion for ever where nothing dissipates.
std::vector<Result> measure_disc(Engine& engine) {
  const Scene scene = disc_scene();
  engine.build(scene, kDt);
  // w along the diameter through the point of touch: w^2 = 4 g / (R sin a) of a thin disc, and what its thickness adds.
  engine.set_motion(0, scene.bodies[0].X_WB, {Vector3::Zero(), {-19.809088823063014, 0.0, 11.436782764396632}});
  const double start = energy_above_flat(engine, scene);
  run(engine, 1.0);
  const double lean = std::acos(std::clamp(engine.pose(0).R(2, 2), -1.0, 1.0)) / kDegree;
  return {{"s8.energy_after_1s_percent", 100.0 * energy_above_flat(engine, scene) / start, "%"},
          {"s8.lean_after_1s_deg", lean, "deg"}};
}

}  // namespace

double Engine::cpu_seconds() const {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<Pose> Engine::follow(int body, int count) {
  std::vector<Pose> poses;
  for (int i = 0; i < count; ++i) {
    step();
    if (has_failed()) return {};
    poses.push_back(pose(body));
  }
  return poses;
}

std::vector<Result> measure(Engine& engine, const std::string& scene) {
  if (scene == "s1") return measure_stack(engine);
  if (scene == "s2") return measure_drop(engine);
  if (scene == "s3") return measure_slide(engine);
  if (scene == "s4") return measure_bounce(engine);
  if (scene == "s5") return measure_swing(engine);
  if (scene == "s6") return measure_gap(engine);
  if (scene == "s7") return measure_turns(engine);
  if (scene == "s8") return measure_disc(engine);
  if (scene == "tower") return measure_standing(engine, scene, tower_scene());
  if (scene == "wall") return measure_standing(engine, scene, wall_scene());
  for (const PileSettings& pile : {PileSettings{100, 5, 1}, {300, 7, 2}, {1000, 11, 3}}) {
    if (scene == "pile" + std::to_string(pile.count)) return measure_pile(engine, scene, pile, 1.4);
    if (scene == "heap" + std::to_string(pile.count)) return measure_pile(engine, scene, pile, 4.0);
  }
  return {};
}

}  // namespace snug::peers
