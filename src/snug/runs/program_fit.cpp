// program_fit: the picks that a program's waypoints tell of, beside the items of a sequence.
#include "snug/runs/program_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::runs {
namespace {

/// The parcel of the scenario that a waypoint of this class is for, or nothing.
std::string parcel_of(const model::Scenario& scenario, const motion::Waypoint& waypoint,
                      motion::MotionClass motion_class) {
  std::string best;
  if (waypoint.motion_class != motion_class) return best;
  std::size_t most = 0;
  for (const model::Parcel& parcel : scenario.parcels) {
    const std::size_t fit = motion::fit_of(waypoint, parcel.id);
    if (fit > most) {
      most = fit;
      best = parcel.id;
    }
  }
  return best;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::ranges::find(names, name) != names.end();
}

/// Boxes that are picked where they arrive, in order, each once.
std::vector<std::string> picks_of(const model::Scenario& scenario, const motion::Program& program) {
  std::vector<std::string> picks;
  for (const motion::Waypoint& waypoint : program.waypoints) {
    const std::string parcel = parcel_of(scenario, waypoint, motion::MotionClass::Pick);
    if (!parcel.empty() && !has(picks, parcel)) picks.push_back(parcel);
  }
  return picks;
}

/// Boxes that are picked at the aligner before a row PrePick of theirs, at which boxes come, each once.
std::vector<std::string> never_come(const model::Scenario& scenario, const motion::Program& program) {
  std::vector<std::string> come, missing;
  for (const motion::Waypoint& waypoint : program.waypoints) {
    const std::string coming = parcel_of(scenario, waypoint, motion::MotionClass::PrePick);
    const std::string picked = parcel_of(scenario, waypoint, motion::MotionClass::Pick);
    if (!coming.empty()) come.push_back(coming);
    if (!picked.empty() && !has(come, picked) && !has(missing, picked)) missing.push_back(picked);
  }
  return missing;
}

/// Why the picks are none of this sequence; empty when they are.
std::string find_misfit(const model::Sequence& sequence, const std::vector<std::string>& picks) {
  std::vector<std::string> strangers;
  std::size_t next = 0;
  std::string late;
  for (const std::string& pick : picks) {
    const auto item = std::ranges::find(sequence.items, pick, &model::Item::parcel);
    if (item == sequence.items.end()) {
      strangers.push_back(pick);
      continue;
    }
    const auto place = static_cast<std::size_t>(item - sequence.items.begin());
    if (place < next && late.empty()) late = pick;
    next = std::max(next, place + 1);
  }
  if (!strangers.empty()) {
    return fmt::format("{} of the {} boxes that it picks are not in it ({} first)", strangers.size(), picks.size(),
                       strangers.front());
  }
  return late.empty() ? "" : fmt::format("it picks {} after a box that comes later", late);
}

constexpr std::size_t kMostNamed = 5;  // sequences in a message

/// "--sequence 2", "one of 2, 4", or what else would do.
std::string describe_fitting(const model::Scenario& scenario, const std::vector<std::string>& picks) {
  std::string names;
  std::size_t count = 0;
  for (const model::Sequence& sequence : scenario.sequences) {
    if (!find_misfit(sequence, picks).empty()) continue;
    if (++count <= kMostNamed) names += (count > 1 ? ", " : "") + sequence.name;
  }
  if (count == 0) return "a sequence with its boxes in the order of its picks; the scenario has none";
  return (count > 1 ? "one that fits: " : "") + names + (count > kMostNamed ? ", ..." : "");
}

}  // namespace

std::vector<std::string> find_misfits(const model::Scenario& scenario, const std::string& sequence_name,
                                      const motion::Program& program) {
  std::vector<std::string> found;
  const model::Sequence* sequence = model::find_sequence(scenario, sequence_name);
  if (sequence == nullptr) return found;  // refused elsewhere
  const std::vector<std::string> missing = never_come(scenario, program);
  if (!missing.empty()) {
    found.push_back(fmt::format("{} picks {} {} before a row PrePick lets {} come: {}", program.name, missing.size(),
                                missing.size() == 1 ? "box" : "boxes", missing.size() == 1 ? "it" : "them",
                                missing.front()));
  }
  const std::string misfit = find_misfit(*sequence, picks_of(scenario, program));
  if (!misfit.empty()) {
    found.push_back(
        fmt::format("{} does not fit sequence {}: {}: another sequence?", program.name, sequence_name, misfit));
  }
  return found;
}

void require_fit(const model::Scenario& scenario, const std::string& sequence_name, const motion::Program& program) {
  const model::Sequence* sequence = model::find_sequence(scenario, sequence_name);
  if (sequence == nullptr) return;  // refused elsewhere
  const std::vector<std::string> picks = picks_of(scenario, program);
  const std::string misfit = find_misfit(*sequence, picks);
  if (misfit.empty()) return;
  throw InputError(program.name, "--sequence", fmt::format("{}, which it does not fit: {}", sequence_name, misfit),
                   describe_fitting(scenario, picks));
}

}  // namespace snug::runs
