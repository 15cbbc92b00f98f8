// Virtual experiments: rest by cup::settle, swings by simulate_swing.
#include "snug/identification/virtual_experiments.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/free_swing.hpp"
#include "snug/identification/internal/at_rest.hpp"

namespace snug::identification {
namespace {

using internal::normal3;

constexpr double kMostBend = 35.0 * std::numbers::pi / 180.0;

Pose with_noise(const Pose& X_ES, const MeasurementNoise& noise, Rng& rng) {
  const Vector3 shift = normal3(rng, noise.position);
  return {X_ES.R * exp_rotation(normal3(rng, noise.rotation)), X_ES.p + shift};
}

cup::HeldLoad draw_load(const Matrix6& K, const CupFrames& frames, Rng& rng) {
  cup::HeldLoad load;
  const double heading = rng.uniform(-std::numbers::pi, std::numbers::pi);
  const double tilt = rng.uniform(0.0, 75.0 * std::numbers::pi / 180.0);
  const double spin = rng.uniform(-std::numbers::pi, std::numbers::pi);
  const Matrix3 down = Vector3(1.0, -1.0, -1.0).asDiagonal();
  load.R_WE = exp_rotation(Vector3(std::cos(heading), std::sin(heading), 0.0) * tilt) * down *
              exp_rotation(Vector3(0.0, 0.0, spin));
  load.mass = rng.uniform(0.25, 2.2);
  load.p_SScm.x() = rng.uniform(-0.04, 0.04);
  load.p_SScm.y() = rng.uniform(-0.04, 0.04);
  load.p_SScm.z() = rng.uniform(0.03, 0.06);
  load.stiffness = K;
  load.X_ES2 = frames.X_ES2;
  load.X_SS1 = frames.X_SS1;
  return load;
}

}  // namespace

StaticPoses make_static_poses(const Matrix6& K, const CupFrames& frames, int count, Rng& rng) {
  StaticPoses poses;
  poses.source = "virtual experiment";
  poses.frames = frames;
  while (static_cast<int>(poses.poses.size()) < count) {
    const cup::HeldLoad load = draw_load(K, frames, rng);
    const cup::SettleResult rest = cup::settle(load);
    if (rest.status != cup::SettleStatus::Converged || !rest.is_stable || rest.bend > kMostBend) continue;
    StaticPose pose;
    pose.index = static_cast<int>(poses.poses.size());
    pose.where = poses.source + " " + std::to_string(pose.index);
    pose.X_ES = rest.X_ES;
    pose.load = KnownLoad{load.R_WE, load.mass, load.p_SScm};
    const Vector3 weight = load.mass * ((load.R_WE * rest.X_ES.R).transpose() * load.gravity_W);
    pose.wrench_S = -(Vector6() << weight, load.p_SScm.cross(weight)).finished();
    poses.poses.push_back(pose);
  }
  return poses;
}

Release make_pluck(const Pluck& pluck) {
  Release release;
  release.name = "virtual pluck";
  release.load_S = pluck.load_S;
  release.R_WE = Vector3(1.0, -1.0, -1.0).asDiagonal();
  release.frames = pluck.frames;
  release.K = pluck.K;
  const cup::SettleResult rest = internal::hang(pluck.load_S, release.R_WE, pluck.K, pluck.frames);
  Pose moved = rest.H;
  switch (pluck.direction) {
    case PluckDirection::Axial:
      moved.p.z() += pluck.amplitude;
      break;
    case PluckDirection::Lateral:
      moved.p.x() += pluck.amplitude;
      break;
    case PluckDirection::Bend:
      moved.R = moved.R * exp_rotation(Vector3(pluck.amplitude, 0.0, 0.0));
      break;
    case PluckDirection::Torsion:
      moved.R = moved.R * exp_rotation(Vector3(0.0, 0.0, pluck.amplitude));
      break;
  }
  const auto count = static_cast<int>(std::lround(pluck.duration * pluck.rate));
  for (int i = 0; i < count; ++i) release.times.push_back(i / pluck.rate);
  const FreeSwing swing{pluck.load_S, release.R_WE, pluck.frames, release.gravity_W, pluck.K, pluck.D};
  const Pose X_ES = pluck.frames.X_ES2 * moved * pluck.frames.X_SS1.inverse();
  for (const SwingSample& sample : simulate_swing(swing, X_ES, Vector6::Zero(), release.times))
    release.X_ES.push_back(sample.X_ES);
  return release;
}

void add_noise(StaticPoses& poses, const MeasurementNoise& noise, Rng& rng) {
  poses.noise = noise;
  poses.noise_is_given = true;
  for (StaticPose& pose : poses.poses) {
    pose.X_ES = with_noise(pose.X_ES, noise, rng);
    if (!pose.wrench_S) continue;
    pose.wrench_S->head<3>() += normal3(rng, noise.force);
    pose.wrench_S->tail<3>() += normal3(rng, noise.torque);
  }
}

void add_noise(Release& release, const MeasurementNoise& noise, Rng& rng) {
  release.noise = noise;
  release.noise_is_given = true;
  for (Pose& X_ES : release.X_ES) X_ES = with_noise(X_ES, noise, rng);
}

PluckDirection pluck_direction_of(std::string_view name) {
  constexpr std::pair<std::string_view, PluckDirection> kDirections[] = {{"axial", PluckDirection::Axial},
                                                                         {"lateral", PluckDirection::Lateral},
                                                                         {"bend", PluckDirection::Bend},
                                                                         {"torsion", PluckDirection::Torsion}};
  for (const auto& [known, direction] : kDirections)
    if (name == known) return direction;
  SNUG_CHECK(false, "a direction that there is not");
  return PluckDirection::Axial;
}

bool is_turn(PluckDirection direction) {
  return direction == PluckDirection::Bend || direction == PluckDirection::Torsion;
}

Pluck plan_pluck(const model::CupParams& cup, const Vector3& size, const SpatialInertia& box, PluckDirection direction,
                 std::optional<double> amplitude) {
  Pluck pluck;
  const Matrix3 R_SP = Vector3(1.0, -1.0, -1.0).asDiagonal();
  pluck.load_S = {box.mass, R_SP * (box.com - Vector3(0.0, 0.0, 0.5 * size.z())),
                  R_SP * box.inertia * R_SP.transpose()};
  pluck.frames = frames_of(cup);
  pluck.K = cup::as_matrix(cup.stiffness);
  pluck.D = cup::as_matrix(cup.damping);
  pluck.direction = direction;
  pluck.amplitude = amplitude.value_or(is_turn(direction) ? 0.1 : 0.004);
  constexpr double kMostPull = 0.03, kMostTurn = 0.6;  // m, rad: a cup of 50 mm, a law that ends at 45 degrees
  if (pluck.amplitude > (is_turn(direction) ? kMostTurn : kMostPull))
    throw InputError("command line", "--amplitude", fmt::format("{}", pluck.amplitude),
                     is_turn(direction) ? "0.6 rad or less" : "0.03 m or less");
  return pluck;
}

std::vector<Release> make_plucks(const Pluck& pluck, int count, const MeasurementNoise& noise, std::uint64_t seed) {
  Rng rng = Rng(seed).split("pluck");
  std::vector<Release> releases;
  for (int i = 0; i < count; ++i) {
    releases.push_back(make_pluck(pluck));
    add_noise(releases.back(), noise, rng);
  }
  return releases;
}

}  // namespace snug::identification
