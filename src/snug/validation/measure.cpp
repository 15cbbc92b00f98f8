// measure: a virtual experiment: what sensors would have recorded of a simulated run.
#include "snug/validation/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/model/scenario.hpp"

namespace snug::validation {
namespace {

using record::PoseSample;

constexpr double kGravity = 9.81;    // m/s^2; what the accelerometer feels at rest
constexpr int kMinutesBetween = 20;  // of two repetitions: more than 15 (report, 4.4.2)
constexpr double kAnyGap = 1e9;      // frames of a simulation are never too far apart

Vector3 noise_vector(Rng& rng, double deviation) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return deviation * Vector3(x, y, z);
}

ClockTruth draw_clock(const model::ClockParams& params, Rng rng) {
  ClockTruth clock;
  clock.offset = rng.uniform(-params.offset, params.offset);
  clock.rate = 1e-6 * rng.uniform(-params.rate_ppm, params.rate_ppm);
  return clock;
}

/// Instants of a source: in its own clock, and when that is in the simulation.
struct Instants {
  std::vector<double> own, simulated;
};

/// The source samples all along the run; its clock starts at 0 or where the offset puts it, whichever is later, as
/// clocks of sources do: they count from their own start.
Instants sample_times(const SimulatedRun& run, double rate_hz, const ClockTruth& clock) {
  const double first = run.times.front(), last = run.times.back();
  const auto count = static_cast<std::size_t>(std::floor((last - first) * rate_hz)) + 1;
  Instants instants;
  for (std::size_t k = 0; k < count; ++k) {
    const double simulated = first + static_cast<double>(k) / (rate_hz * (1.0 + clock.rate));
    if (simulated > last) break;
    instants.simulated.push_back(simulated);
    instants.own.push_back(clock.offset + (1.0 + clock.rate) * simulated);
  }
  return instants;
}

Pose disturbed(const Pose& X, Rng& rng, double position, double rotation) {
  const Vector3 p = noise_vector(rng, position);
  const Vector3 w = noise_vector(rng, rotation);
  return {X.R * exp_rotation(w), X.p + p};
}

/// Half the size of a box along each axis of W, when the body is one box.
std::optional<Vector3> half_size(const record::BodyInfo& body) {
  if (body.shapes.size() != 1 || body.shapes[0].kind != record::ShapeKind::Box) return std::nullopt;
  return body.shapes[0].half;
}

/// Says whether a body is hidden by the container's walls.
class ContainerShadow {
 public:
  ContainerShadow(const record::ContainerInfo& container, double depth)
      : is_there_(!container.name.empty()),
        X_IW_((container.X_WT.pose() * container.X_TI.pose()).inverse()),
        size_(container.inner_size),
        depth_(depth) {}

  [[nodiscard]] bool hides(const PoseSample& X_WB, const Vector3& half) const {
    if (!is_there_) return false;
    const Pose X_IB = X_IW_ * X_WB.pose();
    const bool is_inside = std::abs(X_IB.p.x()) < 0.5 * size_.x() && std::abs(X_IB.p.y()) < 0.5 * size_.y();
    const double top = X_IB.p.z() + X_IB.R.row(2).cwiseAbs().dot(half);
    return is_inside && top < size_.z() - depth_;
  }

 private:
  bool is_there_;
  Pose X_IW_;
  Vector3 size_;
  double depth_;
};

/// Moments at which a body is lost although nothing hides it.
class Dropouts {
 public:
  Dropouts(const model::MotionCaptureParams& params, Rng rng) : params_(params), rng_(rng) { draw_next(0.0); }
  [[nodiscard]] bool is_out(double time) {
    while (params_.dropout_rate > 0.0 && time >= end_) draw_next(end_);
    return time >= begin_ && time < end_;
  }

 private:
  double exponential(double mean) { return -mean * std::log(1.0 - rng_.uniform()); }
  void draw_next(double from) {
    if (params_.dropout_rate <= 0.0) {
      begin_ = end_ = std::numeric_limits<double>::infinity();
      return;
    }
    begin_ = from + exponential(1.0 / params_.dropout_rate);
    end_ = begin_ + exponential(params_.dropout_duration);
  }

  const model::MotionCaptureParams& params_;
  Rng rng_;
  double begin_ = 0.0, end_ = 0.0;
};

struct Tracked {
  std::string name;
  const std::vector<PoseSample>* poses = nullptr;
  std::optional<Vector3> half;  ///< of a box that the container can hide
  bool has_error = true;        ///< its markers' frame was not set exactly
};

std::vector<Tracked> tracked_bodies(const SimulatedRun& run, const std::vector<PoseSample>& base,
                                    const std::vector<PoseSample>& container) {
  std::vector<Tracked> bodies = {{kBaseBody, &base, std::nullopt, false}};
  if (!container.empty()) bodies.push_back({kContainerBody, &container, std::nullopt, true});
  bodies.push_back({kToolBody, &run.tool, std::nullopt, true});
  bodies.push_back({kLipBody, &run.lip, std::nullopt, true});
  for (const std::size_t i : find_boxes(run.header)) {
    const record::BodyInfo& body = run.header.bodies[i];
    bodies.push_back({record::archive_name(body.name), &run.bodies[i], half_size(body), true});
  }
  std::sort(bodies.begin(), bodies.end(), [](const Tracked& a, const Tracked& b) { return a.name < b.name; });
  return bodies;
}

/// Where motion capture's frame is: somewhere on the floor, upright, turned at random.
Pose draw_world(Rng rng) {
  const double yaw = rng.uniform(-std::numbers::pi, std::numbers::pi);
  const double z = rng.uniform(0.5, 1.0), y = rng.uniform(-2.0, 2.0), x = rng.uniform(-2.0, 2.0);
  return {exp_rotation(Vector3(0.0, 0.0, yaw)), Vector3(x, y, z)};
}

record::MotionCaptureLog measure_poses(const SimulatedRun& run, const model::MotionCaptureParams& params,
                                       const Rng& seed, const Rng& rng, MeasureTruth& truth) {
  const Instants instants = sample_times(run, params.rate, truth.motion_capture);
  const std::vector<PoseSample> base(run.times.size(), Pose{});
  std::vector<PoseSample> container;
  if (!run.header.container.name.empty()) container.assign(run.times.size(), run.header.container.X_WT);
  const ContainerShadow shadow(run.header.container, params.lost_depth);
  record::MotionCaptureLog log;
  log.sample_frequency = params.rate;
  log.times = instants.own;
  for (const Tracked& body : tracked_bodies(run, base, container)) {
    Rng frame_error = seed.split("frame of " + body.name);
    const double factor = body.has_error ? 1.0 : 0.0;
    const Pose X_BM = disturbed({}, frame_error, factor * params.position_error, factor * params.rotation_error);
    Rng noise = rng.split("noise of " + body.name);
    const bool is_one_of_those_lost =
        body.half && rng.split("loss of " + body.name).uniform() < params.lost_probability;
    if (is_one_of_those_lost) truth.lost_bodies.push_back(body.name);
    Dropouts dropouts(params, rng.split("dropouts of " + body.name));
    PoseCursor cursor(run.times, *body.poses);
    record::BodyTrack track{body.name, {}};
    track.poses.reserve(instants.own.size());
    for (const double time : instants.simulated) {
      const PoseSample X_WB = cursor.at(time, kAnyGap);
      const bool is_hidden = record::is_tracked(X_WB) && is_one_of_those_lost && shadow.hides(X_WB, *body.half);
      if (!record::is_tracked(X_WB) || is_hidden || dropouts.is_out(time)) {
        const bool holds = params.when_lost == model::WhenLost::Held && !track.poses.empty();
        track.poses.push_back(holds ? track.poses.back() : record::lost_pose());
        continue;
      }
      track.poses.emplace_back(
          disturbed(truth.X_MW * X_WB.pose() * X_BM, noise, params.position_noise, params.rotation_noise));
    }
    log.bodies.push_back(std::move(track));
  }
  return log;
}

/// Index of the first time of `times` after `time`, and how far `time` is between it and the one before.
struct Place {
  std::size_t before = 0, after = 0;
  double share = 0.0;
};
Place find_place(const std::vector<double>& times, double time, std::size_t& next) {
  while (next < times.size() && times[next] <= time) ++next;
  if (next == 0) return {0, 0, 0.0};
  if (next == times.size()) return {times.size() - 1, times.size() - 1, 0.0};
  return {next - 1, next, (time - times[next - 1]) / (times[next] - times[next - 1])};
}

record::WrenchLog measure_forces(const SimulatedRun& run, const model::ForceTorqueParams& params, const Rng& rng,
                                 MeasureTruth& truth) {
  const Instants instants = sample_times(run, params.rate, truth.force_torque);
  Rng bias_rng = rng.split("bias"), noise = rng.split("noise"), drift = rng.split("drift"), imu = rng.split("imu");
  truth.bias.force = noise_vector(bias_rng, params.force_bias);
  truth.bias.torque = noise_vector(bias_rng, params.torque_bias);
  Wrench bias = truth.bias;
  const double root = std::sqrt(1.0 / params.rate);
  record::WrenchLog log;
  log.times = instants.own;
  std::size_t next = 0;
  for (const double time : instants.simulated) {
    const Place at = find_place(run.times, time, next);
    const auto between = [&](const Vector3& a, const Vector3& b) -> Vector3 { return a + at.share * (b - a); };
    const Wrench &a = run.wrench[at.before], &b = run.wrench[at.after];
    Wrench read{between(a.force, b.force) + bias.force, between(a.torque, b.torque) + bias.torque};
    read.force += noise_vector(noise, params.force_noise);
    read.torque += noise_vector(noise, params.torque_noise);
    log.wrenches.push_back(read);
    const double span = run.times[at.after] - run.times[at.before];
    Vector3 acceleration = Vector3::Zero();
    if (span > 0.0) acceleration = (run.tool_twist[at.after].linear - run.tool_twist[at.before].linear) / span;
    const Matrix3 R_WE = run.tool[at.before].pose().R;
    log.accelerations.push_back(R_WE.transpose() * (acceleration + Vector3(0.0, 0.0, kGravity)) +
                                noise_vector(imu, params.acceleration_noise));
    bias.force += noise_vector(drift, params.force_drift * root);
    bias.torque += noise_vector(drift, params.torque_drift * root);
  }
  return log;
}

record::RobotLog measure_robot(const SimulatedRun& run, const model::EncoderParams& params, const Rng& rng,
                               const MeasureTruth& truth) {
  const Instants instants = sample_times(run, params.rate, truth.encoders);
  Rng noise = rng.split("noise");
  record::RobotLog log;
  log.times = instants.own;
  for (const char* word : {"actual_q_", "actual_qd_"})
    for (std::size_t j = 0; j < run.joints.size(); ++j) log.names.push_back(word + std::to_string(j));
  log.names.emplace_back("actual_digital_output_bits");
  log.columns.resize(log.names.size());
  PoseCursor cursor(run.times, run.tool);
  std::size_t next = 0;
  for (const double time : instants.simulated) {
    const Place at = find_place(run.times, time, next);
    const std::size_t joints = run.joints.size();
    for (std::size_t j = 0; j < joints; ++j) {
      const record::JointSample &a = run.joints[j][at.before], &b = run.joints[j][at.after];
      const double q = a.position + at.share * (b.position - a.position);
      const double qd = a.velocity + at.share * (b.velocity - a.velocity);
      log.columns[j].push_back(q + params.position_noise * noise.normal());
      log.columns[joints + j].push_back(qd + params.velocity_noise * noise.normal());
    }
    const int blow_off = run.blow_off.empty() ? 0 : run.blow_off[at.before];
    log.columns.back().push_back(run.vacuum[at.before] +
                                 2 * blow_off);  // digital outputs 0 and 1, as urscript has them
    log.tool.emplace_back(
        disturbed(cursor.at(time, kAnyGap).pose(), noise, params.tool_position_noise, params.tool_rotation_noise));
  }
  return log;
}

std::vector<record::ArchiveObject> describe_objects(const SimulatedRun& run) {
  std::optional<model::Scenario> scenario;
  try {
    scenario = model::parse_scenario(run.header.scenario_text, run.header.bodies.empty() ? "scenario" : run.name);
  } catch (const InputError&) {  // of an earlier version: inertia is then unknown
  }
  std::vector<record::ArchiveObject> objects;
  for (const std::size_t i : find_boxes(run.header)) {
    const record::BodyInfo& body = run.header.bodies[i];
    record::ArchiveObject object;
    object.name = record::archive_name(body.name);
    object.mass = body.mass;
    if (scenario) {
      if (const model::Parcel* parcel = model::find_parcel(*scenario, body.name))
        object.inertia = parcel->inertia.inertia;
    }
    if (const std::optional<Vector3> half = half_size(body)) {
      object.dimensions = 2.0 * *half;
      for (int corner = 0; corner < 8; ++corner)
        object.vertices.emplace_back((corner & 1) != 0 ? half->x() : -half->x(),
                                     (corner & 2) != 0 ? half->y() : -half->y(),
                                     (corner & 4) != 0 ? half->z() : -half->z());
    }
    objects.push_back(std::move(object));
  }
  std::sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return objects;
}

/// "Rec_20230511T093000Z", some minutes after the date given.
std::string recording_name(const std::string& date, int minutes) {
  const auto refuse = [&] {
    throw InputError("command line", "--date", "'" + date + "'", "a date like 20230511T093000Z");
  };
  int y = 0, m = 0, d = 0, H = 0, M = 0, S = 0, length = 0;
  if (std::sscanf(date.c_str(), "%4d%2d%2dT%2d%2d%2dZ%n", &y, &m, &d, &H, &M, &S, &length) != 6 ||
      length != static_cast<int>(date.size()) || date.size() != 16)
    refuse();
  const std::chrono::year_month_day day{std::chrono::year(y), std::chrono::month(static_cast<unsigned>(m)),
                                        std::chrono::day(static_cast<unsigned>(d))};
  if (!day.ok() || H > 23 || M > 59 || S > 59 || H < 0 || M < 0 || S < 0) refuse();
  const auto time =
      std::chrono::sys_days(day) + std::chrono::hours(H) + std::chrono::minutes(M + minutes) + std::chrono::seconds(S);
  const auto midnight = std::chrono::floor<std::chrono::days>(time);
  const std::chrono::year_month_day at(midnight);
  const std::chrono::hh_mm_ss clock(time - midnight);
  return fmt::format("Rec_{:04}{:02}{:02}T{:02}{:02}{:02}Z", static_cast<int>(at.year()),
                     static_cast<unsigned>(at.month()), static_cast<unsigned>(at.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count());
}

nlohmann::ordered_json clock_as_json(const ClockTruth& clock) {
  return {{"offset_s", clock.offset}, {"rate_ppm", 1e6 * clock.rate}};
}

}  // namespace

VirtualMeasurement measure(const SimulatedRun& run, const model::Sensors& sensors, const MeasureOptions& options) {
  const Rng seed = Rng(options.seed).split("measure");
  const Rng rng = seed.split("repetition " + std::to_string(options.repetition));
  VirtualMeasurement result;
  MeasureTruth& truth = result.truth;
  truth.motion_capture = draw_clock(sensors.motion_capture.clock, rng.split("clock of motion capture"));
  truth.force_torque = draw_clock(sensors.force_torque.clock, rng.split("clock of force/torque"));
  truth.encoders = draw_clock(sensors.encoders.clock, rng.split("clock of encoders"));
  truth.X_MW = draw_world(seed.split("world of motion capture"));
  record::ArchiveRecording& recording = result.recording;
  recording.name = recording_name(options.date, kMinutesBetween * (options.repetition - 1));
  recording.remarks = {
      {"note", fmt::format("virtual experiment, seed {}: what sensors would have seen of {}", options.seed, run.name)},
      {"repetition", fmt::format("{} of {}", options.repetition, options.repetitions)}};
  if (!run.header.sequence.empty()) recording.remarks.emplace_back("sequence", run.header.sequence);
  if (!run.header.program_name.empty())
    recording.remarks.emplace_back("program", std::filesystem::path(run.header.program_name).filename().string());
  recording.motion_capture = measure_poses(run, sensors.motion_capture, seed, rng.split("motion capture"), truth);
  recording.force_torque = measure_forces(run, sensors.force_torque, rng.split("force/torque"), truth);
  recording.robot = measure_robot(run, sensors.encoders, rng.split("encoders"), truth);
  recording.objects = describe_objects(run);
  return result;
}

std::string format_json(const MeasureTruth& truth, const std::string& name) {
  const Vector6 bias = as_vector(truth.bias);
  const Quaternion quat(truth.X_MW.R);
  const nlohmann::ordered_json json = {
      {"name", name},
      {"clocks",
       {{"motion_capture", clock_as_json(truth.motion_capture)},
        {"force_torque", clock_as_json(truth.force_torque)},
        {"encoders", clock_as_json(truth.encoders)}}},
      {"bias", {{"force_N", {bias[0], bias[1], bias[2]}}, {"torque_Nm", {bias[3], bias[4], bias[5]}}}},
      {"X_MW",
       {{"p", {truth.X_MW.p.x(), truth.X_MW.p.y(), truth.X_MW.p.z()}},
        {"quat_wxyz", {quat.w(), quat.x(), quat.y(), quat.z()}}}},
      {"lost_bodies", truth.lost_bodies}};
  return json.dump();
}

}  // namespace snug::validation
