// compare: a simulated motion less a recorded one.
#include "snug/identification/internal/motion_error.hpp"

#include <cmath>

#include "snug/record/archive.hpp"

namespace snug::identification::internal {
namespace {

/// Samples of a recording that count: the first is where the simulation starts from.
std::size_t first_sample(const model::SceneTask& task, const RecordedMotion& motion) {
  if (task.only_final_state) return motion.times.size() - 1;
  return task.start.from == model::StartFrom::Scenario ? 0 : 1;
}

int numbers_of(const model::SceneTask& task) { return (task.use_position ? 3 : 0) + (task.use_rotation ? 3 : 0); }

}  // namespace

Eigen::Index count_residuals(const model::SceneTask& task, const RecordedMotion& motion) {
  const std::size_t samples = (sample_count(task, motion) - first_sample_of(task, motion)) * motion.tracked.size();
  return static_cast<Eigen::Index>(samples) * numbers_of(task);
}

std::size_t first_sample_of(const model::SceneTask& task, const RecordedMotion& motion) {
  return std::min(first_sample(task, motion), sample_count(task, motion) - 1);
}

MotionError compare(const model::SceneTask& task, const RecordedMotion& motion, const SimulatedMotion& simulated,
                    const OwnValues& own) {
  MotionError error;
  error.failure = simulated.failure;
  if (!error.failure.empty()) return error;
  const std::size_t begin = first_sample_of(task, motion), end = sample_count(task, motion);
  const int numbers = numbers_of(task);
  error.residuals = Eigen::VectorXd::Zero(count_residuals(task, motion) + own_deviation(task).size());
  const double position_noise = task.position_noise / std::sqrt(static_cast<double>(motion.averaged));
  const double rotation_noise = position_noise / task.rotation_position_ratio;
  Eigen::Index at = 0;
  double count = 0.0;
  for (std::size_t b = 0; b < motion.tracked.size(); ++b) {
    const RecordedBody& body = motion.tracked[b];
    Vector3 shift = Vector3::Zero(), turn = Vector3::Zero();
    for (std::size_t k = begin; k < end; ++k, at += numbers) {
      const bool is_result = task.only_final_state && body.result;
      const record::PoseSample& recorded = is_result ? *body.result : body.poses[k];
      const record::PoseSample& predicted = simulated.bodies[b][k];
      if (!record::is_tracked(recorded) || !record::is_tracked(predicted)) continue;
      const Pose X = predicted.pose() * own.X_BM[b], M = recorded.pose();
      shift = X.p + own.bias - M.p;
      turn = log_rotation(M.R.transpose() * X.R);
      if (task.use_position) error.residuals.segment<3>(at) = shift / position_noise;
      if (task.use_rotation) error.residuals.segment<3>(at + (task.use_position ? 3 : 0)) = turn / rotation_noise;
      error.position += shift.norm();
      error.rotation += turn.norm();
      error.position_square += shift.squaredNorm();
      error.rotation_square += turn.squaredNorm();
      count += 1.0;
    }
    const double share = 1.0 / static_cast<double>(motion.tracked.size());
    error.end_position += share * shift.norm();
    error.end_rotation += share * turn.norm();
    error.right += turn.norm() <= task.right_within ? share : 0.0;
  }
  for (double* sum : {&error.position, &error.rotation, &error.position_square, &error.rotation_square})
    *sum /= std::max(count, 1.0);
  return error;
}

}  // namespace snug::identification::internal
