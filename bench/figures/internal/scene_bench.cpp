// Scene bench: how accurate and how fast the physics is on the scenes S1 to S6 and on fields of columns.
#include "bench/figures/internal/scene_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "bench/figures/internal/cpu_time.hpp"
#include "snug/cell/scene.hpp"
#include "snug/core/check.hpp"
#include "snug/core/units.hpp"

namespace snug::bench::internal {
namespace {

using cell::Scene;
using physics::BodyId;

Figure is_true(std::string name, bool value) { return {std::move(name), value ? 1.0 : 0.0, "1", "= 1", value}; }

model::Scenario load(const BenchOptions& options, const std::string& file) {
  model::Scenario scenario = model::load_scenario(options.scenes / file);
  const bool sleeps = scenario.solver.sleep.enabled;
  scenario.solver.sleep.enabled = model::SolverSettings{}.sleep.enabled;
  SNUG_CHECK(scenario.solver == model::SolverSettings{}, "a bench scene must use the solver settings of everybody");
  scenario.solver.sleep.enabled = sleeps;
  return scenario;
}

int step_count(const Scene& scene, double seconds) {
  return static_cast<int>(std::lround(seconds / scene.world().model.settings.dt));
}

void advance(Scene& scene, double seconds) {
  for (int i = step_count(scene, seconds); i > 0; --i) (void)scene.advance();
}

Pose pose_of(const Scene& scene, BodyId body) { return physics::pose_of(scene.world().model, scene.state(), body); }

const geometry::Box* box_of(const physics::BodyModel& body, std::size_t geom) {
  return std::get_if<geometry::Box>(&body.geoms[geom].shape);
}

/// Largest overlap of any two boxes of different bodies, m.
double worst_overlap(const Scene& scene) {
  const auto& bodies = scene.world().model.bodies;
  double worst = 0.0;
  for (std::size_t a = 0; a < bodies.size(); ++a) {
    for (std::size_t b = a + 1; b < bodies.size(); ++b) {
      if (bodies[a].kind != physics::BodyKind::Dynamic && bodies[b].kind != physics::BodyKind::Dynamic) continue;
      if (!scene.state().bodies[a].is_present || !scene.state().bodies[b].is_present) continue;
      const Pose X_WA = pose_of(scene, BodyId{static_cast<int>(a)}), X_WB = pose_of(scene, BodyId{static_cast<int>(b)});
      for (std::size_t i = 0; i < bodies[a].geoms.size(); ++i) {
        for (std::size_t j = 0; j < bodies[b].geoms.size(); ++j) {
          const geometry::Box* box_a = box_of(bodies[a], i);
          const geometry::Box* box_b = box_of(bodies[b], j);
          if (box_a == nullptr || box_b == nullptr) continue;
          worst = std::max(worst, box_overlap(box_a->half, X_WA * bodies[a].geoms[i].X_BG, box_b->half,
                                              X_WB * bodies[b].geoms[j].X_BG));
        }
      }
    }
  }
  return worst;
}

/// Largest sum of the normal forces between `body` and one other body in the last step, N.
double pair_force(const Scene& scene, BodyId body) {
  std::vector<double> sums(scene.world().model.bodies.size(), 0.0);
  for (const physics::ContactReport& contact : scene.work().contacts()) {
    if (contact.a != body && contact.b != body) continue;
    const int other = contact.a == body ? contact.b.index : contact.a.index;
    sums[static_cast<std::size_t>(other)] += contact.n_AB_W.dot(contact.force_W);
  }
  return *std::max_element(sums.begin(), sums.end());
}

}  // namespace

Figure at_most(std::string name, double value, std::string unit, double limit) {
  return {std::move(name), value, std::move(unit), fmt::format("<= {}", limit), value <= limit};
}

void measure_stack(const BenchOptions& options, std::vector<Figure>& figures) {
  Scene scene(load(options, "s1-stack.yaml"));
  double best = std::numeric_limits<double>::infinity(), overlap = 0.0, drift = 0.0;
  std::vector<Vector3> reference;
  for (int second = 0; second < 10; ++second) {
    double used = 0.0;
    for (int tenth = 0; tenth < 10; ++tenth) {
      const double start = cpu_seconds();
      advance(scene, 0.1);
      used += cpu_seconds() - start;
      if (second >= 2) overlap = std::max(overlap, worst_overlap(scene));
    }
    best = std::min(best, used / step_count(scene, 1.0));
    if (second == 1) {
      for (const physics::BodyState& body : scene.state().bodies) reference.push_back(body.p_WBcm);
    }
  }
  for (std::size_t i = 0; i < reference.size(); ++i) {
    drift = std::max(drift, (scene.state().bodies[i].p_WBcm - reference[i]).norm());
  }
  figures.push_back(at_most("s1.awake.us_per_step", 1e6 * best, "us", 20.0));
  figures.push_back(at_most("s1.awake.penetration_mm", kMm * overlap, "mm", 0.01));
  figures.push_back(at_most("s1.awake.drift_mm", kMm * drift, "mm", 0.001));
  model::Scenario sleeping = load(options, "s1-stack.yaml");
  sleeping.solver.sleep.enabled = true;
  Scene asleep(sleeping);
  advance(asleep, 2.0);
  const double start = cpu_seconds();
  advance(asleep, 2.0);
  figures.push_back(
      at_most("s1.asleep.us_per_step", 1e6 * (cpu_seconds() - start) / step_count(asleep, 2.0), "us", 1.0));
}

void measure_drops(const BenchOptions& options, std::vector<Figure>& figures) {
  double worst = 0.0, late_speed = 0.0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    model::Scenario scenario = load(options, "s2-drop.yaml");
    scenario.drops->seed = seed;
    Scene scene(scenario);
    const double last_drop = scenario.drops->start + scenario.drops->interval * (scenario.drops->count - 1);
    for (int i = step_count(scene, scenario.duration); i > 0; --i) {
      (void)scene.advance();
      if (i % 5 == 0) worst = std::max(worst, worst_overlap(scene));
      if (scene.state().time(scene.world().model) < last_drop + 1.0) continue;
      for (const physics::BodyState& body : scene.state().bodies) {
        late_speed = std::max(late_speed, body.velocity.norm());
      }
    }
  }
  double used = 0.0;
  int steps = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {  // as peers are measured: nothing sleeps
    model::Scenario scenario = load(options, "s2-drop.yaml");
    scenario.drops->seed = seed;
    scenario.solver.sleep.enabled = false;
    Scene scene(scenario);
    const double start = cpu_seconds();
    advance(scene, scenario.duration);
    used += cpu_seconds() - start;
    steps += step_count(scene, scenario.duration);
  }
  figures.push_back(at_most("s2.worst_penetration_mm", kMm * worst, "mm", 1.0));
  figures.push_back(at_most("s2.late_speed_m_s", late_speed, "m/s", 2.5));
  figures.push_back(at_most("s2.mean_us_per_step", 1e6 * used / steps, "us", 30.0));
}

void measure_slides(const BenchOptions& options, std::vector<Figure>& figures) {
  const struct {
    const char* file;
    const char* name;
    double degrees;
  } slides[] = {
      {"s3-slide-0.yaml", "s3.0", 0.0}, {"s3-slide-22.yaml", "s3.22", 22.5}, {"s3-slide-45.yaml", "s3.45", 45.0}};
  for (const auto& slide : slides) {
    Scene scene(load(options, slide.file));
    const BodyId box{static_cast<int>(scene.world().model.bodies.size()) - 1};
    const Vector3 start = pose_of(scene, box).p;
    advance(scene, 1.0);
    const Vector3 way = pose_of(scene, box).p - start;
    const double expected = 1.0 / (2.0 * 0.2 * 9.81);
    const double heading = std::atan2(way.y(), way.x()) * 180.0 / std::numbers::pi;
    figures.push_back(at_most(std::string(slide.name) + ".error_percent",
                              100.0 * std::abs(way.head<2>().norm() / expected - 1.0), "%", 0.05));
    figures.push_back(
        at_most(std::string(slide.name) + ".heading_error_deg", std::abs(heading - slide.degrees), "deg", 0.01));
  }
  Scene creep(load(options, "s3-creep.yaml"));
  const BodyId box{static_cast<int>(creep.world().model.bodies.size()) - 1};
  advance(creep, 0.5);  // settled, as in the slides
  const Vector3 start = pose_of(creep, box).p;
  advance(creep, 10.0);
  figures.push_back(at_most("s3.creep_mm", kMm * (pose_of(creep, box).p - start).norm(), "mm", 1e-6));
}

void measure_bounce(const BenchOptions& options, std::vector<Figure>& figures) {
  Scene scene(load(options, "s4-bounce.yaml"));
  const BodyId box{static_cast<int>(scene.world().model.bodies.size()) - 1};
  const double start = pose_of(scene, box).p.z();
  double apex = -1.0;
  bool has_hit = false;
  for (int i = step_count(scene, 1.0); i > 0; --i) {
    (void)scene.advance();
    const double speed = scene.state().bodies[static_cast<std::size_t>(box.index)].velocity.z();
    has_hit = has_hit || speed > 0.0;
    if (has_hit && speed < 0.0) break;
    if (has_hit) apex = pose_of(scene, box).p.z() - (start - 0.5);
  }
  figures.push_back(at_most("s4.error_percent", 100.0 * std::abs(apex / 0.125 - 1.0), "%", 0.5));
}

namespace {

/// Largest distance between holder and attachment, m; infinite when the run fails.
double swing_peak(const BenchOptions& options, double dt) {
  model::Scenario scenario = load(options, "s5-swing.yaml");
  scenario.time_step = dt;
  Scene scene(scenario);
  const model::Spring& spring = scenario.springs.front();
  const BodyId box = cell::find_body(scene.world(), spring.body);
  double peak = 0.0;
  for (int i = step_count(scene, scenario.duration); i > 0; --i) {
    (void)scene.advance();
    const Pose X_WH = model::holder_at(spring, scene.state().time(scene.world().model)).X_WH;
    const double deflection = (X_WH.p - pose_of(scene, box) * spring.X_BS.p).norm();
    if (!(deflection < 1.0)) return std::numeric_limits<double>::infinity();
    peak = std::max(peak, deflection);
  }
  return peak;
}

}  // namespace

void measure_swing(const BenchOptions& options, std::vector<Figure>& figures) {
  const double converged = swing_peak(options, 0.25e-3);
  figures.push_back({"s5.converged_peak_mm", kMm * converged, "mm", "", true});
  figures.push_back(
      at_most("s5.peak_error_percent_at_4ms", 100.0 * std::abs(swing_peak(options, 4e-3) / converged - 1.0), "%", 3.0));
  figures.push_back(is_true("s5.stable_at_20ms", swing_peak(options, 20e-3) < 4.0 * converged));
}

namespace {

struct Press {
  double peak_force = 0.0, last_force = 0.0;
  bool is_complete = false;
};

Press press(const model::Scenario& scenario) {
  Scene scene(scenario);
  const BodyId held = cell::find_body(scene.world(), "held");
  Press result;
  for (int i = step_count(scene, scenario.duration); i > 0; --i) {
    (void)scene.advance();
    result.last_force = pair_force(scene, held);
    if (scene.state().time(scene.world().model) > 0.1)
      result.peak_force = std::max(result.peak_force, result.last_force);
  }
  const Pose X_WB = pose_of(scene, held);
  const Vector3 half = box_of(scene.world().model.bodies[static_cast<std::size_t>(held.index)], 0)->half;
  double highest_lower_corner = -1.0;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      highest_lower_corner =
          std::max(highest_lower_corner, (X_WB * Vector3(x * half.x(), y * half.y(), -half.z())).z());
    }
  }
  result.is_complete = highest_lower_corner < 3e-3 && X_WB.R(2, 2) > std::cos(std::numbers::pi / 180.0);
  return result;
}

/// The same scene with rigid boxes.
model::Scenario made_rigid(model::Scenario scenario) {
  for (model::ContactPair& pair : scenario.contact_pairs) pair.params.stiffness = pair.params.damping = std::nullopt;
  return scenario;
}

}  // namespace

void measure_press(const BenchOptions& options, std::vector<Figure>& figures) {
  const model::Scenario soft = load(options, "s6b.yaml");
  const Press a = press(load(options, "s6a.yaml")), b = press(soft), c = press(load(options, "s6c.yaml"));
  figures.push_back(at_most("s6a.peak_force_N", a.peak_force, "N", 20.0));
  figures.push_back(is_true("s6a.completes", a.is_complete));
  figures.push_back(at_most("s6b.peak_force_N", b.peak_force, "N", 70.0));
  figures.push_back(is_true("s6b.completes", b.is_complete));
  // Between rigid boxes a blow has an impulse but no force: what the step gives is impulse / dt.
  figures.push_back({"s6b.rigid_impulse_Ns", press(made_rigid(soft)).peak_force * soft.time_step, "Ns", "", true});
  figures.push_back(
      {"s6c.jam_force_N", c.last_force, "N", "245 +- 3", std::abs(c.last_force - 245.0) <= 3.0 && !c.is_complete});
}

namespace {

/// A field of columns, four boxes high, all awake. Levels are set off by 10 mm, so that boxes of neighbouring columns,
/// 2 mm apart, stand on each other.
model::Scenario pile_of(const model::Scenario& base, int count) {
  model::Scenario scenario = base;
  const model::Body box = scenario.bodies.back();  // the B1 of S4
  scenario.bodies.pop_back();
  const int side = std::max(3, static_cast<int>(std::ceil(std::sqrt(count / 4.0))));
  for (int i = 0; i < count; ++i) {
    const int column = i / 4, level = i % 4;
    model::Body copy = box;
    copy.name = fmt::format("box{}", i);
    const double middle = 0.5 * (side - 1);
    copy.X_WB.p = Vector3(0.202 * (column % side - middle) + 0.01 * (level % 2), 0.202 * (column / side - middle),
                          0.0485 + 0.0972 * level);
    copy.V_WB = Twist{};
    scenario.bodies.push_back(copy);
  }
  scenario.solver.sleep.enabled = false;
  return scenario;
}

/// Seconds of CPU per box and step.
double pile_cost(Scene& scene, int count, double seconds) {
  const double start = cpu_seconds();
  advance(scene, seconds);
  return (cpu_seconds() - start) / (step_count(scene, seconds) * count);
}

}  // namespace

void measure_growth(const BenchOptions& options, std::vector<Figure>& figures) {
  const model::Scenario base = load(options, "s4-bounce.yaml");
  Scene few(pile_of(base, 10)), many(pile_of(base, 1000));
  // While they land and come to rest, and then at rest: the best of forty parts in turn, because what else the machine
  // does with its caches comes and goes.
  const double settling = pile_cost(many, 1000, 0.3) / pile_cost(few, 10, 0.3);
  advance(few, 1.7);
  advance(many, 1.7);
  double least_few = std::numeric_limits<double>::infinity(), least_many = least_few;
  for (int part = 0; part < 40; ++part) {
    least_few = std::min(least_few, pile_cost(few, 10, 0.5));
    least_many = std::min(least_many, pile_cost(many, 1000, 0.05));
  }
  figures.push_back({"growth.10.us_per_box_and_step", 1e6 * least_few, "us", "", true});
  figures.push_back({"growth.1000.us_per_box_and_step", 1e6 * least_many, "us", "", true});
  figures.push_back(at_most("growth.ratio", least_many / least_few, "1", 1.5));
  figures.push_back({"growth.settling_ratio", settling, "1", "", true});
}

}  // namespace snug::bench::internal
