// Rows of the demonstrator's program: motions that pack its first boxes, for the tests of this module.
#pragma once

#include <algorithm>
#include <string>
#include <string_view>

#include "snug/model/test/shortened.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/plant/wait.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

namespace snug::simulated_plant::test {

/// BOX027 and BOX028 side by side at the -y end of the container, BOX013 at its middle: none touches another.
inline constexpr std::string_view kItems[] = {"BOX027", "BOX028", "BOX013"};

/// Their cell.
inline const model::Scenario& three_boxes() {
  static const model::Scenario one = model::test::shortened(3);
  return one;
}

/// From the aligner to its place and up again.
inline plant::Motion packing_of(std::string_view item) {
  static const motion::Program all = motion::load_program(SNUG_SOURCE_DIR "/src/snug/cell/test/demo_program.csv");
  plant::Motion motion{model::ParcelId(std::string(item)), {}, {}, {}};
  for (const motion::Waypoint& row : all.waypoints) {
    if (row.item == item) motion.waypoints.push_back(row);
  }
  return motion;
}

/// The same up to where it is lifted.
inline plant::Motion pick_of(std::string_view item) {
  plant::Motion motion = packing_of(item);
  const auto lifted =
      std::ranges::find(motion.waypoints, motion::MotionClass::PostPick, &motion::Waypoint::motion_class);
  motion.waypoints.erase(lifted + 1, motion.waypoints.end());
  return motion;
}

/// The cell as the scenario says, the tool alone.
inline SimulatedPlantOptions nominal(std::string_view faults = {}) {
  SimulatedPlantOptions options;
  options.seed = 0;
  options.faults = parse_faults(faults);
  return options;
}

/// The motion; `look` is shown each tick that it makes.
template <class Look>
plant::Feedback run_seen(SimulatedPlant& plant, const plant::Motion& motion, const Look& look) {
  plant.start(motion);
  for (;;) {
    const auto before = plant.state().world.step_index;
    const std::vector<plant::Event> events = plant.advance();
    if (plant.state().world.step_index != before) look(*plant.last_tick());
    for (const plant::Event& event : events) {
      if (const auto* ended = plant::get<plant::MotionEnded>(event)) return ended->feedback;
    }
  }
}

/// Brings the item and packs it.
template <class Look>
plant::Feedback pack(SimulatedPlant& plant, std::string_view item, const Look& look) {
  if (!plant::bring_and_wait(plant, model::ParcelId(std::string(item)))) return {};
  return run_seen(plant, packing_of(item), look);
}
inline plant::Feedback pack(SimulatedPlant& plant, std::string_view item) {
  return pack(plant, item, [](const cell::CellTick&) {});
}

/// X_WP by the plant's truth.
inline Pose pose_of(const SimulatedPlant& plant, std::string_view item) {
  const auto& items = plant.simulation().sequence().items;
  const auto found = std::ranges::find(items, item, &model::Item::parcel);
  const auto& world = plant.simulation().world();
  return physics::pose_of(world.model, plant.state().world,
                          world.parcels[static_cast<std::size_t>(found - items.begin())]);
}

/// Of what the faults noted.
inline std::vector<record::Event> fault_events(const SimulatedPlant& plant) {
  std::vector<record::Event> found;
  std::ranges::copy_if(plant.state().event_log.events(), std::back_inserter(found),
                       [](const record::Event& event) { return event.kind == "fault"; });
  return found;
}

}  // namespace snug::simulated_plant::test
