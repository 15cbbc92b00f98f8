// pack_ur: packs through a controller of Universal Robots, or makes each motion with it before a simulated plant does.
#include <fmt/format.h>

#include <cmath>
#include <cstdio>

#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/pack/pack.hpp"
#include "snug/core/input_error.hpp"
#include "snug/perception/camera_perception.hpp"
#include "snug/remote_plant/box_observer.hpp"
#include "snug/remote_ur/dry_run.hpp"
#include "snug/remote_ur/remote_ur.hpp"
#include "snug/remote_ur/rtde_link.hpp"
#include "snug/study/watched_boxes.hpp"

namespace snug::app {
namespace {

constexpr double kAtStart = 0.05;  ///< rad: a dry run begins where the simulated plant does

remote_ur::Endpoint ur_endpoint_of(const PackOptions& options) {
  remote_ur::Endpoint endpoint = *remote_ur::endpoint_of_ur(options.plant);
  endpoint.patience = options.client.patience;
  if (!remote_ur::is_loopback_host(endpoint.host) && !options.may_move) {
    throw InputError("command line", "--plant", "'" + options.plant + "', which is not on this machine",
                     "--yes-this-moves-a-robot, when its cell is free of people and its emergency stop is at hand");
  }
  return endpoint;
}

/// Everything is compared before anything moves.
std::unique_ptr<remote_ur::RobotLink> connect_robot(const PackOptions& options, const model::Scenario& scenario) {
  const remote_ur::Endpoint endpoint = ur_endpoint_of(options);
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "nothing", "a scenario with a robot");
  remote_ur::refuse_what_differs(remote_ur::compare_robot(remote_ur::read_robot(endpoint), scenario), options.plant);
  return std::make_unique<remote_ur::RtdeLink>(endpoint, options.is_in_lockstep);
}

remote_ur::RemoteUrOptions robot_options(const PackOptions& options, const session::SessionOptions& session) {
  remote_ur::RemoteUrOptions robot;
  robot.motions = session.simulation;
  robot.part_patience = options.part_patience;
  robot.is_in_time = !options.is_in_lockstep;
  robot.is_dry = options.is_dry;
  robot.is_interrupted = is_interrupted;
  return robot;
}

void tell_late_periods(remote_ur::RemoteUr& robot) {
  if (const int late = robot.late_periods(); late > 0)
    std::fprintf(stderr, "snug: %d periods of the robot without a new target\n", late);
}

/// A box in the cup is one that a session before this one held; where it hangs somebody has to see.
void refuse_held_box(const PackOptions& options, const model::Scenario& scenario, const plant::Feedback& robot) {
  const double held = scenario.motion_guards.needed_vacuum * scenario.cup.vacuum.pressure_gauge_hold;
  if (!robot.io.vacuum || robot.pressure_gauge >= held || (options.resume && options.observe)) return;
  throw InputError("command line", "--plant", "'" + options.plant + "', whose cup holds a box",
                   options.resume ? "--observe ADDRESS, or the box at the aligner: take it out of the cup by hand"
                                  : "an empty cup: take the box out of it, or go on by --resume LOG --observe ADDRESS");
}

study::Trial run_dry(const PackOptions& options, const model::Scenario& scenario,
                     const session::SessionOptions& session, const simulated_plant::SimulatedPlantOptions& simulated,
                     const study::TrialProgress& progress, const study::TrialFiles& files) {
  simulated_plant::SimulatedPlant plant(scenario, options.sequence, simulated);
  remote_ur::RemoteUrOptions with_robot = robot_options(options, session);
  with_robot.link = connect_robot(options, scenario);
  with_robot.perception = perception::make_perception(perception::Kind::DeadReckoning, simulated.seed);
  remote_ur::RemoteUr robot(scenario, options.sequence, std::move(with_robot));
  const std::vector<double> is = robot.read().q, wanted = plant.read().q;
  for (std::size_t j = 0; j < wanted.size(); ++j) {
    if (std::abs(is[j] - wanted[j]) <= kAtStart) continue;
    throw InputError("command line", "--dry-run", fmt::format("joint {} at {:.3f} rad", j, is[j]),
                     fmt::format("the robot at the scenario's start: movej([{:.4f}])", fmt::join(wanted, ", ")));
  }
  remote_ur::DryRun both(plant, robot);
  study::Trial trial =
      study::run_trial(scenario, options.sequence, session, both, study::truth_of(plant), progress, files);
  trial.plant_seed = simulated.seed;
  trial.plant = simulated;
  tell_late_periods(robot);
  (void)robot.finish();
  return trial;
}

}  // namespace

study::Trial run_ur_trial(const PackOptions& options, const model::Scenario& scenario,
                          const session::SessionOptions& session,
                          const simulated_plant::SimulatedPlantOptions& simulated, const study::TrialProgress& progress,
                          const study::TrialFiles& files) {
  expect_options_of_a_served_plant(options, session);
  (void)ur_endpoint_of(options);
  if (options.is_dry) return run_dry(options, scenario, session, simulated, progress, files);
  const perception::Kind kind = perception::kind_of(options.perception);
  const bool needs_truth = kind != perception::Kind::DeadReckoning && kind != perception::Kind::Frames;
  if (needs_truth && !options.observe) {
    throw InputError("command line", "--perception", "'" + options.perception + "' without --observe",
                     "--observe ADDRESS, where boxes are told, or --perception frames or dead-reckoning");
  }
  std::optional<remote_plant::BoxObserver> observer;
  if (options.observe) observer.emplace(scenario, options.sequence, *options.observe, options.client.patience);
  remote_ur::RemoteUrOptions with_robot = robot_options(options, session);
  with_robot.link = connect_robot(options, scenario);
  with_robot.perception =
      perception::make_perception(kind, options.plant_seed, scenario, make_frames(options, scenario));
  session::SessionOptions with_resume = session;
  if (session.resume) {
    with_resume.takes_over = true;
    with_robot.brought = session.resume->item_count();
    for (const model::ItemIndex item : session.resume->to_do)
      with_robot.to_do.push_back(session.resume->started().items[item.slot()].value);
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
  remote_ur::RemoteUr robot(scenario, options.sequence, std::move(with_robot));
  refuse_held_box(options, scenario, robot.read());
  study::BoxSource source;
  source.boxes = [&]() -> std::vector<std::optional<perception::SceneBox>> {
    if (!observer) return robot.perceived();
    (void)observer->look();  // what was seen before stays
    return observer->boxes();
  };
  source.size_of = [&](std::size_t item) { return observer ? observer->size_of(item) : robot.size_of(item); };
  source.was_brought = [&](std::size_t item) { return robot.was_brought(item); };
  const study::Witness witness = study::watch_boxes(scenario, options.sequence, std::move(source));
  study::Trial trial = study::run_trial(scenario, options.sequence, with_resume, robot, witness, progress, files);
  trial.is_elsewhere = true;
  trial.plant.perception = kind;
  trial.plant.simulation = session.simulation;
  tell_late_periods(robot);
  std::string trouble = robot.finish();
  if (!trial.session.failure && !trouble.empty()) {
    trial.session.failure = {session::SessionFailureKind::PlantLost, std::move(trouble)};
  }
  return trial;
}

}  // namespace snug::app
