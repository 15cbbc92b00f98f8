// Recordings that are not what they seem.
#include "snug/identification/internal/recording_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kHalfTurn = 10.0 / 180.0 * std::numbers::pi;  // rad, that a half turn may be off by

double angle_between(const Matrix3& a, const Matrix3& b) { return log_rotation(a.transpose() * b).norm(); }

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

char nearest_axis(const Vector3& turn) {
  Eigen::Index axis = 0;
  turn.cwiseAbs().maxCoeff(&axis);
  return "xyz"[axis];
}

void check_times(const model::SceneTask& task, const RecordedMotion& motion) {
  constexpr double kSlow = 0.9;  // s between samples: no motion of boxes is recorded so slowly
  if (motion.times.size() < 10 || task.only_final_state) return;
  std::vector<double> steps;
  for (std::size_t k = 1; k < motion.times.size(); ++k) steps.push_back(motion.times[k] - motion.times[k - 1]);
  if (median(steps) >= kSlow)
    throw InputError(task.path.string(), task.time_column,
                     fmt::format("samples {:.4g} s apart in {}", median(steps), motion.name),
                     "seconds; these look like milliseconds");
}

void check_start(const model::SceneTask& task, const model::Body& body, const RecordedBody& recorded,
                 const RecordedMotion& motion) {
  const auto first = std::ranges::find_if(recorded.poses, [](const auto& pose) { return record::is_tracked(pose); });
  if (first == recorded.poses.end()) return;
  const auto refuse = [&](const std::string& got, const char* expected) {
    throw InputError(task.path.string(), "'" + recorded.body + "' in " + motion.name, got, expected);
  };
  constexpr double kFarAway = 10.0, kNear = 3.0;  // m
  if ((first->p - body.X_WB.p).norm() > kFarAway && (1e-3 * first->p - body.X_WB.p).norm() < kNear)
    refuse(fmt::format("a position of {:.4g}, {:.4g}, {:.4g}", first->p.x(), first->p.y(), first->p.z()),
           "metres; these look like millimetres");
  if (task.start.from != model::StartFrom::Scenario) return;
  const Pose X_WB = first->pose();
  const double angle = angle_between(X_WB.R, body.X_WB.R);
  const Quaternion& read = first->quat;  // w, x, y, z as they stand in the file
  const Quaternion other(read.z(), read.w(), read.x(), read.y());
  constexpr double kOff = 1.0, kLike = 0.35;  // rad
  if (angle > kOff && angle_between(other.normalized().toRotationMatrix(), body.X_WB.R) < kLike)
    refuse(fmt::format("an orientation {:.0f} degrees from the scenario's", kDegrees * angle),
           "quaternions as w, x, y, z; these look like x, y, z, w");
  if (angle > std::numbers::pi - kHalfTurn)
    refuse(fmt::format("an orientation half a turn about its {} axis from the scenario's",
                       nearest_axis(log_rotation(body.X_WB.R.transpose() * X_WB.R))),
           "the scenario's: the recorded frame is turned by 180 degrees");
}

/// A half turn from one sample to the next, after three that agree, that is still there five samples later.
void check_flips(const model::SceneTask& task, const RecordedBody& recorded, const RecordedMotion& motion) {
  constexpr std::size_t kBefore = 3, kStays = 5;
  constexpr double kShort = 0.1;  // s
  std::vector<std::size_t> seen;
  for (std::size_t k = 0; k < recorded.poses.size(); ++k)
    if (record::is_tracked(recorded.poses[k])) seen.push_back(k);
  for (std::size_t i = kBefore; i + kStays < seen.size(); ++i) {
    const std::size_t a = seen[i - 1], b = seen[i], later = seen[i + kStays];
    if (motion.times[later] - motion.times[a] > kShort) continue;
    const Matrix3 R = recorded.poses[a].pose().R;
    const Vector3 turn = log_rotation(R.transpose() * recorded.poses[b].pose().R);
    if (turn.norm() < std::numbers::pi - kHalfTurn) continue;
    if (angle_between(R, recorded.poses[seen[i - kBefore]].pose().R) > 2.0 * kHalfTurn) continue;
    if (angle_between(R, recorded.poses[later].pose().R) < std::numbers::pi - 2.0 * kHalfTurn) continue;
    throw InputError(task.path.string(), "'" + recorded.body + "' in " + motion.name,
                     fmt::format("a half turn about its {} axis between two samples, at {:.4g} s", nearest_axis(turn),
                                 motion.times[b]),
                     "one frame of the body throughout: its markers were taken for their mirror image from there");
  }
}

Vector3 median_of(const std::vector<Vector3>& values) {
  Vector3 result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> one;
    for (const Vector3& value : values) one.push_back(value[axis]);
    result[axis] = median(one);
  }
  return result;
}

/// The one that the others are nearest to, all together: what rotation vectors are seen from, so that none of most of
/// them is near half a turn, where its sign is chance.
Matrix3 middle_of(const std::vector<Matrix3>& rotations) {
  Matrix3 middle = Matrix3::Identity();
  double least = std::numeric_limits<double>::infinity();
  for (const Matrix3& one : rotations) {
    double sum = 0.0;
    for (const Matrix3& other : rotations) sum += angle_between(one, other);
    if (sum >= least) continue;
    least = sum;
    middle = one;
  }
  return middle;
}

/// Whether `value` is off the line through its neighbours.
bool jumps(double time, const Vector3& value, const std::vector<double>& times, const std::vector<Vector3>& values,
           double noise) {
  constexpr double kNoises = 8.0, kScatters = 6.0 * 1.4826;
  std::vector<Vector3> slopes, levels;
  for (std::size_t j = 1; j < values.size(); ++j)
    slopes.push_back((values[j] - values[j - 1]) / (times[j] - times[j - 1]));
  const Vector3 slope = median_of(slopes);
  for (std::size_t j = 0; j < values.size(); ++j) levels.push_back(values[j] - slope * (times[j] - time));
  const Vector3 level = median_of(levels);
  std::vector<double> scatter;
  for (const Vector3& one : levels) scatter.push_back((one - level).norm());
  return (value - level).norm() > std::max(kNoises * noise, kScatters * median(scatter));
}

}  // namespace

void check_conventions(const model::SceneTask& task, const model::Scenario& scenario, const RecordedMotion& motion) {
  check_times(task, motion);
  for (const RecordedBody& recorded : motion.tracked) {
    check_flips(task, recorded, motion);
    if (const model::Body* body = model::find_body(scenario, recorded.body)) check_start(task, *body, recorded, motion);
  }
}

void reject_jumps(const model::SceneTask& task, RecordedMotion& motion) {
  constexpr std::size_t kSide = 3, kFewest = 4;
  constexpr double kMost = 0.1;
  for (RecordedBody& body : motion.tracked) {
    std::vector<std::size_t> seen;
    for (std::size_t k = 0; k < body.poses.size(); ++k)
      if (record::is_tracked(body.poses[k])) seen.push_back(k);
    std::vector<std::size_t> odd;
    for (std::size_t i = 0; i < seen.size(); ++i) {
      std::vector<double> times;
      std::vector<Vector3> places, turns;
      const std::size_t begin = i > kSide ? i - kSide : 0, end = std::min(seen.size(), i + kSide + 1);
      std::vector<Matrix3> rotations;
      for (std::size_t j = begin; j < end; ++j) {
        if (j == i) continue;
        times.push_back(motion.times[seen[j]]);
        places.push_back(body.poses[seen[j]].p);
        rotations.push_back(body.poses[seen[j]].pose().R);
      }
      if (times.size() < kFewest) continue;
      const Matrix3 R = middle_of(rotations);
      for (const Matrix3& other : rotations) turns.push_back(log_rotation(R.transpose() * other));
      const double time = motion.times[seen[i]];
      if (jumps(time, body.poses[seen[i]].p, times, places, task.position_noise) ||
          jumps(time, log_rotation(R.transpose() * body.poses[seen[i]].pose().R), times, turns, task.rotation_noise))
        odd.push_back(seen[i]);
    }
    if (static_cast<double>(odd.size()) > kMost * static_cast<double>(seen.size())) continue;
    for (const std::size_t k : odd) body.poses[k] = record::lost_pose();
    body.rejected = static_cast<int>(odd.size());
  }
}

}  // namespace snug::identification::internal
