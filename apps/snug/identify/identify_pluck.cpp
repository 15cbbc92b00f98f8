// identify pluck: a virtual release, as sensors would record it.
#include <fmt/format.h>
#include <fmt/printf.h>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/identify/identify.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/virtual_experiments.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {
namespace {

struct IdentifyPluckOptions : IdentifyOptions {
  std::string parcel;
  std::string direction = "axial";
  std::optional<double> amplitude;  ///< m or rad
  std::uint64_t repeat = 3;
  std::uint64_t seed = 1;
};

int run_identify_pluck(const IdentifyPluckOptions& options) {
  using identification::PluckDirection;
  identification::Pluck pluck;
  // A B1 box of the demonstrator, held by the middle of its upper face: Sz points into it.
  Vector3 size(0.2, 0.2, 0.097);
  SpatialInertia box{0.55, Vector3(0.0, 0.0, -0.032), Vector3(0.0021, 0.0022, 0.0038).asDiagonal()};
  model::CupParams cup;
  if (options.scenario) {
    const model::Scenario scenario = model::load_scenario(find_scenario(*options.scenario));
    cup = scenario.cup;
    if (!options.parcel.empty()) {
      const model::Parcel* parcel = model::find_parcel(scenario, options.parcel);
      if (parcel == nullptr) {
        std::vector<std::string> ids;
        for (const model::Parcel& one : scenario.parcels) ids.push_back(one.id);
        const std::string_view nearest = find_nearest(options.parcel, ids);
        throw InputError("command line", "--parcel", "'" + options.parcel + "'",
                         nearest.empty() ? "a parcel of the scenario"
                                         : "a parcel of the scenario, nearest is " + std::string(nearest));
      }
      size = parcel->size;
      box = parcel->inertia;
    }
  } else if (!options.parcel.empty()) {
    throw InputError("command line", "--parcel", "no scenario that has it", "--scenario as well");
  }
  const Matrix3 R_SP = Vector3(1.0, -1.0, -1.0).asDiagonal();
  pluck.load_S = {box.mass, R_SP * (box.com - Vector3(0.0, 0.0, 0.5 * size.z())),
                  R_SP * box.inertia * R_SP.transpose()};
  pluck.frames = identification::frames_of(cup);
  pluck.K = cup::as_matrix(cup.stiffness);
  pluck.D = cup::as_matrix(cup.damping);
  pluck.direction = options.direction == "axial"     ? PluckDirection::Axial
                    : options.direction == "lateral" ? PluckDirection::Lateral
                    : options.direction == "bend"    ? PluckDirection::Bend
                                                     : PluckDirection::Torsion;
  const bool is_turn = pluck.direction == PluckDirection::Bend || pluck.direction == PluckDirection::Torsion;
  pluck.amplitude = options.amplitude.value_or(is_turn ? 0.1 : 0.004);
  constexpr double kMostPull = 0.03, kMostTurn = 0.6;  // m, rad: a cup of 50 mm, a law that ends at 45 degrees
  if (pluck.amplitude > (is_turn ? kMostTurn : kMostPull))
    throw InputError("command line", "--amplitude", fmt::format("{}", pluck.amplitude),
                     is_turn ? "0.6 rad or less" : "0.03 m or less");
  MeasurementNoise noise;
  bool is_given = true;
  apply(options, noise, is_given);
  Rng rng = Rng(options.seed).split("pluck");
  std::vector<identification::Release> releases;
  for (std::uint64_t i = 0; i < options.repeat; ++i) {
    releases.push_back(identification::make_pluck(pluck));
    identification::add_noise(releases.back(), noise, rng);
  }
  NamedFiles inputs;
  add_file(inputs, "--scenario", options.scenario);
  write_file(*reserve(inputs, options.output), identification::format_releases(releases));
  print(fmt::sprintf("%s: %llu releases %s by %g %s, %g kg, %zu samples each\n", options.output->c_str(),
                     static_cast<unsigned long long>(options.repeat), options.direction.c_str(), pluck.amplitude,
                     is_turn ? "rad" : "m", box.mass, releases.front().times.size()));
  return kSuccess;
}

constexpr const char* kPluckHelp =
    R"(Swings say little about damping along the cup's axis. This writes the experiment that does, as sensors would record it
(360 Hz, 1.5 s): the box hangs straight down, is pulled along the axis and let go; --direction lateral, bend, torsion for
the others. What it is identified with: snug identify damping.
Examples:
  snug identify pluck --scenario scenarios/box-demonstrator.yaml --parcel BOX013 -o pluck.json
  snug identify damping pluck.json)";

}  // namespace

void add_identify_pluck(const Verb& verb) {
  const Verb part = verb.part("pluck", "a virtual release, to see what it would tell", kPluckHelp);
  IdentifyPluckOptions& options = part.runs(run_identify_pluck);
  part.option("--parcel", options.parcel, "ID", "box of the scenario, held in the middle of its upper face");
  part.option("--direction", options.direction, "NAME", "axial, lateral, bend or torsion",
              one_of({"axial", "lateral", "bend", "torsion"}));
  part.option("--amplitude", options.amplitude, "M|RAD", "pulled so far; 0.004 m, or 0.1 rad for bend and torsion",
              positive());
  part.option("--repeat", options.repeat, "N", "releases", whole(1, 100));
  part.option("--seed", options.seed, "N", "of the noise", whole(0));
  part.option("-o,--output", options.output, "FILE.json", "the releases").required();
  add_identify_scenario(part, options);
  add_pose_noise(part, options);
}

}  // namespace snug::app
