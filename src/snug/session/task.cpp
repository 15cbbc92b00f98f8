// Task: placements into waypoints: plain pick-and-place in the cell of a scenario.
#include "snug/session/task.hpp"

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/core/input_error.hpp"
#include "snug/skills/highest_fixed_point.hpp"

namespace snug::session {
namespace {

const model::Item& item_of(const model::Sequence& sequence, const model::PlacementEntry& placement,
                           const std::string& name) {
  for (const model::Item& item : sequence.items) {
    if (item.parcel == placement.parcel) return item;
  }
  throw InputError(name + ":" + std::to_string(placement.line), "box", "'" + placement.parcel + "'",
                   "a box of sequence '" + sequence.name + "'");
}

}  // namespace

Expected<motion::Program, skills::NoProgramReason> make_program(const model::Scenario& scenario,
                                                                const std::string& sequence_name,
                                                                const std::vector<model::PlacementEntry>& placements,
                                                                const std::string& placements_name) {
  const model::Sequence& sequence = cell::require_sequence(scenario, sequence_name);
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (!scenario.aligner || container == nullptr) {
    throw InputError(scenario.source_name, "", "", "a cell with an aligner and a target container");
  }
  std::vector<skills::PickSpec> picks;
  std::vector<skills::Placement> wanted;
  for (const model::PlacementEntry& placement : placements) {
    skills::PickSpec pick;
    pick.box = placement.parcel;
    pick.X_WP = cell::pose_at_aligner(scenario, item_of(sequence, placement, placements_name), std::nullopt);
    pick.size = model::collision_size(scenario, *model::find_parcel(scenario, placement.parcel));
    picks.push_back(pick);
    wanted.push_back({placement.parcel, placement.X_TP});
  }
  skills::PlacementSettings settings;
  settings.X_WT = container->X_WT;
  settings.rim_height = container->has_walls ? container->inner_size.z() : 0.0;
  settings.obstacle_top = skills::highest_fixed_point(scenario);
  settings.pick_length = scenario.cup.hold_length;
  settings.hold_length = scenario.cup.hold_length;
  settings.X_WE_home = scenario.controller.X_WE_start;
  return skills::program_from_placements(picks, wanted, settings);
}

}  // namespace snug::session
