// Measurement: one repetition of an experiment on the clock and in the frame of the simulation it is compared with.
#include "snug/validation/measurement.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"
#include "snug/validation/internal/averages.hpp"
#include "snug/validation/measure.hpp"

namespace snug::validation {
namespace {

using record::ArchiveRecording;
using record::BodyTrack;
using record::is_tracked;
using record::PoseSample;

constexpr double kSpeedHalf = 0.05;      // s: speeds are slopes of lines through this much on both sides
constexpr double kForceHalf = 0.02;      // s: forces are means of it
constexpr double kSignalPeriod = 0.008;  // s: what clocks are fitted on; more would only take longer

double period_of(const std::vector<double>& times) {
  return (times.back() - times.front()) / static_cast<double>(times.size() - 1);
}

std::size_t stride_for(const std::vector<double>& times) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(kSignalPeriod / period_of(times))));
}

std::vector<double> thinned(const std::vector<double>& times) {
  std::vector<double> kept;
  for (std::size_t i = 0; i < times.size(); i += stride_for(times)) kept.push_back(times[i]);
  return kept;
}

/// Calls `value(first, last)` with as many samples on both sides of each instant of thinned(times) as `half` seconds
/// hold (a sample more on one side would move the instant by half a period); NaN where the record begins, ends or
/// has a gap.
template <class Value>
std::vector<double> windowed(const std::vector<double>& times, double half, Value value) {
  const double period = period_of(times);
  const auto count = static_cast<std::size_t>(std::lround(half / period));
  std::vector<double> values;
  for (std::size_t i = 0; i < times.size(); i += stride_for(times)) {
    const bool is_inside = i >= count && i + count < times.size();
    const bool is_whole =
        is_inside && times[i + count] - times[i - count] < (2.0 * static_cast<double>(count) + 1.5) * period;
    values.push_back(is_whole ? value(i - count, i + count + 1) : kNaN);
  }
  return values;
}

/// Speed: the slope of the line through the positions around each instant. NaN where one of them is lost.
std::vector<double> speeds_of(const std::vector<double>& times, const std::vector<PoseSample>& poses) {
  return windowed(times, kSpeedHalf, [&](std::size_t first, std::size_t last) {
    const auto count = static_cast<double>(last - first);
    double mean_time = 0.0, spread = 0.0;
    Vector3 slope = Vector3::Zero();
    for (std::size_t k = first; k < last; ++k) mean_time += times[k] / count;
    for (std::size_t k = first; k < last; ++k) {
      const double lever = times[k] - mean_time;
      slope += lever * poses[k].p;
      spread += lever * lever;
    }
    return slope.norm() / spread;
  });
}

std::vector<double> forces_of(const std::vector<double>& times, const std::vector<Wrench>& wrenches, int axis) {
  return windowed(times, kForceHalf, [&](std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t k = first; k < last; ++k) sum += wrenches[k].force[axis];
    return sum / static_cast<double>(last - first);
  });
}

const BodyTrack* find_track(const ArchiveRecording& recording, std::string_view name) {
  for (const BodyTrack& track : recording.motion_capture.bodies)
    if (record::is_same_body(track.name, name)) return &track;
  return nullptr;
}

SourceClock make_clock(const char* source, const Signals& simulated, const Signals& measured,
                       const std::optional<double>& by_hand, bool removes_offsets) {
  SourceClock clock;
  clock.source = source;
  if (by_hand) {
    clock.fit.emplace();
    clock.fit->shift = *by_hand;
    clock.fit->is_by_hand = true;
    return clock;
  }
  ClockOptions options;
  options.removes_offsets = removes_offsets;
  const Expected<ClockFit, NoClock> fit = fit_clock(simulated, measured, options);
  if (fit)
    clock.fit = *fit;
  else
    clock.failure = describe(fit.error());
  return clock;
}

std::vector<double> on_simulation_clock(std::vector<double> times, const ClockFit& fit) {
  for (double& time : times) time = fit.to_reference(time);
  return times;
}

void align_poses(const SimulatedRun& run, const ArchiveRecording& recording, const std::optional<double>& by_hand,
                 const std::string& where, Measurement& measurement) {
  const std::vector<double>& times = recording.motion_capture.times;
  Pose X_WM;
  if (const BodyTrack* base = find_track(recording, kBaseBody)) {
    const std::optional<Pose> X_MW = internal::mean_pose(base->poses, 0.0);
    if (!X_MW) throw InputError(where, '/' + recording.name, "a robot base that is lost all along", "its pose");
    X_WM = X_MW->inverse();
    const internal::MeanPoseError error = internal::find_mean_error(base->poses, *X_MW);
    measurement.base_position_error = error.position;
    measurement.base_rotation_error = error.rotation;
  }
  Signals simulated{thinned(run.times), {}}, measured{thinned(times), {}};
  measurement.bodies.resize(run.header.bodies.size());
  std::size_t known = 0;
  for (const std::size_t i : find_boxes(run.header)) {
    const BodyTrack* track = find_track(recording, run.header.bodies[i].name);
    if (track == nullptr) continue;
    ++known;
    simulated.channels.push_back(speeds_of(run.times, run.bodies[i]));
    measured.channels.push_back(speeds_of(times, track->poses));
    std::vector<PoseSample>& poses = measurement.bodies[i];
    poses.reserve(times.size());
    for (const PoseSample& X_MB : track->poses)
      poses.push_back(is_tracked(X_MB) ? PoseSample(X_WM * X_MB.pose()) : X_MB);
  }
  if (known == 0) {
    std::string names;
    for (const std::size_t i : find_boxes(run.header))
      names += (names.empty() ? "" : ", ") + record::archive_name(run.header.bodies[i].name);
    throw InputError(where, '/' + recording.name, "no body of the simulation", "some of " + names);
  }
  if (const BodyTrack* tool = find_track(recording, kToolBody)) {
    simulated.channels.push_back(speeds_of(run.times, run.tool));
    measured.channels.push_back(speeds_of(times, tool->poses));
  }
  measurement.clocks.push_back(make_clock("motion capture", simulated, measured, by_hand, false));
  if (!measurement.clocks.back().fit) return;
  measurement.pose_times = on_simulation_clock(times, *measurement.clocks.back().fit);
}

/// Median of measured less simulated, axis by axis, while the cup holds nothing; over everything when it always does.
Wrench find_bias(const SimulatedRun& run, const std::vector<double>& times, const std::vector<Wrench>& wrenches) {
  std::vector<double> differences[6];
  for (const bool wants_empty : {true, false}) {
    std::size_t frame = 0;
    for (std::size_t i = 0; i < times.size(); ++i) {
      while (frame + 1 < run.times.size() && run.times[frame + 1] <= times[i]) ++frame;
      if (times[i] < run.times.front() || times[i] > run.times.back()) continue;
      if (wants_empty && run.attached[frame] >= 0) continue;
      const Vector6 difference = as_vector(wrenches[i]) - as_vector(run.wrench[frame]);
      for (int k = 0; k < 6; ++k) differences[k].push_back(difference[k]);
    }
    if (!differences[0].empty()) break;
  }
  Vector6 bias;
  for (int k = 0; k < 6; ++k) bias[k] = internal::median(differences[k]);
  return wrench_from(bias);
}

void align_forces(const SimulatedRun& run, const record::WrenchLog& log, const std::optional<double>& by_hand,
                  Measurement& measurement) {
  Signals simulated{thinned(run.times), {}}, measured{thinned(log.times), {}};
  for (int axis = 0; axis < 3; ++axis) {
    simulated.channels.push_back(forces_of(run.times, run.wrench, axis));
    measured.channels.push_back(forces_of(log.times, log.wrenches, axis));
  }
  measurement.clocks.push_back(make_clock("force/torque", simulated, measured, by_hand, true));
  if (!measurement.clocks.back().fit) return;
  measurement.wrench_times = on_simulation_clock(log.times, *measurement.clocks.back().fit);
  measurement.bias = find_bias(run, measurement.wrench_times, log.wrenches);
  for (const Wrench& wrench : log.wrenches)
    measurement.wrenches.push_back({wrench.force - measurement.bias.force, wrench.torque - measurement.bias.torque});
}

}  // namespace

Measurement align(const SimulatedRun& run, const ArchiveRecording& recording, const HandShifts& shifts,
                  const std::string& where) {
  Measurement measurement;
  measurement.name = recording.name;
  measurement.note = std::string(record::find_remark(recording, "note"));
  if (recording.motion_capture.times.size() >= 2)
    align_poses(run, recording, shifts.motion_capture, where, measurement);
  else
    measurement.bodies.resize(run.header.bodies.size());
  if (recording.force_torque.times.size() >= 2)
    align_forces(run, recording.force_torque, shifts.force_torque, measurement);
  if (recording.robot.tool.size() >= 2) {
    const Signals simulated{thinned(run.times), {speeds_of(run.times, run.tool)}};
    const Signals measured{thinned(recording.robot.times), {speeds_of(recording.robot.times, recording.robot.tool)}};
    measurement.clocks.push_back(make_clock("robot", simulated, measured, shifts.robot, false));
  }
  return measurement;
}

HandShifts parse_hand_shifts(const std::vector<std::string>& words) {
  HandShifts shifts;
  const std::vector<std::string> sources = {"mocap", "ft", "robot"};
  std::optional<double>* const targets[] = {&shifts.motion_capture, &shifts.force_torque, &shifts.robot};
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    const std::string source = word.substr(0, sign);
    const std::string_view text =
        sign == std::string::npos ? std::string_view() : std::string_view(word).substr(sign + 1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const bool is_number = error == std::errc() && end == text.data() + text.size() && std::isfinite(value);
    bool is_known = false;
    for (std::size_t i = 0; i < sources.size(); ++i) {
      if (source != sources[i]) continue;
      is_known = true;
      *targets[i] = value;
    }
    const std::string_view nearest = find_nearest(source, sources);
    if (!is_known || !is_number)
      throw InputError("command line", "--shift", "'" + word + "'",
                       "mocap=SECONDS, ft=SECONDS or robot=SECONDS" +
                           (is_known || nearest.empty() ? "" : "; did you mean " + std::string(nearest) + "?"));
  }
  return shifts;
}

}  // namespace snug::validation
