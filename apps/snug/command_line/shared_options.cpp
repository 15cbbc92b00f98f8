// Options that several verbs have: one declaration of each, with one text.
#include "apps/snug/command_line/shared_options.hpp"

#include "apps/snug/command_line/outputs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/model/spin.hpp"
#include "snug/motion/program_tracking.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/robot/urdf_warnings.hpp"

namespace snug::app {

void add_scenario(const Verb& verb, std::string& scenario) {
  verb.option("scenario", scenario, "SCENARIO.yaml",
              "scenario file, or name of one that comes with snug (drop, box-demonstrator)")
      .required();
}

void add_robot_scenario(const Verb& verb, std::string& scenario) {
  verb.option("scenario", scenario, "SCENARIO.yaml", "scenario file with a robot, or name of one that comes with snug")
      .required();
}

void add_threads(const Verb& verb, std::optional<int>& threads) {
  verb.option("--threads", threads, "N", "threads; they do not change the result (default: all)",
              whole(1, kMostThreads));
}

void add_json(const Verb& verb, bool& json) { verb.flag("--json", json, "print the result as JSON"); }

void add_corrections(const Verb& verb, std::string& corrections) {
  verb.option("--corrections", corrections, "LAYER",
              "site corrections: a layer of the scenario such as seq1 or seq2-5, or none");
}

std::string layer_of(const std::string& corrections) { return corrections == "none" ? "" : corrections; }

std::array<OptionRow, 2> add_client(const Verb& verb, std::optional<std::string>& keys, double& patience,
                                    const char* timeout) {
  return {verb.option("--keys", keys, "DIR",
                      "keys with which this program and the server identify each other (`snug keys`): a folder, or a "
                      "file NAME.key_secret in it"),
          verb.option(timeout, patience, "SECONDS", "how long to wait for an answer", within(0.01, 1e5))};
}

void add_physics(const Verb& verb, PhysicsWords& physics) {
  verb.option("--dt", physics.dt, "SECONDS", "time step (default: the scenario's)", within(1e-6, 0.1));
  verb.option("--cup", physics.cup, "MODEL",
              "phases: pressure builds up and decays, and holds can fail; holding: the cup attaches and releases at "
              "once (default: phases; with --corrections the cup for which they were made)",
              one_of({"holding", "phases"}));
  verb.option("--seed", physics.seed, "N", "seed of all random draws (default: the scenario's)", whole(0));
  verb.option("--record-period", physics.record_period, "SECONDS",
              "time between frames: whole steps, or ticks of a program (default: the scenario's, or 0.008)",
              positive());
}

void apply(const PhysicsWords& physics, model::Scenario& scenario) {
  if (physics.dt) scenario.time_step = *physics.dt;
  model::check_spins(scenario);
  if (physics.seed) scenario.seed = *physics.seed;
  if (physics.record_period) scenario.record_period = *physics.record_period;
}

void add_motion_words(const Verb& verb, MotionWords& words) {
  verb.option("--controller", words.controller, "KIND",
              "lagged: the demonstrator's timing and lag; exact: no lag; fast: bounded jerk, blended motions, sensors "
              "end pushes and waits, as in pack (default: as the program was packed)",
              one_of({"lagged", "exact", "fast"}));
  verb.option("--tempo", words.tempo, "FRACTION",
              "fraction of the full speed, with fast (default: that of the program, or 1)", within(0.5, 1.0));
}

void refuse_tempo_without_fast(const std::optional<double>& tempo, const std::string& controller) {
  if (!tempo || controller == "fast") return;
  throw InputError("command line", "--tempo", "with --controller " + controller, "--controller fast, or none");
}

void choose_motion(const MotionWords& words, std::string_view text, std::string_view name,
                   cell::SimulationOptions& options) {
  if (words.controller) refuse_tempo_without_fast(words.tempo, *words.controller);
  options.tracking =
      motion::choose_tracking(words.controller, words.tempo, motion::find_tracking(text, name), "command line");
}

void print_robot_warnings(const model::Scenario& scenario) {
  if (!scenario.robot) return;
  const std::filesystem::path urdf = robot::urdf_path(scenario);
  print_warnings(robot::find_assumptions(urdf, scenario.robot->tool_frame));
  print_warnings(robot::find_unknown_efforts(urdf));
  print_warnings(robot::find_weak_joints(scenario));
}

}  // namespace snug::app
