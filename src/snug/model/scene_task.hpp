// SceneTask: which numbers of a scenario to tune so that simulated bodies follow recorded ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/field.hpp"

namespace snug::model {

/// How a parameter changes the numbers at its paths.
enum class ParameterForm {
  Value,   ///< they are the parameter
  Scale,   ///< what the scenario says times the parameter
  Offset,  ///< what the scenario says plus the parameter
};

struct TaskParameter {
  std::string name;
  std::vector<std::string> paths;  ///< numbers of the scenario, see NumberEdit
  ParameterForm form = ParameterForm::Value;
  double value = 0.0;  ///< to start from, and the result of an earlier identification
  double low = 0.0, high = 0.0;
  double step = 0.0;  ///< for differences; large enough to be seen above what contacts do at random
  bool is_fixed = false;
  std::string where;  ///< "file:line", for messages
  bool operator==(const TaskParameter&) const = default;
};

/// A body and the columns of a recording that tell where it is.
struct RecordedObject {
  std::string body;                     ///< of the scenario; of a program's run: the parcel's id
  std::vector<std::string> columns;     ///< x, y, z [m], qw, qx, qy, qz (body -> world)
  std::vector<std::string> velocities;  ///< vx, vy, vz [m/s], wx, wy, wz [rad/s], world; or none
  std::vector<std::string> result;      ///< where the recording has the pose at the end, as `columns`; or none
  bool operator==(const RecordedObject&) const = default;
};

/// Where the tracked bodies of a recording start.
enum class StartFrom {
  Scenario,    ///< where the scenario says
  FirstRow,    ///< where the first row has them, with its velocities
  FreeFlight,  ///< as fits the rows before the first touch best: ballistic, turning freely
};

/// What the cost of a sample grows with.
enum class TaskLoss {
  Squares,   ///< the square of the error: smooth, for least squares
  Distance,  ///< the error itself: few that go another way count less; for chaotic motions
};

struct StartSettings {
  StartFrom from = StartFrom::FirstRow;
  int samples = 25;       ///< of the flight, at most, the first ones
  double margin = 0.002;  ///< m, gap to anything else below which a body may touch
  bool operator==(const StartSettings&) const = default;
};

/// What each recording has of its own, with the standard deviation expected of it; 0: it is not fitted.
struct OwnSettings {
  double velocity = 0.0;          ///< m/s, of each axis of the start velocity
  double angular_velocity = 0.0;  ///< rad/s
  double delay = 0.0;             ///< s, recorded times less those of the simulation
  double clock_rate = 0.0;        ///< relative, of its clock
  double bias = 0.0;              ///< m, of recorded positions, each axis
  double bias_rotation = 0.0;     ///< rad, of recorded poses about the world's origin, each axis
  double frame_position = 0.0;    ///< m, of the recorded frame of each tracked body in that body, each axis
  double frame_rotation = 0.0;    ///< rad, the same

  template <class Archive>
  void fields(Archive& a) {
    a("velocity", velocity, Range::NotNegative);
    a("angular_velocity", angular_velocity, Range::NotNegative);
    a("delay", delay, Range::NotNegative);
    a("clock_rate", clock_rate, Range::NotNegative);
    a("bias", bias, Range::NotNegative);
    a("bias_rotation_deg", Degrees{bias_rotation}, Range::NotNegative);
    a("frame_position", frame_position, Range::NotNegative);
    a("frame_rotation_deg", Degrees{frame_rotation}, Range::NotNegative);
  }
  bool operator==(const OwnSettings&) const = default;
};

struct SearchSettings {
  int scatter = 0;    ///< points spread over the bounds before the local search; the best one joins the start
  int global = 0;     ///< evaluations of the global search (controlled random search), 0: none
  int local = 200;    ///< evaluations of the local one, at most
  int held_back = 5;  ///< each so many-th recording is kept out of the fit
  std::uint64_t seed = 1;
  bool operator==(const SearchSettings&) const = default;
};

/// What moves the tool in a run of a whole cell.
enum class TaskMotion {
  Auto,      ///< the program where its tool goes as the recorded one, else the recording
  Program,   ///< the controller, on the program
  Recorded,  ///< the tool's recorded poses and the vacuum's recorded switch
};

/// A run of a whole cell instead of bodies alone.
struct TaskProgram {
  std::filesystem::path file;
  std::string sequence;
  std::string corrections;          ///< name of a layer of the scenario, or empty
  std::optional<bool> with_phases;  ///< the cup's vacuum phases; absent: as the corrections were made for
  TaskMotion motion = TaskMotion::Auto;
  std::optional<std::string> controller;  ///< lagged, exact, fast; absent: as the program was packed
  std::optional<double> tempo;            ///< with fast; absent: that it was packed with
  /// Name of the scenario's robot, through whose joints the program goes; "none": the tool moves by itself; absent: the
  /// one that the program was packed with, if the scenario has it, else none.
  std::optional<std::string> robot;
  bool operator==(const TaskProgram&) const = default;
};

struct SceneTask {
  std::filesystem::path path;  ///< the file
  std::string text;            ///< its text
  std::filesystem::path scenario;
  std::optional<TaskProgram> program;
  std::vector<std::filesystem::path> recordings;  ///< report: csv_path
  bool use_position = true;                       ///< report: optimize_position
  bool use_rotation = true;                       ///< report: optimize_rotation
  double rotation_position_ratio = 0.0;           ///< m per rad; report: rot_pos_error_ratio
  bool only_final_state = false;
  std::optional<double> time_step;        ///< s, instead of the scenario's
  std::optional<double> simulation_time;  ///< s, at most
  std::string recording_column;           ///< rows with the same number in it are one recording; empty: all rows
  std::string time_column = "t";
  std::vector<RecordedObject> tracked;    ///< report: tracked_objects
  std::vector<RecordedObject> kinematic;  ///< report: kinematic_bodies
  double position_noise = 0.001;          ///< m, of recorded positions, each axis
  double rotation_noise = 0.01;           ///< rad
  TaskLoss loss = TaskLoss::Squares;
  double right_within = 0.5235987755982988;  ///< rad, rotation error at the end up to which an orientation is right
  StartSettings start;
  OwnSettings own;
  double clock_rate = 1e-4;  ///< relative, expected of the clock that recorded, the same in all recordings: quartz
  SearchSettings search;
  std::vector<TaskParameter> parameters;
  bool operator==(const SceneTask&) const = default;
};

/// Reads a TASK.yaml (docs/identification.md). Throws InputError (file:line, key, got, expected, nearest name) for
/// anything it does not understand or that cannot be. Files are relative to the task's folder.
[[nodiscard]] SceneTask load_scene_task(const std::filesystem::path& path);
[[nodiscard]] SceneTask parse_scene_task(std::string_view text, const std::filesystem::path& path);

/// The text of the task with these values in its parameters, files still named relative to `folder`.
[[nodiscard]] std::string text_with_values(const SceneTask& task, const std::vector<double>& values,
                                           const std::filesystem::path& folder);

}  // namespace snug::model
