// identify pluck: a virtual release, as sensors would record it.
#include <fmt/printf.h>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/identification/virtual_experiments.hpp"
#include "snug/model/scenario_changes.hpp"

namespace snug::app {
namespace {

struct IdentifyPluckOptions : IdentifyOptions {
  std::string parcel;
  std::string direction = "axial";
  std::optional<double> amplitude;  ///< m or rad
  int repeat = 3;
  std::uint64_t seed = 1;
};

int run_identify_pluck(const IdentifyPluckOptions& options) {
  // A B1 box of the demonstrator, held by the middle of its upper face: Sz points into it.
  Vector3 size(0.2, 0.2, 0.097);
  SpatialInertia box{0.55, Vector3(0.0, 0.0, -0.032), Vector3(0.0021, 0.0022, 0.0038).asDiagonal()};
  model::CupParams cup;
  if (options.scenario) {
    const model::Scenario scenario = model::load_scenario(find_scenario(*options.scenario));
    cup = scenario.cup;
    if (!options.parcel.empty()) {
      const model::Parcel& parcel = model::require_parcel(scenario, options.parcel, "--parcel");
      size = parcel.size;
      box = parcel.inertia;
    }
  } else if (!options.parcel.empty()) {
    throw InputError("command line", "--parcel", "no scenario that has it", "--scenario as well");
  }
  const identification::PluckDirection direction = identification::pluck_direction_of(options.direction);
  const identification::Pluck pluck = identification::plan_pluck(cup, size, box, direction, options.amplitude);
  identification::MeasurementNoise noise;
  bool is_given = true;
  apply(options, noise, is_given);
  const std::vector<identification::Release> releases =
      identification::make_plucks(pluck, options.repeat, noise, options.seed);
  NamedFiles inputs;
  add_file(inputs, "--scenario", options.scenario);
  write_file(*reserve(inputs, options.output), identification::format_releases(releases));
  print(fmt::sprintf("%s: %d releases %s by %g %s, %g kg, %zu samples each\n", options.output->c_str(), options.repeat,
                     options.direction.c_str(), pluck.amplitude, identification::is_turn(direction) ? "rad" : "m",
                     box.mass, releases.front().times.size()));
  return kSuccess;
}

constexpr const char* kPluckHelp =
    R"(Swings determine damping along the cup's axis poorly. pluck writes an experiment that determines it, as sensors would record
it (360 Hz, 1.5 s): the box hangs straight down, is pulled along the axis and let go; --direction lateral, bend, torsion for
the other directions. `snug identify damping` reads it.
Examples:
  snug identify pluck --scenario scenarios/box-demonstrator.yaml --parcel BOX013 -o pluck.json
  snug identify damping pluck.json)";

}  // namespace

void add_identify_pluck(const Verb& verb) {
  const Verb part = verb.part("pluck", "simulate a release, to see what it would identify", kPluckHelp);
  IdentifyPluckOptions& options = part.runs(run_identify_pluck);
  part.option("--parcel", options.parcel, "ID", "box of the scenario, held in the middle of its upper face");
  part.option("--direction", options.direction, "NAME", "axial, lateral, bend or torsion",
              one_of({"axial", "lateral", "bend", "torsion"}));
  part.option("--amplitude", options.amplitude, "M|RAD", "displacement; 0.004 m, or 0.1 rad for bend and torsion",
              positive());
  part.option("--repeat", options.repeat, "N", "releases", whole(1, 100));
  part.option("--seed", options.seed, "N", "of the noise", whole(0));
  part.option("-o,--output", options.output, "FILE.json", "the releases").required();
  add_identify_scenario(part, options);
  add_pose_noise(part, options);
}

}  // namespace snug::app
