// shake: a container with its load, driven with accelerations: which boxes shift, tip or fall.
#include "snug/runs/shake.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/rng.hpp"
#include "snug/runs/internal/shaken_load.hpp"

namespace snug::runs {
namespace {

/// How finely a load is simulated (docs/decisions/0130, 0144).
struct Fineness {
  double steps;      ///< time step over the scenario's, unless it is said
  double most_step;  ///< s, up to which the step is made larger than twice the scenario's
  double tolerance;  ///< m/s, residual of contacts
};
constexpr Fineness kRigid{2.0, 0.0, 1e-4};
/// Faces that give way say by their depth what a step left; rigid boxes would creep by it.
constexpr Fineness kSoft{4.0, 0.004, 1e-3};

/// Of the limits (docs/decisions/0144): a load that moves no farther with the least friction is not run with more; one
/// that moves no farther with the least and with the most is not run with what lies between.
constexpr double kStill = 0.5, kClear = 0.75;

/// Whether all faces that can meet in the load give way.
bool is_soft(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load) {
  std::vector<model::MaterialId> boxes;
  for (const model::PlacementEntry& one : load) {
    const model::MaterialId material = model::find_parcel(scenario, one.parcel)->material;
    if (std::ranges::find(boxes, material) == boxes.end()) boxes.push_back(material);
  }
  std::vector<model::MaterialId> all = boxes;
  all.push_back(model::find_container(scenario, scenario.target)->material);
  return std::ranges::all_of(boxes, [&](const model::MaterialId a) {
    return std::ranges::all_of(all, [&](const model::MaterialId b) {
      const std::optional<model::ContactParams> contact = model::find_contact(scenario, a, b);
      return contact && contact->stiffness > 0.0;
    });
  });
}

/// Film moves a load while it is wound, and how far depends on the step.
const Fineness& fineness_of(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                            const ShakeOptions& options) {
  return options.hold != LoadHold::Film && is_soft(scenario, load) ? kSoft : kRigid;
}

/// s.
double step_of(const Fineness& fineness, double own) {
  return std::max(kRigid.steps * own, std::min(fineness.steps * own, fineness.most_step));
}

/// The target and the boxes of the load alone: robots, benches and feeders do not travel.
model::Scenario travelling(model::Scenario scenario, const std::vector<model::PlacementEntry>& load, double friction,
                           const ShakeOptions& options) {
  const Fineness& fineness = fineness_of(scenario, load, options);
  std::erase_if(scenario.containers, [&](const model::Container& one) { return one.name != scenario.target; });
  scenario.bodies.clear();
  scenario.aligner.reset();
  scenario.drops.reset();
  scenario.solver.sleep.enabled = false;  // what drives it begins while it is at rest
  scenario.solver.tolerance = std::max(scenario.solver.tolerance, fineness.tolerance);
  scenario.time_step = options.time_step.value_or(step_of(fineness, scenario.time_step));
  const auto scale = [friction](model::ContactParams& params) {
    params.friction *= friction;
    if (params.edge_friction) *params.edge_friction *= friction;
  };
  for (model::ContactPair& pair : scenario.contact_pairs) scale(pair.params);
  if (scenario.default_contact) scale(*scenario.default_contact);
  model::Sequence sequence;
  sequence.name = "load";
  for (const model::PlacementEntry& one : load) sequence.items.emplace_back().parcel = one.parcel;
  scenario.sequences = {sequence};
  return scenario;
}

void check(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
           const ShakeOptions& options) {
  if (model::find_container(scenario, scenario.target) == nullptr) {
    throw InputError(scenario.source_name, "target", "nothing", "a container with a load");
  }
  if (load.empty()) throw InputError("load", "", "no boxes", "one at least");
  const auto require = [](bool holds, const char* key, double value, const char* expected) {
    require_number(holds, "shake", key, value, expected);
  };
  require(options.draws >= 0 && options.draws <= 1000, "draws", options.draws, "0 .. 1000");
  require(options.shift > 0.0 && options.shift <= 10.0, "shift", options.shift, "above 0, at most 10 m");
  require(options.film_layers >= 1 && options.film_layers <= 40, "film layers", options.film_layers, "1 .. 40");
  require(options.tilt > 0.0 && options.tilt <= 3.2, "tilt", options.tilt, "above 0, at most 180 degrees");
  if (!options.time_step) return;
  require(*options.time_step > 0.0 && *options.time_step <= 0.02, "time step", *options.time_step,
          "above 0, at most 0.02 s");
}

/// Whether the other frictions cannot change the verdict: it fails already, or the load moves little.
bool is_decided(const ShakeRun& least) { return least.worst > 1.0 || least.worst <= kStill; }
bool is_decided(const ShakeRun& least, const ShakeRun& most) {
  return most.worst > 1.0 || std::max(least.worst, most.worst) <= kClear;
}

/// At rest, and wound.
std::size_t steps_before_motions(const ShakeOptions& options) { return options.hold == LoadHold::Film ? 2 : 1; }

/// With one friction: the load at rest and those motions that are wanted. What is not wanted is absent.
std::vector<std::optional<ShakeRun>> run_motions(const model::Scenario& scenario,
                                                 const std::vector<model::PlacementEntry>& load,
                                                 const std::vector<ShakeMotion>& profile, const ShakeOptions& options,
                                                 const std::vector<bool>& is_wanted) {
  internal::ShakenLoad shaken(scenario, load, options);
  std::vector<std::optional<ShakeRun>> runs;
  for (ShakeRun& run : shaken.settle()) runs.emplace_back(std::move(run));
  for (const ShakeMotion& motion : profile) {
    runs.push_back(is_wanted[runs.size()] ? std::optional(shaken.shake(motion)) : std::nullopt);
  }
  return runs;
}

/// By friction, from the least on, then by motion: first the least friction, then the most, then those between, each
/// with the motions that are not decided before.
std::vector<std::vector<std::optional<ShakeRun>>> run_frictions(const model::Scenario& scenario,
                                                                const std::vector<model::PlacementEntry>& load,
                                                                const std::vector<ShakeMotion>& profile,
                                                                const ShakeOptions& options,
                                                                const std::vector<double>& frictions) {
  std::vector<std::vector<std::optional<ShakeRun>>> runs(frictions.size());
  std::vector<bool> is_wanted(profile.size() + steps_before_motions(options), true);
  const auto run = [&](std::size_t draw) {
    runs[draw] = run_motions(travelling(scenario, load, frictions[draw], options), load, profile, options, is_wanted);
    for (std::optional<ShakeRun>& one : runs[draw]) {
      if (one) one->friction = frictions[draw];
    }
  };
  const auto run_between = [&](std::size_t first, std::size_t end) {
    if (std::ranges::find(is_wanted, true) == is_wanted.end()) return;
    parallel_for(static_cast<int>(end - first), options.threads,
                 [&](int i, int) { run(first + static_cast<std::size_t>(i)); });
  };
  run(0);
  const std::size_t last = frictions.size() - 1;
  if (last == 0) return runs;
  if (options.all_frictions) {
    run_between(1, frictions.size());
    return runs;
  }
  for (std::size_t i = 0; i < is_wanted.size(); ++i) is_wanted[i] = !is_decided(*runs[0][i]);
  run_between(last, frictions.size());
  for (std::size_t i = 0; i < is_wanted.size(); ++i) {
    is_wanted[i] = is_wanted[i] && !is_decided(*runs[0][i], *runs[last][i]);
  }
  run_between(1, last);
  return runs;
}

}  // namespace

const char* name_of(ShakeLimits limits) { return limits == ShakeLimits::Boxes ? "boxes" : "eumos40509"; }

const char* name_of(LoadHold hold) {
  switch (hold) {
    case LoadHold::None:
      return "none";
    case LoadHold::Film:
      return "film";
    case LoadHold::Straps:
      return "straps";
  }
  return "";
}

ShakeResult shake(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                  const std::vector<ShakeMotion>& profile, const ShakeOptions& options) {
  check(scenario, load, options);
  std::vector<double> frictions{1.0};
  Rng rng = Rng(options.seed).split("shake friction");
  const double half_width = scenario.uncertainty.friction;
  for (int i = 0; i < options.draws; ++i) frictions.push_back(1.0 + rng.uniform(-half_width, half_width));
  std::ranges::sort(frictions);
  ShakeResult result;
  result.film_layers = options.hold == LoadHold::Film ? options.film_layers : 0;
  result.inner_size = model::find_container(scenario, scenario.target)->inner_size;
  for (const model::PlacementEntry& one : load) {
    result.boxes.push_back(one.parcel);
    result.sizes.push_back(model::collision_size(scenario, *model::find_parcel(scenario, one.parcel)));
  }
  const internal::AllowedShift allowed = internal::allowed_shift(scenario, load, options);
  result.shift = allowed.shift;
  result.remaining = *std::ranges::max_element(allowed.remaining);
  auto runs = run_frictions(scenario, load, profile, options, frictions);
  const std::size_t first = steps_before_motions(options);
  for (std::size_t m = 0; m < profile.size() + first; ++m) {
    for (std::vector<std::optional<ShakeRun>>& own : runs) {
      if (m >= own.size() || !own[m]) continue;
      result.seconds += m == 0      ? internal::kSettleTime
                        : m < first ? internal::kWindTime + internal::kSettleTime
                                    : profile[m - first].duration();
      result.runs.push_back(std::move(*own[m]));
    }
  }
  for (std::size_t i = 0; i < result.runs.size(); ++i) {
    if (result.runs[i].worst > result.runs[result.worst].worst) result.worst = i;
  }
  return result;
}

ShakeResult shake_with_least_film(const model::Scenario& scenario, const std::vector<model::PlacementEntry>& load,
                                  const std::vector<ShakeMotion>& profile, ShakeOptions options, int most) {
  ShakeResult nearest;
  for (options.film_layers = 1; options.film_layers <= std::max(1, most); ++options.film_layers) {
    ShakeResult result = shake(scenario, load, profile, options);
    if (result.holds()) return result;
    const bool is_nearer = nearest.runs.empty() || result.runs[result.worst].worst < nearest.runs[nearest.worst].worst;
    if (is_nearer) nearest = std::move(result);
  }
  return nearest;
}

}  // namespace snug::runs
