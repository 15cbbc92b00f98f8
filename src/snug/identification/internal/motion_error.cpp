// compare: a simulated motion less a recorded one.
#include "snug/identification/internal/motion_error.hpp"

#include <cmath>
#include <utility>

#include "snug/record/archive.hpp"

namespace snug::identification::internal {

int numbers_of(const model::SceneTask& task) { return (task.use_position ? 3 : 0) + (task.use_rotation ? 3 : 0); }

MotionError compare(const model::SceneTask& task, const RecordedMotion& motion, const ComparedSamples& samples,
                    const SimulatedMotion& simulated, const OwnValues& own, double until) {
  MotionError error;
  error.failure = simulated.failure;
  if (!error.failure.empty()) return error;
  const int numbers = numbers_of(task);
  std::size_t all = 0;
  for (const std::vector<std::size_t>& of_body : samples) all += of_body.size();
  error.residuals =
      Eigen::VectorXd::Zero(static_cast<Eigen::Index>(all) * numbers + own_deviation(task, own.path.size()).size());
  Eigen::Index at = 0;
  double count = 0.0;
  for (std::size_t b = 0; b < motion.tracked.size(); ++b) {
    const RecordedBody& body = motion.tracked[b];
    Vector3 shift = Vector3::Zero(), turn = Vector3::Zero();
    for (const std::size_t k : samples[b]) {
      const Eigen::Index row = std::exchange(at, at + numbers);
      if (motion.times[k] > until) continue;
      const bool is_result = task.only_final_state && body.result;
      const record::PoseSample& recorded = is_result ? *body.result : body.poses[k];
      const record::PoseSample& predicted = simulated.bodies[b][k];
      const bool has_ended = motion.times[k] > simulated.end;
      if (!record::is_tracked(predicted) && !has_ended) continue;
      const double weight = is_result ? 1.0 : averaged_at(body, k);
      const double position_noise = task.position_noise / std::sqrt(weight);
      if (has_ended) {
        shift = turn = Vector3::Constant(kLost / std::sqrt(3.0));
      } else {
        const Pose X = own.bias * predicted.pose() * own.X_BM[b], M = recorded.pose();
        shift = X.p - M.p;
        turn = log_rotation(M.R.transpose() * X.R);
      }
      if (task.use_position) error.residuals.segment<3>(row) = shift / position_noise;
      if (task.use_rotation)
        error.residuals.segment<3>(row + (task.use_position ? 3 : 0)) =
            turn * (task.rotation_position_ratio / position_noise);
      error.position += weight * shift.norm();
      error.rotation += weight * turn.norm();
      error.position_square += weight * shift.squaredNorm();
      error.rotation_square += weight * turn.squaredNorm();
      count += weight;
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
