// Metrics: how far a prediction is from a measurement, in two named forms.
#include "snug/validation/metrics.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/units.hpp"
#include "snug/validation/internal/averages.hpp"
#include "snug/validation/internal/smoothing.hpp"

namespace snug::validation {
namespace {

using record::is_tracked;
using record::PoseSample;

// The demonstrator's rules (docs/theory/validation.md).
constexpr double kPositionOutlier = 0.15;                           // m
constexpr double kRotationOutlier = 15.0 * std::numbers::pi / 180;  // rad
constexpr double kPositionMedian = 3.0, kRotationMedian = 10.0;     // s
constexpr double kNearest = 0.5 / 125.0;                            // s: half a period of the demonstrator's controller
constexpr std::size_t kFilterReach = 25;                            // samples to both sides
constexpr double kLongestGap = 0.02;                                // s: of two measured samples that belong together

/// [first, last) of the times within [start, end].
std::pair<std::size_t, std::size_t> span_of(const std::vector<double>& times, double start, double end) {
  const auto first = std::lower_bound(times.begin(), times.end(), start);
  const auto last = std::upper_bound(first, times.end(), end);
  return {static_cast<std::size_t>(first - times.begin()), static_cast<std::size_t>(last - times.begin())};
}

double root_mean_square(const std::vector<double>& values) {
  double sum = 0.0, count = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    sum += value * value;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : kNaN;
}

double share_of_finite(const std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto count = std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

/// The rotation vector of `R` that is nearest to `last`: angles beyond pi instead of jumps.
Vector3 nearest_log(const Matrix3& R, const Vector3& last) {
  const Vector3 w = log_rotation(R);
  const double angle = w.norm();
  if (angle < 1e-9) return w;
  Vector3 best = w;
  for (const double turn : {-2.0 * std::numbers::pi, 2.0 * std::numbers::pi}) {
    const Vector3 other = (1.0 + turn / angle) * w;
    if ((other - last).norm() < (best - last).norm()) best = other;
  }
  return best;
}

std::size_t index_of(const SimulatedRun& run, const std::string& body) {
  const int index = record::find_body(run.header, body);
  SNUG_CHECK(index >= 0, "a window must name a body of the simulation");
  return static_cast<std::size_t>(index);
}

bool was_measured(const Measurement& measurement, std::size_t body) {
  return measurement.has_poses() && !measurement.bodies[body].empty();
}

void compare_rest(const SimulatedRun& run, const Measurement& measurement, const Window& window, Errors& errors) {
  const std::size_t body = index_of(run, window.body);
  const auto mean_of = [&](const std::vector<double>& times, const std::vector<PoseSample>& poses) {
    const auto [first, last] = span_of(times, window.end - kRestSpan, window.end);
    return internal::mean_pose(std::span(poses).subspan(first, last - first), kLeastTracked);
  };
  const std::optional<Pose> simulated = mean_of(run.times, run.bodies[body]);
  const std::optional<Pose> measured = mean_of(measurement.pose_times, measurement.bodies[body]);
  if (!simulated || !measured) return;
  errors.rest_position = (simulated->p - measured->p).norm();
  errors.rest_rotation = angle_between(simulated->R, measured->R);
}

void compare_poses_clean(const SimulatedRun& run, const Measurement& measurement, const Window& window,
                         Errors& errors) {
  const PoseSeries series = pose_series(run, measurement, window);
  errors.tracked = share_of_finite(series.position_error);
  if (errors.tracked < kLeastTracked) return;
  errors.rms_position = root_mean_square(series.position_error);
  errors.rms_rotation = root_mean_square(series.rotation_error);
  compare_rest(run, measurement, window, errors);
}

/// One measured body in and around a window, as six columns.
struct Columns {
  std::vector<double> times;
  std::array<std::vector<double>, 6> values;  ///< position, rotation vector
  std::vector<bool> is_held;                  ///< the same as before to the last bit: not measured anew
  double last_seen = 0.0;                     ///< s
};

/// The demonstrator's cleaning, which sees the window alone: outliers and constant runs are taken away, gaps filled,
/// everything smoothed.
Columns cleaned_as_reported(const Measurement& measurement, std::size_t body, const Window& window) {
  const auto [first, last] = span_of(measurement.pose_times, window.start, window.end);
  Columns columns;
  Vector3 w = Vector3::Zero();
  PoseSample before = record::lost_pose();
  for (std::size_t i = first; i < last; ++i) {
    columns.times.push_back(measurement.pose_times[i]);
    const PoseSample& X_WB = measurement.bodies[body][i];
    columns.is_held.push_back(is_tracked(X_WB) && X_WB == before);
    before = X_WB;
    if (is_tracked(X_WB)) {
      w = nearest_log(X_WB.pose().R, w);
      columns.last_seen = columns.times.back();
    }
    for (int k = 0; k < 3; ++k) {
      columns.values[static_cast<std::size_t>(k)].push_back(is_tracked(X_WB) ? X_WB.p[k] : kNaN);
      columns.values[static_cast<std::size_t>(3 + k)].push_back(is_tracked(X_WB) ? w[k] : kNaN);
    }
  }
  for (std::size_t k = 0; k < 6; ++k) {
    std::vector<double>& values = columns.values[k];
    const std::vector<bool> is_outlier =
        internal::find_outliers(columns.times, values, k < 3 ? kPositionMedian : kRotationMedian);
    for (std::size_t i = 0; i < values.size(); ++i)
      if (is_outlier[i] || columns.is_held[i]) values[i] = kNaN;
    internal::fill_gaps(columns.times, values);
    values = internal::smooth(values);
  }
  return columns;
}

/// Index of the time nearest to `time`, if one is within `reach`.
std::optional<std::size_t> find_nearest_time(const std::vector<double>& times, double time, double reach) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  auto best = after;
  if (after == times.end() || (after != times.begin() && time - *(after - 1) < *after - time)) {
    if (after == times.begin()) return std::nullopt;
    best = after - 1;
  }
  if (std::abs(*best - time) > reach) return std::nullopt;
  return static_cast<std::size_t>(best - times.begin());
}

void compare_poses_as_reported(const SimulatedRun& run, const Measurement& measurement, const Window& window,
                               Errors& errors) {
  const std::size_t body = index_of(run, window.body);
  // Whether the body was seen at all is judged before its gaps are filled.
  errors.tracked = share_of_finite(pose_series(run, measurement, window).position_error);
  if (errors.tracked < kLeastTracked) return;
  const Columns columns = cleaned_as_reported(measurement, body, window);
  const auto [first, last] = span_of(run.times, window.start, window.end);
  std::vector<double> positions, rotations;
  double compared = 0.0, dropped = 0.0, position = kNaN, rotation = kNaN;
  Vector3 w_simulated = Vector3::Zero();
  for (std::size_t i = first; i < last; ++i) {
    const PoseSample& X_WB = run.bodies[body][i];
    const std::optional<std::size_t> k = find_nearest_time(columns.times, run.times[i], kNearest);
    if (!k || !is_tracked(X_WB)) continue;
    w_simulated = nearest_log(X_WB.pose().R, w_simulated);
    Vector3 p, w;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = columns.values[static_cast<std::size_t>(axis)][*k];
      w[axis] = columns.values[static_cast<std::size_t>(3 + axis)][*k];
    }
    if (!p.allFinite() || !w.allFinite()) continue;
    const double angle = w.norm();
    if ((w - w_simulated).norm() > std::numbers::pi && angle > 1e-9) {  // the jump at pi
      for (const double turn : {-2.0 * std::numbers::pi, 2.0 * std::numbers::pi}) {
        const Vector3 other = (1.0 + turn / angle) * w;
        if ((other - w_simulated).norm() < (w - w_simulated).norm()) w = other;
      }
    }
    position = (p - X_WB.p).norm();
    rotation = (w - w_simulated).norm();
    compared += 2.0;
    dropped += (position > kPositionOutlier ? 1.0 : 0.0) + (rotation > kRotationOutlier ? 1.0 : 0.0);
    positions.push_back(position > kPositionOutlier ? kNaN : position);
    rotations.push_back(rotation > kRotationOutlier ? kNaN : rotation);
  }
  errors.dropped = compared > 0.0 ? dropped / compared : 0.0;
  errors.rms_position = root_mean_square(positions);
  errors.rms_rotation = root_mean_square(rotations);
  if (columns.last_seen > window.end - kRestSpan) {  // else it was lost before it rested
    errors.rest_position = position;                 // the last sample that is left, however far off
    errors.rest_rotation = rotation;
  }
}

void compare_wrenches(const WrenchSeries& series, Errors& errors) {
  errors.rms_force = root_mean_square(series.force_error);
  errors.rms_torque = root_mean_square(series.torque_error);
}

/// The measurement nearest to each of the simulation's instants; then what those are smoothed to, less the simulation.
/// The filter's 50 samples are of the simulation's, so 0.4 s at its 125 Hz.
WrenchSeries wrench_series_as_reported(const SimulatedRun& run, const Measurement& measurement, const Window& window) {
  const auto [first, last] = span_of(run.times, window.start, window.end);
  const std::size_t from = first > kFilterReach ? first - kFilterReach : 0;
  const std::size_t to = std::min(last + kFilterReach, run.times.size());
  std::array<std::vector<double>, 6> columns;
  for (std::size_t i = from; i < to; ++i) {
    const std::optional<std::size_t> k = find_nearest_time(measurement.wrench_times, run.times[i], kNearest);
    const Vector6 values = k ? as_vector(measurement.wrenches[*k]) : Vector6(Vector6::Constant(kNaN));
    for (int axis = 0; axis < 6; ++axis) columns[static_cast<std::size_t>(axis)].push_back(values[axis]);
  }
  for (std::vector<double>& column : columns) column = internal::smooth(column);
  WrenchSeries series;
  for (std::size_t i = first; i < last; ++i) {
    Vector6 error = -as_vector(run.wrench[i]);
    for (std::size_t axis = 0; axis < 6; ++axis) error[static_cast<int>(axis)] += columns[axis][i - from];
    if (!error.allFinite()) continue;
    series.force_error.push_back(error.head<3>().norm());
    series.torque_error.push_back(error.tail<3>().norm());
  }
  return series;
}

}  // namespace

Errors compare(const SimulatedRun& run, const Measurement& measurement, const Window& window, Form form) {
  Errors errors{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, 0.0, 0.0};
  if (was_measured(measurement, index_of(run, window.body))) {
    if (form == Form::Clean)
      compare_poses_clean(run, measurement, window, errors);
    else
      compare_poses_as_reported(run, measurement, window, errors);
  }
  if (!measurement.wrench_times.empty()) {
    compare_wrenches(form == Form::Clean ? wrench_series(run, measurement, window)
                                         : wrench_series_as_reported(run, measurement, window),
                     errors);
  }
  return errors;
}

PoseSeries pose_series(const SimulatedRun& run, const Measurement& measurement, const Window& window) {
  const std::size_t body = index_of(run, window.body);
  const auto [first, last] = span_of(run.times, window.start, window.end);
  static const std::vector<PoseSample> kNothing;
  static const std::vector<double> kNever;
  const bool is_measured = was_measured(measurement, body);
  PoseCursor cursor(is_measured ? measurement.pose_times : kNever, is_measured ? measurement.bodies[body] : kNothing);
  PoseSeries series;
  Vector3 w_simulated = Vector3::Zero();
  for (std::size_t i = first; i < last; ++i) {
    const PoseSample& simulated = run.bodies[body][i];
    if (!is_tracked(simulated)) continue;
    const PoseSample measured = cursor.at(run.times[i], kLongestGap);
    series.times.push_back(run.times[i]);
    w_simulated = nearest_log(simulated.pose().R, w_simulated);
    series.p_simulated.push_back(simulated.p);
    series.w_simulated.push_back(w_simulated);
    if (!is_tracked(measured)) {
      for (auto* lost : {&series.p_measured, &series.w_measured}) lost->push_back(Vector3::Constant(kNaN));
      for (auto* lost : {&series.position_error, &series.rotation_error}) lost->push_back(kNaN);
      continue;
    }
    series.p_measured.push_back(measured.p);
    series.w_measured.push_back(nearest_log(measured.pose().R, w_simulated));
    series.position_error.push_back((measured.p - simulated.p).norm());
    series.rotation_error.push_back(angle_between(measured.pose().R, simulated.pose().R));
  }
  return series;
}

/// The measured side is the mean over a period of the simulation around each of its instants, so that both sides have
/// about the same bandwidth: noise between two instants is no error of a prediction.
WrenchSeries wrench_series(const SimulatedRun& run, const Measurement& measurement, const Window& window) {
  WrenchSeries series;
  const auto [first, last] = span_of(run.times, window.start, window.end);
  const std::vector<double>& times = measurement.wrench_times;
  for (std::size_t i = std::max<std::size_t>(first, 1); i < last; ++i) {
    // Half a frame to both sides: what lies between two instants is shared evenly.
    const double before = 0.5 * (run.times[i] - run.times[i - 1]);
    const auto [from, to] = span_of(times, run.times[i] - before, run.times[i] + before);
    if (from == to) continue;
    Vector6 sum = Vector6::Zero();
    for (std::size_t k = from; k < to; ++k) sum += as_vector(measurement.wrenches[k]);
    const Vector6 measured = sum / static_cast<double>(to - from);
    const Vector6 error = measured - as_vector(run.wrench[i]);
    series.times.push_back(run.times[i]);
    series.simulated.push_back(run.wrench[i]);
    series.measured.push_back(wrench_from(measured));
    series.force_error.push_back(error.head<3>().norm());
    series.torque_error.push_back(error.tail<3>().norm());
  }
  return series;
}

}  // namespace snug::validation
