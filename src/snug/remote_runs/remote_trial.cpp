// remote_trial: a session in a plant of another program, or through a robot: opened by its address, scored by who looks
// on.
#include "snug/remote_runs/remote_trial.hpp"

#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "snug/core/input_error.hpp"
#include "snug/frames/frame_source.hpp"
#include "snug/perception/camera_perception.hpp"
#include "snug/remote_plant/box_observer.hpp"
#include "snug/remote_plant/remote_plant.hpp"
#include "snug/remote_ur/dry_run.hpp"
#include "snug/remote_ur/remote_ur.hpp"
#include "snug/remote_ur/rtde_link.hpp"
#include "snug/study/watched_boxes.hpp"

namespace snug::remote_runs {
namespace {

constexpr double kAtStart = 0.05;  ///< rad: a dry run begins where the simulated plant does

remote_ur::Endpoint ur_endpoint_of(const PlantChoice& plant) {
  remote_ur::Endpoint endpoint = *remote_ur::endpoint_of_ur(plant.address);
  endpoint.patience = plant.patience;
  if (!remote_ur::is_loopback_host(endpoint.host) && !plant.may_move) {
    throw InputError("command line", "--plant", "'" + plant.address + "', which is not on this machine",
                     "--yes-this-moves-a-robot, if nobody is in its cell and its emergency stop is within reach");
  }
  return endpoint;
}

/// Everything is compared before anything moves.
std::unique_ptr<remote_ur::RobotLink> connect_robot(const PlantChoice& plant, const model::Scenario& scenario) {
  const remote_ur::Endpoint endpoint = ur_endpoint_of(plant);
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "nothing", "a scenario with a robot");
  remote_ur::refuse_what_differs(remote_ur::compare_robot(remote_ur::read_robot(endpoint), scenario), plant.address);
  return std::make_unique<remote_ur::RtdeLink>(endpoint, plant.is_in_lockstep);
}

remote_ur::RemoteUrOptions robot_options(const PlantChoice& plant, const session::SessionOptions& session) {
  remote_ur::RemoteUrOptions robot;
  robot.motions = session.simulation;
  robot.part_patience = plant.part_patience;
  robot.is_in_time = !plant.is_in_lockstep;
  robot.is_dry = plant.is_dry;
  robot.is_interrupted = session.is_interrupted;
  return robot;
}

void tell_late_periods(remote_ur::RemoteUr& robot, const RemoteRun& run) {
  if (const int late = robot.late_periods(); late > 0 && run.tell)
    run.tell(fmt::format("{} periods of the robot without a new target", late));
}

/// A box in the cup is one that a session before this one held; where it hangs somebody has to see.
void refuse_held_box(const PlantChoice& plant, const RemoteRun& run, const plant::Feedback& robot) {
  const double held = run.scenario.motion_guards.needed_vacuum * run.scenario.cup.vacuum.pressure_gauge_hold;
  const bool is_resumed = run.session.resume.has_value();
  if (!robot.io.vacuum || robot.pressure_gauge >= held || (is_resumed && plant.observe)) return;
  throw InputError("command line", "--plant", "'" + plant.address + "', whose cup holds a box",
                   is_resumed
                       ? "--observe ADDRESS, or the box at the aligner: take it out of the cup by hand"
                       : "an empty cup: take the box out of it, or continue with --resume LOG --observe ADDRESS");
}

/// What is known of a trial with a plant elsewhere when it has ended.
study::Trial ended(study::Trial trial, perception::Kind kind, const RemoteRun& run, std::string trouble) {
  trial.is_elsewhere = true;
  trial.plant.perception = kind;
  trial.plant.simulation = run.session.simulation;
  if (!trial.session.failure && !trouble.empty()) {
    trial.session.failure = {session::SessionFailureKind::PlantLost, std::move(trouble)};
  }
  return trial;
}

study::Trial run_dry(const PlantChoice& choice, const RemoteRun& run,
                     const simulated_plant::SimulatedPlantOptions& simulated) {
  simulated_plant::SimulatedPlant plant(run.scenario, run.sequence, simulated);
  remote_ur::RemoteUrOptions with_robot = robot_options(choice, run.session);
  with_robot.link = connect_robot(choice, run.scenario);
  with_robot.perception = perception::make_perception(perception::Kind::DeadReckoning, simulated.seed);
  remote_ur::RemoteUr robot(run.scenario, run.sequence, std::move(with_robot));
  const std::vector<double> is = robot.read().q, wanted = plant.read().q;
  for (std::size_t j = 0; j < wanted.size(); ++j) {
    if (std::abs(is[j] - wanted[j]) <= kAtStart) continue;
    throw InputError("command line", "--dry-run", fmt::format("joint {} at {:.3f} rad", j, is[j]),
                     fmt::format("the robot at the scenario's start: movej([{:.4f}])", fmt::join(wanted, ", ")));
  }
  remote_ur::DryRun both(plant, robot);
  study::Trial trial =
      study::run_trial(run.scenario, run.sequence, run.session, both, study::truth_of(plant), run.progress, run.files);
  trial.plant_seed = simulated.seed;
  trial.plant = simulated;
  tell_late_periods(robot, run);
  (void)robot.finish();
  return trial;
}

/// Boxes as the observer tells them, where there is one.
remote_ur::RemoteUrOptions options_of(const PlantChoice& plant, const RemoteRun& run, perception::Kind kind,
                                      std::optional<remote_plant::BoxObserver>& observer) {
  remote_ur::RemoteUrOptions with_robot = robot_options(plant, run.session);
  with_robot.link = connect_robot(plant, run.scenario);
  with_robot.perception = perception::make_perception(kind, plant.seed, run.scenario,
                                                      make_frames(plant, run.scenario, run.session.is_interrupted));
  if (const auto& resume = run.session.resume) {
    with_robot.brought = resume->item_count();
    for (const model::ItemIndex item : resume->to_do)
      with_robot.to_do.push_back(resume->started().items[item.slot()].value);
  }
  if (observer) {
    with_robot.boxes = [&observer](std::vector<perception::SceneBox>& boxes) {
      std::string trouble = observer->look();
      if (!trouble.empty()) return trouble;
      for (auto& box : observer->boxes())
        if (box) boxes.push_back(std::move(*box));
      return trouble;
    };
  }
  return with_robot;
}

}  // namespace

void refuse_options_of_a_robot(const PlantChoice& plant) {
  if (plant.is_robot()) return;
  const auto refuse = [](const char* option, const std::string& got) {
    throw InputError("command line", option, got, "nothing, unless --plant ur://HOST");
  };
  if (plant.observe) refuse("--observe", "'" + *plant.observe + "'");
  if (plant.is_dry) refuse("--dry-run", "");
  if (plant.is_in_lockstep) refuse("--lockstep", "");
  if (plant.may_move) refuse("--yes-this-moves-a-robot", "");
}

camera::FrameSource make_frames(const PlantChoice& plant, const model::Scenario& scenario,
                                const std::function<bool()>& is_interrupted) {
  const bool is_asked = plant.perception == perception::name_of(perception::Kind::Frames);
  if (!is_asked) {
    if (plant.frames) {
      throw InputError("command line", "--frames", "with --perception " + plant.perception, "--perception frames");
    }
    return {};
  }
  if (!plant.frames) {
    throw InputError("command line", "--perception", "frames, without --frames",
                     "--frames with a folder, or with a command that writes a frame");
  }
  if (!plant.is_served()) {
    throw InputError("command line", "--perception", "frames, of a plant in this program",
                     "--plant with a cell that a camera can see; or --perception camera");
  }
  if (scenario.cameras.empty()) {
    throw InputError(scenario.source_name, "cameras", "none", "a camera, for --perception frames");
  }
  frames::SourceSettings settings;
  settings.from = *plant.frames;
  settings.patience = plant.frames_patience;
  settings.hints.camera = scenario.cameras.front();
  settings.hints.depth_unit = plant.frames_unit;
  if (plant.frames_camera) {
    settings.hints.camera_file = *plant.frames_camera;
    (void)camera::load_camera_file(*plant.frames_camera);  // slips are said before anything moves
  }
  settings.is_interrupted = is_interrupted;
  return frames::make_frame_source(settings);
}

study::Trial run_served_trial(const PlantChoice& choice, const RemoteRun& run) {
  const perception::Kind kind = perception::kind_of(choice.perception);
  remote_plant::RemotePlant plant(
      run.scenario, run.sequence,
      {choice.address, choice.patience, kind, choice.seed, run.session.simulation, click::find_client_keys(choice.keys),
       make_frames(choice, run.scenario, run.session.is_interrupted)});
  const study::Witness witness =
      study::watch_boxes(run.scenario, run.sequence,
                         {[&] { return plant.boxes(); }, [&](std::size_t item) { return plant.size_of(item); },
                          [&](std::size_t item) { return plant.was_brought(item); }});
  study::Trial trial =
      study::run_trial(run.scenario, run.sequence, run.session, plant, witness, run.progress, run.files);
  return ended(std::move(trial), kind, run, plant.finish());
}

study::Trial run_ur_trial(const PlantChoice& plant, const RemoteRun& asked,
                          const simulated_plant::SimulatedPlantOptions& simulated) {
  const model::Scenario scenario = remote_ur::with_speed_to_follow(asked.scenario);
  const RemoteRun run{scenario, asked.sequence, asked.session, asked.progress, asked.files, asked.tell};
  (void)ur_endpoint_of(plant);
  if (plant.is_dry) return run_dry(plant, run, simulated);
  const perception::Kind kind = perception::kind_of(plant.perception);
  const bool needs_truth = kind != perception::Kind::DeadReckoning && kind != perception::Kind::Frames;
  if (needs_truth && !plant.observe) {
    throw InputError("command line", "--perception", "'" + plant.perception + "' without --observe",
                     "--observe ADDRESS, which reports the boxes, or --perception frames or dead-reckoning");
  }
  std::optional<remote_plant::BoxObserver> observer;
  if (plant.observe) observer.emplace(run.scenario, run.sequence, *plant.observe, plant.patience);
  session::SessionOptions session = run.session;
  session.takes_over = session.takes_over || session.resume.has_value();
  remote_ur::RemoteUr robot(run.scenario, run.sequence, options_of(plant, run, kind, observer));
  refuse_held_box(plant, run, robot.read());
  study::BoxSource source;
  source.boxes = [&]() -> std::vector<std::optional<perception::SceneBox>> {
    if (!observer) return robot.perceived();
    (void)observer->look();  // what was seen before stays
    return observer->boxes();
  };
  source.size_of = [&](std::size_t item) { return observer ? observer->size_of(item) : robot.size_of(item); };
  source.was_brought = [&](std::size_t item) { return robot.was_brought(item); };
  const study::Witness witness = study::watch_boxes(run.scenario, run.sequence, std::move(source));
  study::Trial trial = study::run_trial(run.scenario, run.sequence, session, robot, witness, run.progress, run.files);
  tell_late_periods(robot, run);
  return ended(std::move(trial), kind, run, robot.finish());
}

}  // namespace snug::remote_runs
