// shake: whether a load survives the ride.
#include "apps/snug/command_line/verbs.hpp"

#include <filesystem>
#include <numbers>
#include <optional>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/write_file.hpp"
#include "snug/runs/shake_report.hpp"

namespace snug::app {
namespace {

struct ShakeOptions {
  std::string load;                     ///< recording (.h5), or placements
  std::optional<std::string> scenario;  ///< of the placements
  ScenarioChanges changes;
  std::string profile;
  double level = 0.5;  ///< g
  std::string hold = "none";
  std::string limits = "boxes";
  std::optional<std::string> film_layers;  ///< a number, or "least"
  int draws = 4;
  std::uint64_t seed = 1;
  bool all_frictions = false;
  double shift = 20.0;              ///< mm
  double tilt = 6.0;                ///< degrees
  std::optional<double> time_step;  ///< s
  std::optional<int> threads;       ///< absent: all cores
  std::optional<std::string> page;
  bool json = false;
};

constexpr const char* kLeast = "least";
constexpr int kMostLayers = 12;  ///< that `least` tries

/// Layers of film: a number, or as few as hold.
Check layers() {
  const Check is_number = whole(1, 40);
  return {[is_number](const std::string& text) {
            const bool fits = text == kLeast || is_number(text).empty();
            return fits ? std::string() : "got '" + text + "'; expected a whole number from 1 to 40, or least";
          },
          {}};
}

constexpr double kDegrees = 180.0 / std::numbers::pi;

runs::RecordedLoad load_of(const ShakeOptions& options) {
  if (std::filesystem::path(options.load).extension() == ".h5") {
    if (options.scenario || options.changes.any()) {
      throw InputError("command line", "--scenario", "a scenario beside a recording", "none: a recording has its own");
    }
    return runs::load_recorded(options.load);
  }
  if (!options.scenario) {
    throw InputError("command line", "--scenario", "nothing", "the scenario of the placements " + options.load);
  }
  runs::RecordedLoad load{load_changed(*options.scenario, options.changes), {}};
  load.boxes = model::load_placements(find_shipped(options.load), load.scenario);
  return load;
}

std::vector<runs::ShakeMotion> profile_of(const ShakeOptions& options, const model::Scenario& scenario) {
  if (std::filesystem::path(options.profile).extension() == ".csv") return runs::load_shake_profile(options.profile);
  const model::Container* container = model::find_container(scenario, scenario.target);
  runs::ShakeProfileOptions profile;
  profile.level = options.level;
  if (container != nullptr) profile.size = container->inner_size;
  return runs::make_shake_profile(options.profile, profile);
}

runs::ShakeOptions run_options(const ShakeOptions& options) {
  runs::ShakeOptions run;
  for (const runs::LoadHold hold : {runs::LoadHold::None, runs::LoadHold::Film, runs::LoadHold::Straps}) {
    if (options.hold == runs::name_of(hold)) run.hold = hold;
  }
  if (options.limits == runs::name_of(runs::ShakeLimits::Eumos40509)) run.limits = runs::ShakeLimits::Eumos40509;
  if (options.film_layers && run.hold != runs::LoadHold::Film) {
    throw InputError("command line", "--film-layers", "'" + *options.film_layers + "' without --hold film",
                     "film to wind");
  }
  if (options.film_layers && options.film_layers != kLeast) run.film_layers = std::stoi(*options.film_layers);
  run.draws = options.draws;
  run.seed = options.seed;
  run.all_frictions = options.all_frictions;
  run.shift = 1e-3 * options.shift;
  run.tilt = options.tilt / kDegrees;
  run.time_step = options.time_step;
  run.threads = options.threads.value_or(core_count());
  return run;
}

int run_shake(const ShakeOptions& options) {
  const runs::RecordedLoad load = load_of(options);
  NamedFiles inputs;
  if (options.scenario) inputs = files_of(*options.scenario, options.changes, load.scenario);
  add_file(inputs, "the load", options.load);
  std::optional<OutputFile> page = reserve(inputs, options.page);
  const std::vector<runs::ShakeMotion> profile = profile_of(options, load.scenario);
  const runs::ShakeOptions run = run_options(options);
  const runs::ShakeResult result =
      options.film_layers == kLeast ? runs::shake_with_least_film(load.scenario, load.boxes, profile, run, kMostLayers)
                                    : runs::shake(load.scenario, load.boxes, profile, run);
  const runs::ShakeWords words{options.load, options.profile, options.hold, options.tilt};
  if (page) write_file(std::move(*page), runs::format_shake_page(result, words));
  print(options.json ? runs::format_shake_json(result, words) : runs::format_shake_text(result, words));
  return result.holds() ? kSuccess : kRunFailed;
}

constexpr const char* kShakeExamples = R"(Profiles:
  conveyor    a belt at 0.5 m/s: starts and stops with 2 m/s2, an emergency stop with 5, along each axis
  truck       0.8 g forward (the longer side), 0.5 g to the rear and to either side, a second each (EN 12195-1)
  eumos40509  --level g to all four sides, for 0.3 s with ramps of 50 ms; usual levels are 0.3, 0.5 and 0.8
  tilt        slowly by the angle whose tangent is --level, to all four sides
  FILE.csv    a head of time_s and any of ax, ay, az (m/s2, of the container along its axes), roll_deg, pitch_deg; then rows
Every motion begins with the load at rest. It is run with the least friction of the scenario's and the draws; where the load
holds and moves by more than half a limit, with the most, and where it comes near a limit with those between; the worst
counts. --all-frictions runs every motion with each, for the worst figures. No time steps are taken while the load rests.
The container itself is fixed to what carries it.
Holds: film is wound around the load before any motion, and how far it draws the load together does not count; it runs
around each height, and each layer pulls with 87.5 N per metre of height, stretches with 1.5 kN/m and shears with 0.55 kN/m.
--film-layers least tries 1 to 12 and shows the first that holds. Straps press the boxes that carry no other down with
600 N in total.
Limits: boxes: none shifts by more than --max-shift. eumos40509, of a load of height H: no box shifts by more than 10 % of
H, nor in the end by more than 5 % of H and 60 mm (40 mm in the lowest 0.2 m). --max-tilt counts with both.
Exit code 0: the load holds; 1: a box shifts, tips or falls; 2: the input cannot be used.
Examples:
  snug shake scenarios/demo-placements.yaml --scenario scenarios/box-demonstrator.yaml --profile conveyor
  snug shake scenarios/demo-placements.yaml --scenario scenarios/box-demonstrator.yaml --profile eumos40509 --level 0.3 --page shake.html
  snug shake run.h5 --profile truck --json)";

}  // namespace

void add_shake(CLI::App& app, Action& action) {
  const Verb verb(app, action, "shake", "shake a packed container; report boxes that shift, tip or fall",
                  kShakeExamples);
  ShakeOptions& options = verb.runs(run_shake);
  verb.option("load", options.load, "RUN.h5|LOAD",
              "recording of a packed container (its last frame is used), or a list of placements")
      .required();
  verb.option("--scenario", options.scenario, "SCENARIO.yaml", "scenario of the placements; a recording has its own");
  add_scenario_changes(verb, options.changes);
  verb.option("--profile", options.profile, "NAME|FILE.csv", "how the container moves, see below").required();
  verb.option("--level", options.level, "G", "level of eumos40509 and tilt, in g", within(0.01, 2.0));
  verb.option("--hold", options.hold, "WHAT", "what holds the load besides walls and friction",
              one_of({"none", "film", "straps"}));
  verb.option("--film-layers", options.film_layers, "N|least", "layers of film, or as few as hold (default: 4)",
              layers());
  verb.option("--limits", options.limits, "WHICH", "when the load holds, see below", one_of({"boxes", "eumos40509"}));
  verb.option("--draws", options.draws, "N", "draws of friction from the scenario's uncertainty, besides its own",
              whole(0, 1000));
  verb.option("--seed", options.seed, "N", "seed of the draws", whole(0));
  verb.flag("--all-frictions", options.all_frictions, "run every motion with every friction");
  verb.option("--max-shift", options.shift, "MM", "largest allowed shift of a box, at any time, with --limits boxes",
              within(0.1, 10000.0));
  verb.option("--max-tilt", options.tilt, "DEGREES", "largest allowed tilt of a box, at any time", within(0.1, 180.0));
  verb.option("--time-step", options.time_step, "SECONDS",
              "time step of the simulation (default: 2 times the scenario's, 4 times where all faces are soft)",
              within(1e-5, 0.02));
  add_threads(verb, options.threads);
  verb.option("--page", options.page, "FILE.html", "write a page with the worst moment");
  add_json(verb, options.json);
}

}  // namespace snug::app
