// pack: packs a plant with a sequence, item by item, and says how that went.
#include "apps/snug/pack/pack.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/version.hpp"
#include "snug/commands/stop_signal.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/packing/python_agent.hpp"
#include "snug/packing/representatives.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/runs/result_json.hpp"
#include "snug/serve/live_file.hpp"
#include "snug/study/monte_carlo.hpp"
#include "snug/study/trial_report.hpp"

namespace snug::app {
namespace {

/// The robot that moves the tool: what was asked for, or the scenario's, where its file is there.
std::string choose_robot(const PackOptions& options, const model::Scenario& scenario) {
  if (options.robot) return *options.robot == "none" ? std::string() : *options.robot;
  std::error_code error;
  const bool is_there = scenario.robot && std::filesystem::exists(robot::urdf_path(scenario), error);
  return is_there ? scenario.robot->name : std::string();
}

/// None: the session's own, the boxes of the order.
std::optional<packing::FutureModel> choose_future(const std::string& which, const model::Scenario& scenario) {
  if (which == "catalogue") return packing::make_catalogue_future(scenario);
  if (which == "none") return packing::FutureModel{};
  return std::nullopt;
}

void tell_line(const std::string& line) { std::fprintf(stderr, "snug: %s\n", line.c_str()); }

/// What who operates says, as it comes.
session::OperatorSource read_operator(const PackOptions& options, const model::Scenario& scenario) {
  std::vector<std::string> items;
  if (const model::Sequence* sequence = model::find_sequence(scenario, options.sequence)) {
    for (const model::Item& item : sequence->items) items.push_back(item.parcel);
  }
  const auto file = std::make_shared<session::OperatorFile>(*options.operator_file, std::move(items), tell_line);
  return [file] { return file->read(); };
}

/// Throws InputError for options that only a simulated plant has.
void expect_options_of_a_served_plant(const PackOptions& options, const session::SessionOptions& session) {
  const auto refuse = [](const char* option, const std::string& got, const char* expected) {
    throw InputError("command line", option, "'" + got + "'", expected);
  };
  if (!options.plant_set.empty()) {
    refuse("--plant-set", options.plant_set.front(), "nothing: a served cell is what `snug serve --set` says");
  }
  if (!options.fault.empty()) refuse("--fault", options.fault, "no faults: they are made in a simulated plant alone");
  if (session.simulation.robot.empty()) refuse("--robot", "none", "the scenario's robot: a served plant has one");
}

/// The files that were asked for, reserved before the work begins.
struct PackFiles {
  std::optional<OutputFile> program, plan, record;
  std::optional<session::LogFile> log;
  std::optional<serve::LiveFile> live;

  PackFiles(const PackOptions& options, const model::Scenario& scenario) {
    NamedFiles outputs;
    add_file(outputs, "--program", options.program);
    add_file(outputs, "--plan", options.plan);
    add_file(outputs, "-o", options.record);
    add_file(outputs, "--log", options.log);
    add_file(outputs, "--live", options.live);
    NamedFiles inputs = files_of(options.scenario, options.changes, scenario);
    add_file(inputs, "--resume", options.resume);
    if (options.operator_file != "-") add_file(inputs, "--operator", options.operator_file);
    expect_distinct(inputs, outputs);
    program = reserve(options.program);
    plan = reserve(options.plan);
    record = reserve_recording(options.record);
    if (options.log) log.emplace(*options.log);
    if (options.live) live.emplace(*options.live, std::filesystem::path(*options.live).stem().string());
    if (options.save_beliefs) make_folder("--save-belief", *options.save_beliefs);
  }
  /// The placements so far: at their path where no earlier file is, else beside it until they are complete.
  void update_plan(const std::string& text) {
    plan->replace(text);
    if (!plan->is_published() && !plan->replaces_file()) plan->publish();
  }
  void finish_plan(const std::string& text) {
    plan->replace(text);
    if (!plan->is_published()) plan->publish();
  }
};

/// The finished program again and again, where that was asked for.
study::MonteCarloResult repeat_program(const PackOptions& options, const model::Scenario& scenario,
                                       const session::SessionOptions& session, const session::SessionResult& result) {
  if (!options.monte_carlo) return {};
  study::MonteCarloOptions monte_carlo;
  monte_carlo.count = *options.monte_carlo;
  monte_carlo.seed = session.decision.seed;
  monte_carlo.threads = session.threads;
  monte_carlo.simulation = session.simulation;
  return study::repeat(scenario, options.sequence, result.program, result.plan, monte_carlo);
}

study::Trial run_elsewhere(const PackOptions& options, const model::Scenario& scenario,
                           const session::SessionOptions& session,
                           const simulated_plant::SimulatedPlantOptions& simulated,
                           const study::TrialProgress& progress, const study::TrialFiles& files) {
  expect_options_of_a_served_plant(options, session);
  const remote_runs::RemoteRun run{scenario, options.sequence, session, progress, files, tell_line};
  return options.plant.is_robot() ? remote_runs::run_ur_trial(options.plant, run, simulated)
                                  : remote_runs::run_served_trial(options.plant, run);
}

}  // namespace

packing::Ask choose_ask(const std::string& agent, double patience) {
  if (!packing::is_python_agent(agent)) return {};
  return packing::start_python_agent(agent, agent_script(), {patience, is_interrupted});
}

session::SessionOptions make_session_options(const PackOptions& options, const model::Scenario& scenario) {
  session::SessionOptions session = options.session;
  session.decision.seed = options.seed.value_or(scenario.seed);
  session.future = choose_future(options.future, scenario);
  session.threads = session.decision.threads = options.threads.value_or(core_count());
  session.simulation.robot = choose_robot(options, scenario);
  refuse_tempo_without_fast(options.tempo, options.controller);
  session.simulation.tracking =
      motion::choose_tracking(options.controller, options.tempo, motion::FastTracking{}, "command line");
  session.is_interrupted = is_interrupted;
  if (options.robot && *options.robot != "none") print_robot_warnings(scenario);
  return session;
}

simulated_plant::SimulatedPlantOptions make_plant_options(const PackOptions& options,
                                                          const session::SessionOptions& session) {
  simulated_plant::SimulatedPlantOptions plant;
  plant.seed = options.plant.seed;
  plant.perception = perception::kind_of(options.plant.perception);
  plant.faults = simulated_plant::parse_faults(options.fault);
  for (const std::string& words : options.plant_set) plant.set.push_back(model::parse_key_value(words, "--plant-set"));
  plant.simulation = session.simulation;
  return plant;
}

study::TrialProgress make_progress_line(const std::string& label) {
  if (isatty(STDERR_FILENO) == 0) return {};
  return [label](const study::Trial& so_far, int item, int items) {
    const std::string line = fmt::format("{}: item {} of {}, {} packed, {:.1f} %", label, item, items,
                                         so_far.executed_boxes, so_far.executed_percent);
    std::fprintf(stderr, "\r%-78s%s", line.c_str(), item == items ? "\r\033[K" : "");
    std::fflush(stderr);
  };
}

int run_pack(const PackOptions& options) {
  model::Scenario scenario = load_changed(options.scenario, options.changes);
  if (options.random_seed) {
    scenario.sequences.push_back(packing::draw_order(scenario, options.sequence, *options.random_seed));
  }
  session::SessionOptions session = make_session_options(options, scenario);
  session.ask = choose_ask(session.agent, options.agent_patience);
  simulated_plant::SimulatedPlantOptions plant = make_plant_options(options, session);
  if (options.resume) {
    session.resume = session::find_resume_point(session::load_log(*options.resume), *options.resume);
    plant.taken_up = study::take_up(*session.resume);
  }
  if (options.operator_file) session.operator_orders = read_operator(options, scenario);
  const bool is_served = options.plant.is_served();
  remote_runs::refuse_options_of_a_robot(options.plant);
  if (!is_served) (void)remote_runs::make_frames(options.plant, scenario, is_interrupted);  // says that it cannot be
  PackFiles files(options, scenario);
  if (files.log) session.log = [&files](const session::SessionEvent& one) { files.log->write(one); };
  if (options.save_beliefs) session.save_beliefs = *options.save_beliefs;
  catch_interrupts();
  const study::TrialProgress line = make_progress_line("sequence " + options.sequence);
  const bool is_known = model::find_sequence(scenario, options.sequence) != nullptr;  // else the trial says so
  if (!options.json && is_known) {
    print_now(
        study::format_pack_head(options.sequence, session, plant, is_served ? options.plant.address : std::string()));
  }
  const auto progress = [&](const study::Trial& so_far, int item, int items) {
    if (files.plan) files.update_plan(study::format_plan(so_far.session, false));
    if (!options.json) print_now(study::format_item(so_far.session.items.back(), so_far.items.back()));
    if (options.json && line) line(so_far, item, items);
  };
  study::TrialFiles written;
  const bool is_elsewhere = is_served && !options.plant.is_dry;
  if (files.record)
    written.recording = study::recording_of(plant, session.agent, version_text(), *files.record,
                                            is_elsewhere ? options.plant.address : std::string());
  if (files.live && written.recording) written.recording->observer = &*files.live;
  written.describe = [](const runs::RunResult& one) { return runs::format_result(one); };
  if (files.program) written.program = &*files.program;
  const study::Trial trial = is_served
                                 ? run_elsewhere(options, scenario, session, plant, progress, written)
                                 : study::run_trial(scenario, options.sequence, session, plant, progress, written);
  if (files.live) files.live->finish();
  const session::SessionResult& result = trial.session;
  const study::MonteCarloResult repeated = repeat_program(options, scenario, session, result);
  if (files.plan) files.finish_plan(study::format_plan(result, true));
  print(options.json ? study::format_json(trial, repeated) : study::format_summary(trial, repeated));
  const std::string failure = study::find_failure(result, repeated, options.program || options.record);
  if (result.stop_reason == session::StopReason::Interrupted) {
    std::fprintf(stderr, "snug: interrupted after %zu items\n", result.items.size());
  }
  if (!failure.empty()) std::fprintf(stderr, "snug: failed: %s\n", failure.c_str());
  return failure.empty() && result.stop_reason != session::StopReason::Interrupted ? kSuccess : kRunFailed;
}

}  // namespace snug::app
