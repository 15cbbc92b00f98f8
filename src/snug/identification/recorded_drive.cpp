// RecordedDrive: from the robot's log of an archive, and where motion capture saw boxes.
#include "snug/identification/recorded_drive.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace snug::identification {
namespace {

constexpr const char* kOutputs = "actual_digital_output_bits";
constexpr unsigned kVacuumBit = 1, kBlowOffBit = 2;

const std::vector<double>* find_outputs(const record::RobotLog& log) {
  for (std::size_t k = 0; k < log.names.size(); ++k)
    if (log.names[k] == kOutputs) return &log.columns[k];
  return nullptr;
}

/// The tool between the samples of a log.
class SmoothPath {
 public:
  explicit SmoothPath(const record::RobotLog& log) : times_(log.times) {
    for (const record::PoseSample& sample : log.tool) poses_.push_back(sample.pose());
    first_ = times_.front();
  }
  /// `time`: after the first sample, s; growing from call to call.
  motion::ToolState at(double time) {
    constexpr std::size_t kCount = 7;
    const double wanted = first_ + time;
    while (next_ + 1 < times_.size() && times_[next_] < wanted) ++next_;
    const std::size_t most = times_.size() - std::min(kCount, times_.size());
    const std::size_t begin = std::min(next_ > kCount / 2 ? next_ - kCount / 2 : 0, most);
    const std::size_t count = std::min(kCount, times_.size() - begin);
    const Pose& middle = poses_[std::min(next_, times_.size() - 1)];
    const double span = std::max(times_[begin + count - 1] - times_[begin], 1e-9);
    const auto terms = static_cast<Eigen::Index>(std::min<std::size_t>(4, count));
    Eigen::MatrixXd A(static_cast<Eigen::Index>(count), terms), y(static_cast<Eigen::Index>(count), 6);
    for (std::size_t k = 0; k < count; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      double power = 1.0;
      for (Eigen::Index j = 0; j < terms; ++j, power *= (times_[begin + k] - wanted) / span) A(row, j) = power;
      y.block<1, 3>(row, 0) = (poses_[begin + k].p - middle.p).transpose();
      y.block<1, 3>(row, 3) = log_rotation(poses_[begin + k].R * middle.R.transpose()).transpose();
    }
    const Eigen::MatrixXd c = A.householderQr().solve(y);
    const Vector3 turn = c.block<1, 3>(0, 3).transpose();
    motion::ToolState state;
    state.X_WE = {exp_rotation(turn) * middle.R, middle.p + Vector3(c.block<1, 3>(0, 0).transpose())};
    if (terms < 2) return state;
    // The turn since the nearest sample is a few milliradians: its rate is the angular velocity to first order.
    state.V_WE = {Vector3(c.block<1, 3>(1, 0).transpose()) / span, Vector3(c.block<1, 3>(1, 3).transpose()) / span};
    return state;
  }

 private:
  const std::vector<double>& times_;
  std::vector<Pose> poses_;
  double first_ = 0.0;
  std::size_t next_ = 0;
};

bool is_near(const Pose& a, const Pose& b, double distance, double angle) {
  return (a.p - b.p).norm() <= distance && log_rotation(a.R.transpose() * b.R).norm() <= angle;
}

/// Where the box stood before the tool first sucked beside it, and since when.
std::optional<RecordedDrive::Arrival> find_arrival(const std::string& parcel, const std::vector<double>& times,
                                                   const std::vector<record::PoseSample>& poses,
                                                   const RecordedDrive& drive) {
  constexpr double kReach = 0.3;    // m, of the tool's end from the middle of a box that it picks
  constexpr double kBefore = 0.3;   // s, before the vacuum: the lip may already press the box
  constexpr double kOver = 0.2;     // s, that the pose is the mean of
  constexpr double kStays = 0.003;  // m; noise and the press of the lip
  constexpr double kStaysTurn = 0.035;
  const auto tick_of = [&](double time) {
    const double index = std::clamp(std::ceil(time / drive.tick), 0.0, static_cast<double>(drive.tool.size() - 1));
    return static_cast<std::size_t>(index);
  };
  std::optional<std::size_t> first, last;  // of the samples before it is picked
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!record::is_tracked(poses[k])) continue;
    const std::size_t tick = tick_of(times[k]);
    const bool is_picked = drive.vacuum[tick] && (drive.tool[tick].X_WE.p - poses[k].p).norm() < kReach;
    if (is_picked && last) break;
    if (!first) first = k;
    last = k;
  }
  if (!last) return std::nullopt;
  std::vector<std::size_t> rest;
  for (std::size_t k = *last + 1; k-- > *first;) {
    if (!record::is_tracked(poses[k]) || times[k] > times[*last] - kBefore) continue;
    if (times[k] < times[*last] - kBefore - kOver) break;
    rest.push_back(k);
  }
  if (rest.empty()) rest.push_back(*first);
  const Pose near = poses[rest.front()].pose();
  Vector3 p = Vector3::Zero(), turn = Vector3::Zero();
  for (const std::size_t k : rest) {
    p += poses[k].p / static_cast<double>(rest.size());
    turn += log_rotation(near.R.transpose() * poses[k].pose().R) / static_cast<double>(rest.size());
  }
  RecordedDrive::Arrival arrival{parcel, times[rest.back()], {near.R * exp_rotation(turn), p}};
  for (std::size_t k = rest.back() + 1; k-- > *first;) {
    if (!record::is_tracked(poses[k])) continue;
    if (!is_near(poses[k].pose(), arrival.X_WP, kStays, kStaysTurn)) break;
    arrival.time = times[k];
  }
  return arrival;
}

}  // namespace

bool has_drive(const record::ArchiveRecording& recording) {
  const record::RobotLog& log = recording.robot;
  return log.tool.size() >= 8 && find_outputs(log) != nullptr &&
         std::ranges::all_of(log.tool, [](const record::PoseSample& pose) { return record::is_tracked(pose); });
}

validation::SimulatedRun run_of_log(const record::ArchiveRecording& recording,
                                    const std::vector<std::string>& parcels) {
  const record::RobotLog& log = recording.robot;
  validation::SimulatedRun run;
  run.name = recording.name;
  for (const double time : log.times) run.times.push_back(time - log.times.front());
  const std::vector<double>& outputs = *find_outputs(log);
  for (const std::string& parcel : parcels) {
    record::BodyInfo body;
    body.name = parcel;
    body.type = "parcel";
    run.header.bodies.push_back(body);
    run.bodies.emplace_back(run.times.size(), record::lost_pose());
  }
  run.tool = log.tool;
  run.lip = log.tool;
  run.tool_twist.assign(run.times.size(), Twist{});
  run.wrench.assign(run.times.size(), Wrench{});
  run.attached.assign(run.times.size(), -1);
  for (const double bits : outputs) run.vacuum.push_back((static_cast<unsigned>(bits) & kVacuumBit) != 0 ? 1 : 0);
  return run;
}

RecordedDrive make_drive(const record::ArchiveRecording& recording, const validation::SimulatedRun& run,
                         const validation::Measurement& measured, double tick) {
  const std::vector<double>& outputs = *find_outputs(recording.robot);
  RecordedDrive drive;
  drive.tick = tick;
  SmoothPath path(recording.robot);
  std::size_t sample = 0;
  for (std::size_t k = 0; static_cast<double>(k) * tick <= run.times.back(); ++k) {
    const double time = static_cast<double>(k) * tick;
    drive.tool.push_back(path.at(time));
    while (sample + 1 < run.times.size() && run.times[sample] < time - 1e-9) ++sample;
    const auto bits = static_cast<unsigned>(outputs[sample]);
    drive.vacuum.push_back((bits & kVacuumBit) != 0);
    drive.blow_off.push_back((bits & kBlowOffBit) != 0);
  }
  for (std::size_t b = 0; b < run.header.bodies.size(); ++b) {
    if (measured.bodies[b].empty()) continue;
    if (const auto arrival = find_arrival(run.header.bodies[b].name, measured.pose_times, measured.bodies[b], drive))
      drive.arrivals.push_back(*arrival);
  }
  std::ranges::stable_sort(drive.arrivals, {}, &RecordedDrive::Arrival::time);
  return drive;
}

}  // namespace snug::identification
