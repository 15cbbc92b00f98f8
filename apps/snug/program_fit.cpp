// program_fit: the picks that a program's waypoints tell of, beside the items of a sequence.
#include "program_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <vector>

#include "snug/motion/waypoint_name.hpp"

namespace snug::app {
namespace {

/// The parcel of the scenario that a waypoint picks at the aligner, or nothing.
std::string picked_parcel(const model::Scenario& scenario, const motion::Waypoint& waypoint) {
  std::string best;
  if (waypoint.motion_class != motion::MotionClass::Pick) return best;
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

/// Boxes that are picked where they arrive, in order, each once.
std::vector<std::string> picks_of(const model::Scenario& scenario, const motion::Program& program) {
  std::vector<std::string> picks;
  for (const motion::Waypoint& waypoint : program.waypoints) {
    const std::string parcel = picked_parcel(scenario, waypoint);
    if (!parcel.empty() && std::ranges::find(picks, parcel) == picks.end()) picks.push_back(parcel);
  }
  return picks;
}

}  // namespace

void warn_misfit(const model::Scenario& scenario, const std::string& sequence_name, const motion::Program& program) {
  const model::Sequence* sequence = model::find_sequence(scenario, sequence_name);
  if (sequence == nullptr) return;  // refused elsewhere
  const std::vector<std::string> picks = picks_of(scenario, program);
  std::vector<std::string> strangers;
  std::size_t next = 0;
  std::string late;
  for (const std::string& pick : picks) {
    const auto item = std::ranges::find(sequence->items, pick, &model::Item::parcel);
    if (item == sequence->items.end()) {
      strangers.push_back(pick);
      continue;
    }
    const auto place = static_cast<std::size_t>(item - sequence->items.begin());
    if (place < next && late.empty()) late = pick;
    next = std::max(next, place + 1);
  }
  if (!strangers.empty()) {
    std::fprintf(
        stderr,
        "snug: warning: %s does not fit sequence %s: %zu of the %zu boxes that it picks are not in it (%s first): "
        "another sequence?\n",
        program.name.c_str(), sequence_name.c_str(), strangers.size(), picks.size(), strangers.front().c_str());
  } else if (!late.empty()) {
    std::fprintf(stderr,
                 "snug: warning: %s does not fit sequence %s: it picks %s after a box that comes later: another "
                 "sequence?\n",
                 program.name.c_str(), sequence_name.c_str(), late.c_str());
  }
}

}  // namespace snug::app
