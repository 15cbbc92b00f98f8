// measure_camera: frames of boxes at rest with label truth, estimated from depth alone.
#include "bench/figures/internal/camera_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "bench/figures/internal/cpu_time.hpp"
#include "bench/figures/internal/scene_bench.hpp"
#include "snug/box_estimation/estimate.hpp"
#include "snug/camera/cast.hpp"
#include "snug/camera/render.hpp"
#include "snug/core/rng.hpp"

namespace snug::bench::internal {
namespace {

using box_estimation::BoxEstimate;
using box_estimation::Sight;

constexpr double kDegrees = 180.0 / std::numbers::pi;
/// Of the pixels that a box would show alone, those it shows: from here on it counts as visible.
constexpr double kVisiblePart = 0.5;
constexpr int kVisiblePixels = 1500;
constexpr int kHiddenPixels = 20;  ///< fewer than these: hidden
/// How far beliefs are from the truth in these trials: standard deviations, stated to the estimator.
constexpr double kBeliefPosition = 0.005, kBeliefRotation = 1.5 / kDegrees;

struct Visibility {
  int pixels = 0;
  double part = 0.0;
};

std::vector<Visibility> visibility(const camera::RenderedFrame& shot, const std::vector<int>& bodies,
                                   const std::vector<SceneBox>& boxes) {
  std::vector<Visibility> result(boxes.size());
  std::vector<int> pixels(shot.truth.names.size(), 0);
  for (const std::int16_t label : shot.truth.label.values())
    if (label >= 0) ++pixels[static_cast<std::size_t>(label)];
  const model::CameraParams& params = shot.frame.camera;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    if (bodies[i] < 0) continue;
    camera::Scene alone;
    camera::add_box(alone, "", boxes[i].X_WP, boxes[i].size);
    const camera::Cast cast =
        camera::cast(alone, {shot.truth.X_WC, params.intrinsics, params.height, params.width, 0, 0});
    const auto all = std::count_if(cast.surface.values().begin(), cast.surface.values().end(),
                                   [](std::int32_t s) { return s >= 0; });
    result[i].pixels = pixels[static_cast<std::size_t>(bodies[i])];
    result[i].part = all > 0 ? static_cast<double>(result[i].pixels) / static_cast<double>(all) : 0.0;
  }
  return result;
}

Vector3 normals(Rng& rng, double size) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return size * Vector3(x, y, z);
}

box_estimation::EstimateInput expect_boxes(const model::Scenario& scenario, const ToteScene& scene, Rng& rng) {
  const model::Container& container = *model::find_container(scenario, scenario.target);
  box_estimation::EstimateInput input = box_estimation::make_input(scenario, container);
  for (const SceneBox& box : scene.boxes) {
    const Pose belief{exp_rotation(normals(rng, kBeliefRotation)) * box.X_WP_before.R,
                      box.X_WP_before.p + normals(rng, kBeliefPosition)};
    input.boxes.push_back({box.id, box.size, belief, kBeliefPosition, kBeliefRotation});
  }
  return input;
}

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double at_part(const std::vector<double>& sorted, double part) {
  if (sorted.empty()) return 0.0;
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(part * static_cast<double>(sorted.size())))];
}

/// How far the corners of a box are from those of the same box elsewhere, m: the largest of the distances to the
/// nearest. Boxes with edges of nearly the same length are nearly the same turned.
double corner_distance(const Vector3& size, const Pose& X_WA, const Pose& X_WB) {
  double largest = 0.0;
  const auto corner = [&size](int i) {
    return Vector3(0.5 *
                   size.cwiseProduct(Vector3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1)));
  };
  for (int i = 0; i < 8; ++i) {
    double nearest = 1e9;
    for (int k = 0; k < 8; ++k) nearest = std::min(nearest, (X_WA * corner(i) - X_WB * corner(k)).norm());
    largest = std::max(largest, nearest);
  }
  return largest;
}

void judge_box(const SceneBox& box, const BoxEstimate& estimate, const Visibility& seen, const CameraTrial& trial,
               std::uint64_t seed, CameraScore& score) {
  const bool is_visible = seen.part >= kVisiblePart && seen.pixels >= kVisiblePixels;
  const bool is_seen = estimate.sight == Sight::Seen;
  if (box.is_gone) {
    ++score.disturbed;
    score.disturbed_found += estimate.sight == Sight::Missing ? 1 : 0;
    if (trial.print && estimate.sight != Sight::Missing)
      std::fprintf(stderr, "seed %llu %s taken but %s points %d\n", static_cast<unsigned long long>(seed),
                   box.id.c_str(), name_of(estimate.sight), estimate.points);
    return;
  }
  if (seen.pixels < kHiddenPixels) {
    ++score.hidden;
    score.hidden_seen += is_seen ? 1 : 0;
    if (trial.print && is_seen)
      std::fprintf(stderr, "seed %llu %s hidden but seen points %d\n", static_cast<unsigned long long>(seed),
                   box.id.c_str(), estimate.points);
  }
  const Matrix3 R = box_estimation::nearest_equal_rotation(estimate.X_WP.R, box.X_WP.R);
  const Vector3 off = estimate.X_WP.p - box.X_WP.p, turn = log_rotation(R * box.X_WP.R.transpose());
  if (is_seen && off.norm() > 0.02) ++score.wrong;
  if (is_visible && box.was_disturbed) {
    const bool has_moved =
        (box.X_WP.p - box.X_WP_before.p).norm() > 0.015 || angle_between(box.X_WP.R, box.X_WP_before.R) > 0.08;
    if (has_moved) {
      ++score.disturbed;
      const bool is_found = is_seen && corner_distance(box.size, estimate.X_WP, box.X_WP) < 0.010;
      if (trial.print && !is_found) std::fprintf(stderr, "not found: ");
      score.disturbed_found += is_found ? 1 : 0;
    }
  }
  if (trial.print && is_visible && (!is_seen || off.norm() > 0.004 || turn.norm() > 0.02))
    std::fprintf(stderr,
                 "seed %llu %s%s %s part %.2f px %d: off %.1f %.1f %.1f mm, %.2f %.2f %.2f deg, sigma %.2f %.2f %.2f "
                 "mm, %.2f deg; visible by estimate %.2f points %d rms %.2f mm\n",
                 static_cast<unsigned long long>(seed), box.id.c_str(), box.was_disturbed ? " (moved)" : "",
                 name_of(estimate.sight), seen.part, seen.pixels, 1e3 * off.x(), 1e3 * off.y(), 1e3 * off.z(),
                 kDegrees * turn.x(), kDegrees * turn.y(), kDegrees * turn.z(),
                 1e3 * std::sqrt(estimate.covariance(0, 0)), 1e3 * std::sqrt(estimate.covariance(1, 1)),
                 1e3 * std::sqrt(estimate.covariance(2, 2)), kDegrees * std::sqrt(estimate.covariance(5, 5)),
                 estimate.visible_part, estimate.points, 1e3 * estimate.rms);
  if (!is_visible) return;
  ++score.visible;
  if (!is_seen) return;
  ++score.visible_seen;
  score.position_mm.push_back(1e3 * off.norm());
  score.angle_deg.push_back(kDegrees * turn.norm());
  Vector6 error;
  error << off, turn;
  score.chi_square.push_back(error.dot(estimate.covariance.ldlt().solve(error)));
}

}  // namespace

CameraScore score_camera(const model::Scenario& scenario, const model::CameraParams& params, const CameraTrial& trial) {
  CameraScore score;
  std::vector<double> render_ms, estimate_ms;
  for (int i = 0; i < trial.scenes; ++i) {
    const std::uint64_t seed = trial.first_seed + static_cast<std::uint64_t>(i);
    const ToteScene scene = make_tote_scene(scenario, seed, trial.boxes, trial.disturbance);
    Rng rng = Rng(seed).split("camera trial");
    camera::Scene view = camera::make_surroundings(scenario);
    std::vector<int> bodies;
    for (const SceneBox& box : scene.boxes)
      bodies.push_back(box.is_gone ? -1 : camera::add_box(view, box.id, box.X_WP, box.size));
    const double start = cpu_seconds();
    const camera::RenderedFrame shot = camera::render(view, params, camera::draw_camera(params, seed), seed);
    render_ms.push_back(1e3 * (cpu_seconds() - start));
    const box_estimation::EstimateInput input = expect_boxes(scenario, scene, rng);
    const double begin = cpu_seconds();
    const box_estimation::Estimate estimate = box_estimation::estimate_boxes(shot.frame, input);
    estimate_ms.push_back(1e3 * (cpu_seconds() - begin));
    ++score.frames;
    score.foreign += static_cast<int>(estimate.obstacles.size());
    score.foreign_frames += estimate.obstacles.empty() ? 0 : 1;
    const std::vector<Visibility> seen = visibility(shot, bodies, scene.boxes);
    for (std::size_t k = 0; k < scene.boxes.size(); ++k)
      judge_box(scene.boxes[k], estimate.boxes[k], seen[k], trial, seed, score);
  }
  std::sort(score.position_mm.begin(), score.position_mm.end());
  std::sort(score.angle_deg.begin(), score.angle_deg.end());
  score.render_ms = median(render_ms);
  score.estimate_ms = median(estimate_ms);
  return score;
}

namespace {

// Settings of the estimator were chosen on seeds below 50000; these judge.
constexpr std::uint64_t kJudgeSeed = 50'000;
constexpr int kBoxes = 15;
constexpr int kScenes = 200;           // boxes of one frame share the camera's errors
constexpr int kDisturbedScenes = 100;  // of each kind: 99 % is one of them

double mean_chi_square(const CameraScore& score) {
  double sum = 0.0;
  for (const double value : score.chi_square) sum += value / 6.0;
  return score.chi_square.empty() ? 0.0 : sum / static_cast<double>(score.chi_square.size());
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(values.size()));
}

double percent(int part, int all) { return all > 0 ? 100.0 * part / all : 0.0; }

/// The frames of one camera, undisturbed. `has_targets`: those of the demonstrator's class.
void measure_at_rest(const model::Scenario& scenario, const model::CameraParams& camera, const std::string& name,
                     int boxes, bool has_targets, std::vector<Figure>& figures) {
  const CameraScore score = score_camera(scenario, camera, {kJudgeSeed, kScenes, boxes, Disturbance::None, false});
  const auto add = [&](const std::string& what, double value, const std::string& unit, double limit) {
    if (has_targets)
      figures.push_back(at_most(name + what, value, unit, limit));
    else
      figures.push_back({name + what, value, unit, "", true});
  };
  figures.push_back({name + "visible_boxes", static_cast<double>(score.visible), "boxes", "", true});
  add("position_median_mm", at_part(score.position_mm, 0.5), "mm", 1.0);
  add("position_p95_mm", at_part(score.position_mm, 0.95), "mm", 2.5);
  figures.push_back({name + "position_rms_mm", root_mean_square(score.position_mm), "mm", "", true});
  add("angle_median_deg", at_part(score.angle_deg, 0.5), "deg", 0.3);
  add("angle_p95_deg", at_part(score.angle_deg, 0.95), "deg", 0.7);
  figures.push_back({name + "angle_rms_deg", root_mean_square(score.angle_deg), "deg", "", true});
  figures.push_back({name + "seen_percent", percent(score.visible_seen, score.visible), "%", "", true});
  figures.push_back({name + "hidden_boxes", static_cast<double>(score.hidden), "boxes", "", true});
  add("hidden_seen_percent", percent(score.hidden_seen, score.hidden), "%", 0.1);
  figures.push_back({name + "more_than_20mm_off", static_cast<double>(score.wrong), "boxes", "", true});
  const double chi = mean_chi_square(score);
  if (has_targets)
    figures.push_back({name + "chi_square_per_degree", chi, "1", "0.9 .. 1.1", chi >= 0.9 && chi <= 1.1});
  else
    figures.push_back({name + "chi_square_per_degree", chi, "1", "", true});
  add("frame_ms", score.render_ms, "ms", 50.0);
  add("estimate_ms", score.estimate_ms, "ms", 300.0);
}

void measure_disturbed(const model::Scenario& scenario, const model::CameraParams& camera,
                       std::vector<Figure>& figures) {
  const std::pair<const char*, Disturbance> kinds[] = {
      {"moved", Disturbance::Moved}, {"tipped", Disturbance::Tipped}, {"taken", Disturbance::Taken}};
  std::uint64_t seed = kJudgeSeed + 200;
  for (const auto& [name, kind] : kinds) {
    const CameraScore score = score_camera(scenario, camera, {seed, kDisturbedScenes, kBoxes, kind, false});
    const double found = percent(score.disturbed_found, score.disturbed);
    figures.push_back({fmt::format("camera.{}.found_percent", name), found, "%", ">= 99", found >= 99.0});
    figures.push_back(
        {fmt::format("camera.{}.more_than_20mm_off", name), static_cast<double>(score.wrong), "boxes", "", true});
    seed += 200;
  }
}

}  // namespace

void measure_camera(const BenchOptions& options, std::vector<Figure>& figures) {
  const model::Scenario scenario = model::load_scenario(options.scenario);
  if (scenario.cameras.empty()) return;
  const model::CameraParams& camera = scenario.cameras.front();
  measure_at_rest(scenario, camera, "camera.rest.", kBoxes, true, figures);
  measure_at_rest(scenario, camera, "camera.alone.", 1, true, figures);
  measure_disturbed(scenario, camera, figures);
  model::CameraParams cheap = model::make_camera("active_stereo");
  cheap.name = camera.name;
  cheap.X_WC = camera.X_WC;
  measure_at_rest(scenario, cheap, "camera.active_stereo.", kBoxes, false, figures);
}

}  // namespace snug::bench::internal
