// Task: placements into waypoints: plain pick-and-place in the cell of a scenario.
#include "snug/cell/task.hpp"

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/obstacles.hpp"
#include "snug/core/input_error.hpp"

namespace snug::cell {
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

Expected<motion::Program, motion::NoProgramReason> make_program(const model::Scenario& scenario,
                                                                const std::string& sequence_name,
                                                                const std::vector<model::PlacementEntry>& placements,
                                                                const std::string& placements_name) {
  const model::Sequence* sequence = model::find_sequence(scenario, sequence_name);
  if (sequence == nullptr) {
    throw InputError(scenario.source_name, "--sequence", "'" + sequence_name + "'", "a sequence of the scenario");
  }
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (!scenario.aligner || container == nullptr) {
    throw InputError(scenario.source_name, "", "", "a cell with an aligner and a target container");
  }
  std::vector<motion::PickSpec> picks;
  std::vector<motion::Placement> wanted;
  for (const model::PlacementEntry& placement : placements) {
    motion::PickSpec pick;
    pick.box = placement.parcel;
    pick.X_WP = pose_at_aligner(scenario, item_of(*sequence, placement, placements_name), std::nullopt);
    pick.size = model::collision_size(scenario, *model::find_parcel(scenario, placement.parcel));
    picks.push_back(pick);
    wanted.push_back({placement.parcel, placement.X_TP});
  }
  motion::PlacementSettings settings;
  settings.X_WT = container->X_WT;
  settings.rim_height = container->has_walls ? container->inner_size.z() : 0.0;
  settings.obstacle_top = highest_fixed_point(scenario);
  settings.pick_length = scenario.cup.hold_length;
  settings.hold_length = scenario.cup.hold_length;
  settings.X_WE_home = scenario.controller.X_WE_start;
  return motion::program_from_placements(picks, wanted, settings);
}

}  // namespace snug::cell
