// SceneTask: its YAML form.
#include "snug/model/scene_task.hpp"

#include <algorithm>
#include <set>

#include "snug/core/read_file.hpp"
#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_text.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::model {
namespace {

using internal::MapReader;
using internal::Value;

std::filesystem::path beside(const Value& value, const std::filesystem::path& task) {
  const std::filesystem::path file = value.name();
  return file.is_absolute() ? file : task.parent_path() / file;
}

std::vector<std::string> column_names(const Value& value, std::size_t count, const std::string& what) {
  std::vector<std::string> names;
  for (const Value& entry : value.list_of(count, what)) names.push_back(entry.name());
  return names;
}

RecordedObject read_object(const Value& value) {
  const MapReader map = value.map("recorded_object", {"body", "columns", "velocity_columns", "result_columns"});
  RecordedObject object;
  object.body = map.require("body").name();
  constexpr const char* kPose = "columns, as [x, y, z, qw, qx, qy, qz]";
  object.columns = {"x", "y", "z", "qw", "qx", "qy", "qz"};
  if (const auto columns = map.find("columns")) object.columns = column_names(*columns, 7, kPose);
  if (const auto columns = map.find("velocity_columns"))
    object.velocities = column_names(*columns, 6, "columns, as [vx, vy, vz, wx, wy, wz]");
  if (const auto columns = map.find("result_columns")) object.result = column_names(*columns, 7, kPose);
  return object;
}

std::vector<RecordedObject> read_objects(const MapReader& map, const char* key) {
  std::vector<RecordedObject> objects;
  if (const auto list = map.find(key))
    for (const Value& entry : list->list()) {
      objects.push_back(read_object(entry));
      for (std::size_t i = 0; i + 1 < objects.size(); ++i)
        if (objects[i].body == objects.back().body)
          entry.fail("body '" + objects[i].body + "' a second time", "each body once");
    }
  return objects;
}

TaskParameter read_parameter(const Value& value) {
  const MapReader map = value.map("parameter", {"name", "path", "paths", "form", "value", "bounds", "step", "fixed"});
  TaskParameter parameter;
  parameter.where = value.where();
  parameter.name = map.require("name").name();
  if (map.require_one_of({"path", "paths"}) == "path") {
    parameter.paths.push_back(map.require("path").name());
  } else {
    for (const Value& path : map.require("paths").list()) parameter.paths.push_back(path.name());
    if (parameter.paths.empty()) map.require("paths").fail("at least one path");
  }
  if (const auto form = map.find("form"))
    parameter.form = static_cast<ParameterForm>(form->choice({"value", "scale", "offset"}));
  const std::vector<Value> bounds = map.require("bounds").list_of(2, "numbers, lowest and highest");
  parameter.low = bounds[0].number();
  parameter.high = bounds[1].number();
  if (!(parameter.low < parameter.high)) bounds[1].fail("a number above " + internal::to_text(parameter.low));
  parameter.value = map.require("value").number();
  if (!(parameter.value >= parameter.low && parameter.value <= parameter.high))
    map.require("value").fail("a number within the bounds");
  parameter.step = 0.01 * (parameter.high - parameter.low);
  if (const auto step = map.find("step")) {
    parameter.step = step->number(Range::Positive);
    if (parameter.step > 0.5 * (parameter.high - parameter.low)) step->fail("at most half of what the bounds span");
  }
  if (const auto fixed = map.find("fixed")) parameter.is_fixed = fixed->boolean();
  return parameter;
}

void read_parameters(const Value& list, SceneTask& task) {
  std::set<std::string> names, paths;
  for (const Value& entry : list.list()) {
    const TaskParameter parameter = read_parameter(entry);
    if (!names.insert(parameter.name).second)
      entry.fail("parameter '" + parameter.name + "' a second time", "each name once");
    for (const std::string& path : parameter.paths)
      if (!paths.insert(path).second)
        entry.fail("path '" + path + "' a second time", "each number in one parameter only");
    task.parameters.push_back(parameter);
  }
  if (task.parameters.empty()) list.fail("at least one parameter");
}

void read_start(const Value& value, StartSettings& start) {
  const MapReader map = value.map("start", {"from", "samples", "margin"});
  if (const auto from = map.find("from"))
    start.from = static_cast<StartFrom>(from->choice({"scenario", "first_row", "free_flight"}));
  if (const auto samples = map.find("samples")) start.samples = static_cast<int>(samples->integer(3, 100'000));
  if (const auto margin = map.find("margin")) start.margin = margin->number_within(0.0, 1.0, "a gap in m");
}

void read_search(const Value& value, SearchSettings& search) {
  const MapReader map = value.map("search", {"scatter", "global", "local", "held_back", "seed"});
  const auto count = [&](const char* key, int& field, int low) {
    if (const auto number = map.find(key)) field = static_cast<int>(number->integer(low, 1'000'000));
  };
  count("scatter", search.scatter, 0);
  count("global", search.global, 0);
  count("local", search.local, 0);
  count("held_back", search.held_back, 0);
  if (search.held_back == 1) map.require("held_back").fail("0, or 2 and more: each so many-th recording");
  if (const auto seed = map.find("seed")) search.seed = static_cast<std::uint64_t>(seed->integer(0, 1LL << 53));
}

TaskProgram read_program(const Value& value, const std::filesystem::path& path) {
  const MapReader map =
      value.map("program", {"file", "sequence", "corrections", "cup", "motion", "controller", "tempo", "robot"});
  TaskProgram program;
  program.file = beside(map.require("file"), path);
  program.sequence = map.require("sequence").name();
  if (const auto layer = map.find("corrections")) program.corrections = layer->name();
  if (const auto cup = map.find("cup")) program.with_phases = cup->choice({"holding", "phases"}) == 1;
  if (const auto motion = map.find("motion"))
    program.motion = static_cast<TaskMotion>(motion->choice({"auto", "program", "recorded"}));
  if (const auto word = map.find("controller")) {
    constexpr const char* kWords[] = {"lagged", "exact", "fast"};
    program.controller = kWords[word->choice({"lagged", "exact", "fast"})];
  }
  if (const auto tempo = map.find("tempo")) {
    if (program.controller && *program.controller != "fast") tempo->fail("controller: fast, or none");
    program.tempo = tempo->number_within(0.1, 1.0, "a fraction of the speeds");
  }
  if (const auto robot = map.find("robot")) program.robot = robot->name();
  return program;
}

void read_noise(const Value& value, SceneTask& task) {
  const MapReader map = value.map("noise", {"position", "rotation_deg"});
  if (const auto number = map.find("position")) task.position_noise = number->number(Range::Positive);
  if (const auto number = map.find("rotation_deg")) task.rotation_noise = number->radians_from_degrees(Range::Positive);
}

void read_error(const MapReader& map, SceneTask& task) {
  if (const auto flag = map.find("optimize_position")) task.use_position = flag->boolean();
  if (const auto flag = map.find("optimize_rotation")) task.use_rotation = flag->boolean();
  if (!task.use_position && !task.use_rotation)
    map.require("optimize_rotation").fail("true, or optimize_position true: something to fit");
  if (const auto value = map.find("noise")) read_noise(*value, task);
  task.rotation_position_ratio = task.position_noise / task.rotation_noise;
  if (const auto ratio = map.find("rotation_position_ratio"))
    task.rotation_position_ratio = ratio->number(Range::Positive);
  if (const auto flag = map.find("only_final_state")) task.only_final_state = flag->boolean();
  if (const auto loss = map.find("loss")) task.loss = static_cast<TaskLoss>(loss->choice({"squares", "distance"}));
  if (const auto right = map.find("right_within_deg")) task.right_within = right->radians_from_degrees(Range::Positive);
}

void read_recordings(const MapReader& map, SceneTask& task) {
  if (const auto list = map.find("recordings"))
    for (const Value& file : list->list()) task.recordings.push_back(beside(file, task.path));
  if (const auto value = map.find("input_columns")) {
    const MapReader columns = value->map("input_columns", {"recording", "time"});
    if (const auto name = columns.find("recording")) task.recording_column = name->name();
    if (const auto name = columns.find("time")) task.time_column = name->name();
  }
  task.tracked = read_objects(map, "tracked_objects");
  if (task.tracked.empty()) map.require("tracked_objects").fail("at least one body");
  task.kinematic = read_objects(map, "kinematic_bodies");
}

SceneTask read(const Value& root, std::string_view text, const std::filesystem::path& path) {
  SceneTask task;
  task.path = path;
  task.text = std::string(text);
  const MapReader map = root.map("task", {"scenario",
                                          "program",
                                          "recordings",
                                          "input_columns",
                                          "tracked_objects",
                                          "kinematic_bodies",
                                          "optimize_position",
                                          "optimize_rotation",
                                          "rotation_position_ratio",
                                          "only_final_state",
                                          "time_step",
                                          "simulation_time",
                                          "loss",
                                          "noise",
                                          "right_within_deg",
                                          "start",
                                          "own",
                                          "clock_rate",
                                          "search",
                                          "parameters"});
  task.scenario = beside(map.require("scenario"), path);
  if (const auto value = map.find("program")) task.program = read_program(*value, path);
  read_error(map, task);
  read_recordings(map, task);
  if (const auto value = map.find("time_step")) task.time_step = value->number_within(1e-6, 0.1, "a time step in s");
  if (const auto value = map.find("simulation_time")) task.simulation_time = value->number(Range::Positive);
  if (task.program) task.start.from = StartFrom::Scenario;
  if (const auto value = map.find("start")) read_start(*value, task.start);
  if (task.program && task.start.from != StartFrom::Scenario)
    map.require("start").fail("from: scenario, as a program's boxes come to the aligner");
  if (const auto value = map.find("own")) internal::read_fields(*value, "own", task.own);
  if (const auto value = map.find("clock_rate"))
    task.clock_rate = value->number_within(0.0, 0.1, "a share, 1e-4 = 100 ppm");
  if (const auto value = map.find("search")) read_search(*value, task.search);
  read_parameters(map.require("parameters"), task);
  return task;
}

}  // namespace

SceneTask load_scene_task(const std::filesystem::path& path) {
  return parse_scene_task(read_file(path, "a task of scene identification (YAML)", kLargestYaml), path);
}

SceneTask parse_scene_task(std::string_view text, const std::filesystem::path& path) {
  check_yaml(text, path.string());
  internal::Document document{path.string(), {}};
  try {
    return read(Value(YAML::Load(std::string(text)), "", document, 1), text, path);
  } catch (const YAML::Exception& error) {
    throw InputError(document.name + ":" + std::to_string(error.mark.line + 1), "", error.msg,
                     "YAML that can be parsed");
  }
}

std::string text_with_values(const SceneTask& task, const std::vector<double>& values,
                             const std::filesystem::path& folder) {
  YAML::Node root = YAML::Load(task.text);
  for (std::size_t i = 0; i < task.parameters.size(); ++i) {
    YAML::Node entry = root["parameters"][i];
    entry["value"] = internal::to_text(values[i]);
  }
  const auto from_folder = [&](const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::path relative = std::filesystem::relative(file, folder.empty() ? "." : folder, error);
    return (error || relative.empty() ? file : relative).string();
  };
  root["scenario"] = from_folder(task.scenario);
  if (task.program) root["program"]["file"] = from_folder(task.program->file);
  for (std::size_t i = 0; i < task.recordings.size(); ++i) root["recordings"][i] = from_folder(task.recordings[i]);
  return internal::text_of(root);
}

}  // namespace snug::model
