// SceneExperiment: bodies that a recording drives, and what is unknown of their paths (docs/decisions/0112).
#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/core/rng.hpp"
#include "snug/identification/scene_experiment.hpp"
#include "snug/numerics/dense.hpp"

namespace snug::identification {
namespace {

// Chosen on pushed boxes, seeds 41 to 70: docs/decisions/0112, with what fewer draws and a factor of one did.
constexpr int kPathDraws = 32;              // of noise
constexpr double kPathFactor = 3.0;         // what is expected of a path, over what noise leaves in it
constexpr Eigen::Index kPathUnknowns = 16;  // of each recording

}  // namespace

void SceneExperiment::find_driven() {
  driven_.resize(motions_.size());
  if (task_.program) return;
  for (std::size_t m = 0; m < motions_.size(); ++m)
    for (const RecordedBody& body : motions_[m].kinematic)
      if (std::ranges::any_of(body.poses, record::is_tracked))
        driven_[m].push_back({smooth_path(motions_[m].times, body), {}});
  const auto is_noisy = [](const Driven& driven) {
    return driven.path.position.noise > 0.0 || driven.path.rotation.noise > 0.0;
  };
  if (task_.loss != model::TaskLoss::Squares ||
      std::ranges::none_of(driven_, [&](const auto& bodies) { return std::ranges::any_of(bodies, is_noisy); }))
    return;
  // What noise leaves in the paths, all draws together as large as one, and what smoothing does where they bend.
  const Eigen::VectorXd whole = kPathFactor * Eigen::VectorXd::Ones(1);
  const Eigen::VectorXd share = whole / std::sqrt(static_cast<double>(kPathDraws));
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    Rng rng = Rng(task_.search.seed).split("driven bodies").split(motions_[m].name);
    for (Driven& driven : driven_[m]) {
      for (int k = 0; k < kPathDraws; ++k)
        driven.modes.push_back(moved_towards(driven.path, {draw_again(driven.path, rng)}, share));
      driven.modes.push_back(moved_towards(driven.path, {smooth_again(driven.path)}, whole));
    }
  }
  path_unknowns_ = kPathDraws + 1;
  keep_largest_modes();
}

void SceneExperiment::keep_largest_modes() {
  // Principal directions of what the modes do to the tracked bodies, at the start values.
  const std::vector<Eigen::VectorXd> points{start()};
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(own_deviation().size());
  std::vector<Job> jobs;
  for (std::size_t m = 0; m < motions_.size(); ++m)
    for (int k = 0; k <= path_unknowns_; ++k) {
      jobs.push_back({0, m, none});
      if (k > 0) jobs.back().own[none.size() - path_unknowns_ + k - 1] = 1.0;
    }
  const std::vector<MotionError> errors = evaluate(points, jobs);
  const auto each = static_cast<std::size_t>(path_unknowns_) + 1;
  for (std::size_t m = 0; m < motions_.size(); ++m) {
    const Eigen::VectorXd& middle = errors[m * each].residuals;
    Eigen::MatrixXd effects = Eigen::MatrixXd::Zero(samples_of(m), path_unknowns_);
    for (Eigen::Index k = 0; k < path_unknowns_; ++k) {
      const Eigen::VectorXd& moved = errors[m * each + 1 + static_cast<std::size_t>(k)].residuals;
      if (moved.size() > 0 && moved.size() == middle.size()) effects.col(k) = (moved - middle).head(effects.rows());
    }
    const Eigen::MatrixXd shares =
        numerics::symmetric_eigenpairs(numerics::transposed_product(effects, effects)).vectors;
    for (Driven& driven : driven_[m]) {
      std::vector<DrivenPath> kept;
      for (Eigen::Index k = 0; k < kPathUnknowns; ++k)
        kept.push_back(moved_towards(driven.path, driven.modes, shares.col(path_unknowns_ - 1 - k)));
      driven.modes = std::move(kept);
    }
  }
  path_unknowns_ = kPathUnknowns;
}

std::vector<DrivenPath> SceneExperiment::driven_of(std::size_t motion, const Eigen::VectorXd& shares) const {
  std::vector<DrivenPath> paths;
  for (const Driven& driven : driven_[motion]) paths.push_back(moved_towards(driven.path, driven.modes, shares));
  return paths;
}

}  // namespace snug::identification
