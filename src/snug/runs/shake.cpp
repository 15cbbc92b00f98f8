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

constexpr double kStep = 2.0;        ///< times the scenario's, unless it is said
constexpr double kTolerance = 1e-4;  ///< m/s, residual of contacts: it moves a box by 0.1 mm a second at most
/// Of the limits. A load that moves no farther with the least friction is not run with more: such motions of 14 loads
/// moved no more there (docs/decisions/0130).
constexpr double kStill = 0.25;

/// The target and the boxes of the load alone: robots, benches and feeders do not travel.
model::Scenario travelling(model::Scenario scenario, const std::vector<model::PlacementEntry>& load, double friction,
                           const std::optional<double>& time_step) {
  std::erase_if(scenario.containers, [&](const model::Container& one) { return one.name != scenario.target; });
  scenario.bodies.clear();
  scenario.aligner.reset();
  scenario.drops.reset();
  scenario.solver.sleep.enabled = false;  // what drives it begins while it is at rest
  scenario.solver.tolerance = std::max(scenario.solver.tolerance, kTolerance);
  scenario.time_step = time_step.value_or(kStep * scenario.time_step);
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
  require(options.tilt > 0.0 && options.tilt <= 3.2, "tilt", options.tilt, "above 0, at most 180 degrees");
  if (!options.time_step) return;
  require(*options.time_step > 0.0 && *options.time_step <= 0.02, "time step", *options.time_step,
          "above 0, at most 0.02 s");
}

/// Whether more friction cannot make a motion worse: a box fell, or the load hardly moved.
bool is_decided(const ShakeRun& least) { return std::isinf(least.worst) || least.worst <= kStill; }

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

/// By friction, from the least on, then by motion. With the least friction every motion is run, with others those that
/// are not decided by it.
std::vector<std::vector<std::optional<ShakeRun>>> run_frictions(const model::Scenario& scenario,
                                                                const std::vector<model::PlacementEntry>& load,
                                                                const std::vector<ShakeMotion>& profile,
                                                                const ShakeOptions& options,
                                                                const std::vector<double>& frictions) {
  std::vector<std::vector<std::optional<ShakeRun>>> runs(frictions.size());
  std::vector<bool> is_wanted(profile.size() + steps_before_motions(options), true);
  const auto run = [&](std::size_t draw) {
    runs[draw] =
        run_motions(travelling(scenario, load, frictions[draw], options.time_step), load, profile, options, is_wanted);
    for (std::optional<ShakeRun>& one : runs[draw]) {
      if (one) one->friction = frictions[draw];
    }
  };
  run(0);
  for (std::size_t i = 0; i < is_wanted.size(); ++i) is_wanted[i] = !is_decided(*runs[0][i]);
  if (std::ranges::find(is_wanted, true) == is_wanted.end()) return runs;
  parallel_for(static_cast<int>(frictions.size()) - 1, options.threads,
               [&](int i, int) { run(static_cast<std::size_t>(i) + 1); });
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

}  // namespace snug::runs
