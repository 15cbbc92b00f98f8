// WatchedCell: a cell that another program serves over CLICK, as somebody sees it who only looks.
#include "snug/remote_plant/watched_cell.hpp"

#include <cmath>
#include <utility>

#include "snug/click/names.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/csv.hpp"

namespace snug::remote_plant {
namespace {

cell::SimulationOptions with_robot(const model::Scenario& scenario) {
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "", "a robot, as served cells have");
  cell::SimulationOptions options;
  options.robot = scenario.robot->name;
  return options;
}

}  // namespace

WatchedCell::WatchedCell(model::Scenario scenario, const std::string& sequence, const std::string& endpoint,
                         double patience, const std::optional<click::ClientKeys>& keys)
    : simulation_(scenario, sequence, with_robot(scenario)),
      client_(click::Client::watcher(endpoint, patience, keys)),
      link_(client_, simulation_.arm()->model(), {.needs_vacuum = false, .only_looks = true}) {
  for (const model::Item& item : simulation_.sequence().items) names_.push_back(record::log_name(item.parcel));
  std::string trouble = link_.connect(simulation_.scenario().controller.tick);
  for (const std::string& name : names_) {
    if (trouble.empty() && !link_.handshake().objects.contains(name)) trouble = "it has no object '" + name + "'";
  }
  if (trouble.empty()) return;
  throw InputError("command line", "--click", "'" + endpoint + "'",
                   "a served cell with sequence " + sequence + ": " + trouble);
}

std::optional<Pose> WatchedCell::find_box(std::size_t item) const {
  const auto found = link_.last().objects.find(names_[item]);
  if (found == link_.last().objects.end() || !click::is_active(found->second, click::kPresentSensor)) return {};
  return click::sensed_pose(found->second);
}

std::vector<WatchedCell::Box> WatchedCell::boxes() const {
  std::vector<Box> boxes;
  const model::Scenario& scenario = simulation_.scenario();
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const auto X_WP = find_box(i);
    if (!X_WP) continue;
    const std::string& id = simulation_.sequence().items[i].parcel;
    boxes.push_back({id, *X_WP, model::collision_size(scenario, *model::find_parcel(scenario, id))});
    const click::SensorValue* size =
        find_sensor(link_.last().objects.find(names_[i])->second, click::kSizeSensor, click::ValueType::Position);
    if (size != nullptr && size->vector.allFinite() && size->vector.minCoeff() > 0.0) boxes.back().size = size->vector;
  }
  return boxes;
}

cell::CellState WatchedCell::state() const {
  cell::CellAnchor anchor;
  const robot::JointVector& q = link_.measured().q;
  anchor.q.assign(q.begin(), q.end());
  for (std::size_t i = 0; i < names_.size(); ++i) {
    if (const auto X_WP = find_box(i)) anchor.boxes.push_back({static_cast<int>(i), *X_WP});
  }
  cell::CellState state = simulation_.take_up(anchor);
  const cell::CellWorld& world = simulation_.world();
  for (const physics::BodyId body : world.bodies) {
    const physics::BodyModel& model = world.model.bodies[static_cast<std::size_t>(body.index)];
    const auto found = link_.last().objects.find(record::log_name(model.name));
    if (model.kind != physics::BodyKind::Dynamic || found == link_.last().objects.end()) continue;
    if (const auto X_WB = click::sensed_pose(found->second)) physics::set_pose(world.model, state.world, body, *X_WB);
  }
  state.world.step_index = std::llround(time() / world.model.settings.dt);
  return state;
}

}  // namespace snug::remote_plant
