// camera: a recording's bodies in the camera's picture, written with what is true of it.
#include "apps/snug/command_line/verbs.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/camera/camera_file.hpp"
#include "snug/camera/frame_file.hpp"
#include "snug/camera/truth_text.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/core/write_file.hpp"
#include "snug/record/reader.hpp"
#include "snug/remote_runs/watched_run.hpp"

namespace snug::app {
namespace {

namespace fs = std::filesystem;

struct CameraOptions {
  std::string recording;                ///< with `click`: a scenario
  std::string output;                   ///< .png, .ply or .h5
  std::optional<std::string> scenario;  ///< instead of the recording's own
  std::optional<std::string> camera;    ///< name; absent: the scenario's first
  std::optional<double> time;           ///< s; absent: the end
  std::optional<std::string> click;     ///< address of a served cell
  std::optional<std::string> sequence;  ///< of a served cell; absent: the first
  ScenarioChanges changes;              ///< with which it is served
  ClientWords client;
  bool without_robot = false;
  std::optional<std::uint64_t> seed;  ///< of the camera's own errors; absent: the recording's
  std::uint64_t shot = 1;
  int threads = 1;
  bool exact = false;  ///< without errors
  bool json = false;
};

/// What a camera has before it, and what it is.
struct CameraView {
  model::Scenario scenario;
  camera::Scene scene;
  double time = 0.0;       ///< s
  std::uint64_t seed = 0;  ///< of the cell
};

/// "frame" and "-truth.json" to the file beside the output.
std::string beside(const fs::path& output, const std::string& ending) {
  return (output.parent_path() / (output.stem().string() + ending)).string();
}

std::vector<std::string> side_files(const fs::path& output) {
  if (output.extension() == ".png")
    return {beside(output, "-intensity.png"), beside(output, "-labels.png"), beside(output, "-truth.json")};
  if (output.extension() == ".ply") return {beside(output, "-truth.json")};
  return {};
}

/// Of a cell that is served over CLICK: boxes where and as large as its sensors say, the rest as in the scenario.
CameraView look_at_served(const CameraOptions& options) {
  CameraView view;
  view.scenario = load_changed(options.recording, options.changes);
  if (view.scenario.sequences.empty()) throw InputError(view.scenario.source_name, "sequences", "", "boxes");
  remote_plant::WatchedCell cell(view.scenario, options.sequence.value_or(view.scenario.sequences.front().name),
                                 *options.click, options.client.patience, click::find_client_keys(options.client.keys));
  const std::string trouble = cell.look();
  if (!trouble.empty()) {
    throw InputError("command line", "--click", "'" + *options.click + "'",
                     "a served cell: " + printable(trouble, kLongestMessage));
  }
  view.scene = options.without_robot ? remote_runs::scene_without_robot(cell)
                                     : remote_runs::watched_scene(cell, options.recording);
  view.time = cell.time();
  view.seed = view.scenario.seed;
  return view;
}

CameraView look_at_recording(const CameraOptions& options) {
  record::RecordingReader reader(options.recording);
  expect_recorded(reader, options.recording, options.time);
  CameraView view;
  view.scenario = options.scenario
                      ? model::load_scenario(find_scenario(*options.scenario))
                      : model::parse_scenario(reader.header().scenario_text, "scenario of " + options.recording);
  record::Frame instant;
  reader.read_frame(reader.find_frame(options.time.value_or(reader.times().back())), instant);
  view.scene = camera::make_scene(reader.header(), instant, options.recording);
  view.time = instant.time;
  view.seed = reader.header().seed;
  if (options.changes.any()) {
    throw InputError("command line", "--items, --container, --pallet, --set", "of a recording",
                     "--click: of a cell that is served so");
  }
  if (options.without_robot) {
    throw InputError("command line", "--without-robot", "of a recording", "--click: of a cell that is served");
  }
  return view;
}

int run_camera(const CameraOptions& options) {
  const fs::path output = options.output;
  const std::string ending = output.extension().string();
  if (ending != ".png" && ending != ".ply" && ending != ".h5")
    throw InputError("command line", "-o", options.output, "a name that ends in .png, .ply or .h5");
  NamedFiles inputs = {{options.click ? "the scenario" : "the recording", options.recording}},
             outputs = {{"-o", options.output}};
  add_file(inputs, "--scenario", options.scenario);
  const std::vector<std::string> sides = side_files(output);
  for (const std::string& path : sides) outputs.push_back({"beside -o", path});
  expect_distinct(inputs, outputs);

  const CameraView view = options.click ? look_at_served(options) : look_at_recording(options);
  model::CameraParams params =
      camera::choose_camera(view.scenario, options.camera, options.scenario.value_or(options.recording));
  camera::CameraDraw draw;
  if (options.exact) {
    params.errors = model::make_camera("ideal").errors;
    params.p_CL = Vector3::Zero();
  } else {
    draw = camera::draw_camera(params, options.seed.value_or(view.seed));
  }
  OutputFile file(output);
  std::vector<OutputFile> side;
  for (const std::string& path : sides) side.emplace_back(path);

  const camera::RenderedFrame shot = camera::render(view.scene, params, draw, options.shot, options.threads);
  if (ending == ".h5") {
    camera::write_h5(file, shot.frame, &shot.truth);
    file.publish();
  } else if (ending == ".ply") {
    write_file(std::move(file), camera::format_ply(shot.frame, &shot.truth));
    write_file(std::move(side[0]), camera::format_truth(shot, view.time, 1));
  } else {
    write_file(std::move(file), camera::format_png(shot.frame));
    write_file(std::move(side[0]), camera::format_intensity_png(shot.frame));
    write_file(std::move(side[1]), camera::format_label_png(shot.truth));
    write_file(std::move(side[2]), camera::format_truth(shot, view.time, 1));
  }
  if (options.json)
    print(camera::format_truth(shot, view.time, 2));
  else
    print(fmt::format("{}: {} points of {} pixels at {:.3f} s, {}\n", options.output, camera::count_points(shot.frame),
                      params.width * params.height, view.time, params.name));
  return kSuccess;
}

constexpr const char* kCameraExamples = R"(What is written goes by the ending of FILE:
  .png  depth, 16-bit grey in steps of 0.1 mm; beside it FILE-intensity.png, FILE-labels.png and FILE-truth.json
  .ply  points in the world with intensity, row, column and label; beside it FILE-truth.json
  .h5   depth, intensity, and the truth: depth, labels, poses
The truth cannot be measured: poses and labels of the bodies, and the real pose of the camera. docs/camera.md has the errors.
Examples:
  snug camera run.h5 --time 20 -o frame.png
  snug camera run.h5 --time 20 --camera tote --seed 3 --shot 2 -o frame.h5
  snug camera run.h5 --scenario scenarios/box-demonstrator.yaml -o frame.ply   # with the cameras of another scenario
With --click ADDRESS, and a scenario instead of a recording, camera renders a cell that `snug serve` serves now: the camera of a simulated cell
as a separate program (docs/camera-frames.md).)";

}  // namespace

void add_camera(CLI::App& app, Action& action) {
  const Verb verb(app, action, "camera", "render what a depth camera sees, from a recording or a served cell",
                  kCameraExamples);
  CameraOptions& options = verb.runs(run_camera);
  verb.option("recording", options.recording, "FILE.h5|SCENARIO.yaml",
              "recording of a run; with --click the scenario that is served")
      .required();
  verb.option("-o,--output", options.output, "FILE", "the frame to write: .png, .ply or .h5").required();
  const OptionRow time = verb.option("--time", options.time, "SECONDS", "instant (default: the end)", finite());
  const OptionRow click =
      verb.option("--click", options.click, "ADDRESS", "look at the cell that is served at this address")
          .excludes(time);
  verb.option("--sequence", options.sequence, "NAME", "sequence of a served cell (default: the first)").needs(click);
  add_scenario_changes(verb, options.changes);
  for (const OptionRow& row : add_client(verb, options.client, "--timeout")) row.needs(click);
  verb.flag("--without-robot", options.without_robot, "with a served cell: hide the robot").needs(click);
  verb.option("--camera", options.camera, "NAME", "name in the scenario (default: the first)");
  verb.option("--scenario", options.scenario, "FILE.yaml", "scenario with the camera, if the recording has none")
      .excludes(click);
  verb.option("--seed", options.seed, "N", "seed of the camera's constant errors (default: the recording's)", whole(0));
  verb.option("--shot", options.shot, "N", "number of the frame, which draws its noise", whole(0));
  verb.option("--threads", options.threads, "N", "threads; they do not change the frame", whole(1, kMostThreads));
  verb.flag("--exact", options.exact, "without errors");
  add_json(verb, options.json);
}

}  // namespace snug::app
