// RecordedMotion: from tables.
#include "snug/identification/recorded_motion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/table.hpp"
#include "snug/identification/internal/measured_table.hpp"
#include "snug/identification/internal/program_clock.hpp"
#include "snug/identification/internal/program_motion.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/validation/measurement.hpp"

namespace snug::identification {
namespace {

/// Where the columns of a body stand in the table.
struct BodyColumns {
  std::size_t pose = 0, velocity = 0, result = 0;
  bool has_velocity = false, has_result = false;
};

/// Adds the names and says where the first of them is.
std::size_t add_columns(std::vector<std::string>& columns, const std::vector<std::string>& names,
                        const std::string& where) {
  const std::size_t first = columns.size();
  for (const std::string& name : names) {
    if (std::find(columns.begin(), columns.end(), name) != columns.end())
      throw InputError(where, "column '" + name + "'", "it twice", "each column of the recording for one thing");
    columns.push_back(name);
  }
  return first;
}

BodyColumns add_object(std::vector<std::string>& columns, const model::RecordedObject& object,
                       const std::string& where) {
  BodyColumns at;
  at.pose = add_columns(columns, object.columns, where);
  at.has_velocity = !object.velocities.empty();
  if (at.has_velocity) at.velocity = add_columns(columns, object.velocities, where);
  at.has_result = !object.result.empty();
  if (at.has_result) at.result = add_columns(columns, object.result, where);
  return at;
}

/// Lost where the row has none of the seven numbers.
record::PoseSample pose_at(const Table& table, std::size_t row, std::size_t first) {
  constexpr std::size_t kNumbers = 7;
  std::size_t missing = 0, gap = first;
  for (std::size_t k = first; k < first + kNumbers; ++k) {
    if (!std::isnan(table.rows[row][k])) continue;
    if (missing++ == 0) gap = k;
  }
  if (missing == kNumbers) return record::lost_pose();
  if (missing > 0)
    throw InputError(table.where(row), table.columns[gap], "nothing beside other numbers of the same pose",
                     "a number, or a pose that is lost as a whole");
  return Pose{internal::rotation_at(table, row, first + 3), internal::vector_at(table, row, first)};
}

void add_row(const Table& table, std::size_t row, const BodyColumns& columns, RecordedBody& body) {
  body.poses.push_back(pose_at(table, row, columns.pose));
  if (columns.has_velocity)
    body.twists.push_back(
        {internal::vector_at(table, row, columns.velocity), internal::vector_at(table, row, columns.velocity + 3)});
  if (columns.has_result) body.result = pose_at(table, row, columns.result);
}

/// The mean of poses that are near each other; lost if any of them is.
record::PoseSample mean_pose(std::span<const record::PoseSample> poses) {
  Vector3 p = Vector3::Zero(), turn = Vector3::Zero();
  for (const record::PoseSample& sample : poses) {
    if (!record::is_tracked(sample)) return record::lost_pose();
    p += sample.p;
    turn += log_rotation(poses.front().pose().R.transpose() * sample.pose().R);
  }
  const double share = 1.0 / static_cast<double>(poses.size());
  return Pose{poses.front().pose().R * exp_rotation(share * turn), share * p};
}

/// Where all means of a while are one pose but for their noise, that pose takes their place: a body that rests for two
/// hundred seconds has no more to say than where.
void merge_rest(const model::SceneTask& task, std::size_t together, RecordedBody& body) {
  constexpr double kMost = 4.0;  // standard deviations, of the furthest of some 200 numbers
  for (std::size_t first = 0; first + together <= body.poses.size(); first += together) {
    const std::span<record::PoseSample> poses = std::span(body.poses).subspan(first, together);
    const std::span<int> averaged = std::span(body.averaged).subspan(first, together);
    const record::PoseSample mean = mean_pose(poses);
    if (!record::is_tracked(mean)) continue;
    const Pose X_WM = mean.pose();
    const double share = kMost / std::sqrt(static_cast<double>(averaged.front()));
    const bool is_at_rest = std::ranges::all_of(poses, [&](const record::PoseSample& pose) {
      return (pose.p - X_WM.p).cwiseAbs().maxCoeff() <= share * task.position_noise &&
             log_rotation(X_WM.R.transpose() * pose.pose().R).cwiseAbs().maxCoeff() <= share * task.rotation_noise;
    });
    if (!is_at_rest) continue;
    std::ranges::fill(poses, record::lost_pose());
    poses[together / 2] = mean;
    averaged[together / 2] *= static_cast<int>(together);
  }
}

/// What one recording has of the task's bodies, on the clock of `run`.
RecordedMotion motion_of(const model::SceneTask& task, const validation::SimulatedRun& run,
                         const record::ArchiveRecording& recording, const validation::Measurement& measured,
                         const std::string& where) {
  constexpr double kMeanOver = 1.0 / 60.0;  // s: boxes move at some Hz
  constexpr double kRestOver = 0.5;         // s
  if (!measured.has_poses())
    throw InputError(where, recording.name, "poses whose clock is not found", "a run of this program");
  RecordedMotion motion;
  motion.name = recording.name;
  motion.world_position_error = measured.base_position_error;
  motion.world_rotation_error = measured.base_rotation_error;
  const double end = task.simulation_time.value_or(run.times.back());
  const std::vector<double>& times = measured.pose_times;
  const double period =
      (times.back() - times.front()) / static_cast<double>(std::max<std::size_t>(1, times.size() - 1));
  const auto each = static_cast<std::size_t>(std::clamp(std::round(kMeanOver / period), 1.0, 1e6));
  motion.period = period;
  const double half = 0.5 * period * static_cast<double>(each);
  const auto at_rest = 2 * static_cast<std::size_t>(0.5 * kRestOver / (2.0 * half)) + 1;  // means, an odd number
  std::vector<std::size_t> firsts;                                                        // of the samples of each mean
  for (std::size_t k = 0; k + each <= times.size(); k += each) {
    const double middle = 0.5 * (times[k] + times[k + each - 1]);
    if (middle < half || middle > end - half) continue;
    firsts.push_back(k);
    motion.times.push_back(middle);
  }
  for (const model::RecordedObject& object : task.tracked) {
    const int index = record::find_body(run.header, object.body);
    if (index < 0 || measured.bodies[static_cast<std::size_t>(index)].empty())
      throw InputError(where, recording.name, "no poses of '" + object.body + "'", "those of every tracked object");
    RecordedBody& body = motion.tracked.emplace_back();
    body.body = object.body;
    const std::vector<record::PoseSample>& poses = measured.bodies[static_cast<std::size_t>(index)];
    for (const std::size_t first : firsts) body.poses.push_back(mean_pose(std::span(poses).subspan(first, each)));
    body.averaged.assign(body.poses.size(), static_cast<int>(each));
    merge_rest(task, at_rest, body);
  }
  if (motion.times.size() < 2)
    throw InputError(where, recording.name, "hardly any poses", "some of the time simulated");
  return motion;
}

/// Of the robot's log; null where none was found.
const validation::ClockFit* find_robot_clock(const validation::Measurement& measured) {
  const auto clock = std::ranges::find(measured.clocks, "robot", &validation::SourceClock::source);
  return clock != measured.clocks.end() && clock->fit ? &*clock->fit : nullptr;
}

/// Whether the simulated tool goes as the recorded one, at the same time.
bool goes_alike(const validation::SimulatedRun& run, const record::ArchiveRecording& recording,
                const validation::ClockFit* clock) {
  if (clock == nullptr) return false;
  const auto to_run = [&](double time) { return clock->to_reference(time); };
  return internal::find_path_distance(run, recording, to_run, 0.0) <= kSameTool;
}

std::vector<std::string> parcels_of(const model::SceneTask& task) {
  const model::Scenario scenario = model::load_scenario(task.scenario);
  const model::Sequence* sequence = model::find_sequence(scenario, task.program->sequence);
  if (sequence == nullptr)
    throw InputError(task.path.string(), "program", "sequence '" + task.program->sequence + "'",
                     "a sequence of the scenario");
  std::vector<std::string> parcels;
  for (const model::Item& item : sequence->items) parcels.push_back(item.parcel);
  return parcels;
}

/// s, what the robot's log shows at the start of the program, where the program is a session's and its tool goes as the
/// recorded one, some ticks early or late: rows end by what is felt, which the parameters change.
std::optional<double> find_session_start(const model::SceneTask& task, const validation::SimulatedRun& run,
                                         const record::ArchiveRecording& recording, const validation::ClockFit* clock) {
  constexpr double kEarlyOrLate = 0.1;  // s
  const motion::Program program = motion::load_program(task.program->file);
  const auto is_timed = [](const motion::Waypoint& one) { return one.not_before.has_value(); };
  if (clock == nullptr || std::ranges::none_of(program.waypoints, is_timed)) return {};
  const double first = recording.robot.times.front();
  const std::optional<double> start = internal::find_program_start(run, recording, first - clock->to_reference(first));
  if (!start) return {};
  const auto to_run = [&](double time) { return time - *start; };
  return internal::find_path_distance(run, recording, to_run, kEarlyOrLate) <= kSameTool ? start : std::nullopt;
}

/// Of a program that leads, whose clock is that of the robot's log.
RecordedMotion session_motion(const model::SceneTask& task, const validation::SimulatedRun& run,
                              const record::ArchiveRecording& recording, double start, const std::string& where) {
  validation::SimulatedRun log = run_of_log(recording, parcels_of(task));
  validation::Measurement measured = validation::align(log, recording, {}, where);
  for (double& time : measured.pose_times) time += recording.robot.times.front() - start;
  log.times = run.times;
  return motion_of(task, log, recording, measured, where);
}

/// The recording itself leads the tool.
RecordedMotion led_motion(const model::SceneTask& task, const record::ArchiveRecording& recording,
                          const std::string& where) {
  if (!has_drive(recording))
    throw InputError(where, '/' + recording.name, "no tool poses with actual_digital_output_bits of the robot",
                     "both, to lead the tool as recorded; or program: {motion: program}");
  const validation::SimulatedRun run = run_of_log(recording, parcels_of(task));
  const validation::Measurement measured = validation::align(run, recording, {}, where);
  RecordedMotion motion = motion_of(task, run, recording, measured, where);
  motion.drive = make_drive(recording, run, measured, model::load_scenario(task.scenario).controller.tick);
  return motion;
}

}  // namespace

std::vector<RecordedMotion> parse_motions(const model::SceneTask& task, const std::string& text,
                                          const std::string& name) {
  const std::string where = task.path.string();
  std::vector<std::string> names;
  (void)add_columns(names, {task.time_column}, where);
  if (!task.recording_column.empty()) (void)add_columns(names, {task.recording_column}, where);
  std::vector<BodyColumns> tracked, kinematic;
  for (const model::RecordedObject& object : task.tracked) tracked.push_back(add_object(names, object, where));
  for (const model::RecordedObject& object : task.kinematic) kinematic.push_back(add_object(names, object, where));
  const Table table = parse_table_with_gaps(text, name, names);
  std::vector<RecordedMotion> motions;
  std::map<double, std::size_t> place;  // of each number in the recording column
  const std::string file = std::filesystem::path(name).filename().string();
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const double key = task.recording_column.empty() ? 0.0 : table.rows[row][1];
    const auto [found, is_new] = place.emplace(key, motions.size());
    if (is_new) {
      RecordedMotion& motion = motions.emplace_back();
      motion.name = task.recording_column.empty() ? file : fmt::format("{}, {} {}", file, task.recording_column, key);
      for (const model::RecordedObject& object : task.tracked) motion.tracked.push_back({object.body, {}, {}, {}});
      for (const model::RecordedObject& object : task.kinematic) motion.kinematic.push_back({object.body, {}, {}, {}});
    }
    RecordedMotion& motion = motions[found->second];
    const double time = table.rows[row][0];
    if (std::isnan(time) || std::isnan(key))
      throw InputError(table.where(row), task.time_column, "nothing", "a number in every row");
    if (!motion.times.empty() && time <= motion.times.back())
      throw InputError(table.where(row), task.time_column, fmt::format("{} after {}", time, motion.times.back()),
                       "times that grow within a recording");
    motion.times.push_back(time);
    for (std::size_t i = 0; i < tracked.size(); ++i) add_row(table, row, tracked[i], motion.tracked[i]);
    for (std::size_t i = 0; i < kinematic.size(); ++i) add_row(table, row, kinematic[i], motion.kinematic[i]);
  }
  if (motions.empty()) throw InputError(name, "", "no rows", "at least one recording");
  for (RecordedMotion& motion : motions) {
    for (const RecordedBody& body : motion.tracked)
      if (!task.program && task.start.from != model::StartFrom::Scenario && !record::is_tracked(body.poses.front()))
        throw InputError(name, motion.name, "no pose of '" + body.body + "' in its first row",
                         "one, from which the body starts; or start: {from: scenario}");
    const bool has_result = motion.tracked.front().result.has_value();
    if (motion.times.size() < 2 && !(task.only_final_state && has_result))
      throw InputError(name, motion.name, "a single row", "at least two rows of each recording");
  }
  return motions;
}

std::vector<RecordedMotion> motions_of_archive(const model::SceneTask& task, const record::Recording& simulated,
                                               const std::vector<record::ArchiveRecording>& recordings,
                                               const std::string& where) {
  std::optional<validation::SimulatedRun> run;
  if (task.program->motion != model::TaskMotion::Recorded) run = validation::make_run(simulated, "simulation");
  std::vector<RecordedMotion> motions;
  for (const record::ArchiveRecording& recording : recordings) {
    if (recording.motion_capture.times.empty()) continue;
    if (run) {
      const validation::Measurement measured = validation::align(*run, recording, {}, where);
      const bool may_lead = task.program->motion == model::TaskMotion::Auto && has_drive(recording);
      const validation::ClockFit* clock = find_robot_clock(measured);
      if (!may_lead || goes_alike(*run, recording, clock)) {
        motions.push_back(motion_of(task, *run, recording, measured, where));
        continue;
      }
      if (const std::optional<double> start = find_session_start(task, *run, recording, clock)) {
        motions.push_back(session_motion(task, *run, recording, *start, where));
        continue;
      }
    }
    motions.push_back(led_motion(task, recording, where));
  }
  if (motions.empty()) throw InputError(where, "", "no poses", "at least one recording of a sequence");
  return motions;
}

std::vector<RecordedMotion> load_motions(const model::SceneTask& task,
                                         const std::vector<std::filesystem::path>& files) {
  std::vector<RecordedMotion> motions;
  std::optional<internal::CapturedRun> run;  // whose clock archives are brought to
  for (const std::filesystem::path& file : files) {
    if (task.program && file.extension() == ".h5") {
      const std::vector<record::ArchiveRecording> recordings = record::load_archive(file).recordings;
      if (!run) {
        run.emplace();
        if (task.program->motion != model::TaskMotion::Recorded)
          run = internal::capture_program(model::load_scenario(task.scenario), *task.program, task.simulation_time);
      }
      for (RecordedMotion& motion : motions_of_archive(task, run->recording, recordings, file.string()))
        motions.push_back(std::move(motion));
      continue;
    }
    if (task.program && task.program->motion == model::TaskMotion::Recorded)
      throw InputError(task.path.string(), "motion", "recorded, with the table " + file.string(),
                       "an archive (.h5) with the robot's log, or motion: program");
    for (RecordedMotion& motion : parse_motions(task, read_file(file, "a recording (CSV)"), file.string()))
      motions.push_back(std::move(motion));
  }
  return motions;
}

}  // namespace snug::identification
