// ProgramClient: snug's own joint controller as a client of CLICK: a program through the joints of any simulator.
#include "snug/click/program_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/click/served_cell.hpp"
#include "snug/record/csv.hpp"

namespace snug::click {
namespace {

constexpr double kSettleTime = 1.0;         ///< s, after the last waypoint, for boxes that still move
constexpr double kLongestProgram = 7200.0;  ///< s

int index_of(const std::vector<std::string>& names, const std::string& name) {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : static_cast<int>(found - names.begin());
}

class ProgramClient {
 public:
  ProgramClient(Client& client, const model::Scenario& scenario, const cell::CellArm& arm,
                const motion::PreparedProgram& plan, const ProgramClientSettings& settings)
      : client_(client), scenario_(scenario), arm_(arm), plan_(plan), settings_(settings) {}

  ProgramClientResult run() {
    const auto start = std::chrono::steady_clock::now();
    result_.failure = connect();
    if (result_.failure.empty()) result_.failure = work();
    result_.simulated = result_.last.time;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    result_.wall = wall.count();
    return std::move(result_);
  }

 private:
  /// Finds what is needed in the handshake and where the joints are. Empty, or what is missing.
  std::string connect() {
    auto handshake = client_.shake_hands();
    if (!handshake) return handshake.error();
    handshake_ = std::move(*handshake);
    const double tick = arm_.controller().settings().tick;
    if (std::abs(handshake_.time_step - tick) > 1e-9) {
      return fmt::format("the simulator steps by {} s, the controller by {} s", handshake_.time_step, tick);
    }
    std::string trouble = find_robot();
    if (trouble.empty()) trouble = find_events();
    if (trouble.empty()) trouble = sense();
    if (!trouble.empty()) return trouble;
    state_ = arm_.make_state(scenario_.seed, measured_.q);
    program_ = motion::make_controller_state(state_.machine.tool.X_WE);
    return {};
  }

  std::string find_robot() {
    for (const auto& [name, object] : handshake_.objects) {
      if (settings_.object.empty() ? !has_joints(object) : name != settings_.object) continue;
      if (robot_ != nullptr) return fmt::format("both '{}' and '{}' have these joints: --object", robot_name_, name);
      robot_ = &object;
      robot_name_ = name;
    }
    if (robot_ == nullptr) {
      return settings_.object.empty() ? "the simulator has no object with the joints of " + arm_.model().name
                                      : "the simulator has no object '" + settings_.object + "'";
    }
    for (const robot::Joint& joint : arm_.model().joints) {
      const int control = index_of(robot_->controls, joint.name), sensor = index_of(robot_->joints, joint.name);
      if (control < 0 || sensor < 0) return fmt::format("object '{}' has no joint '{}'", robot_name_, joint.name);
      const ValueType type = robot_->control_types[static_cast<std::size_t>(control)];
      if (type != ValueType::Angle && type != ValueType::AngularVelocity1D) {
        return fmt::format("joint '{}' takes {}; this controller has Angle and AngularVelocity1D", joint.name,
                           name_of(type));
      }
      joints_.push_back({control, sensor, type == ValueType::Angle});
    }
    if (robot_->controls.size() != joints_.size()) {
      return fmt::format("object '{}' has {} joints, {} has {}", robot_name_, robot_->controls.size(),
                         arm_.model().name, joints_.size());
    }
    return {};
  }

  bool has_joints(const ObjectDescription& object) const {
    return std::all_of(arm_.model().joints.begin(), arm_.model().joints.end(),
                       [&](const robot::Joint& joint) { return index_of(object.controls, joint.name) >= 0; });
  }

  std::string find_events() {
    const auto event_of = [&](const std::string& name) { return robot_->events.contains(name); };
    const bool needs_vacuum = std::any_of(plan_.program.waypoints.begin(), plan_.program.waypoints.end(),
                                          [](const motion::Waypoint& row) { return row.io.vacuum; });
    if (needs_vacuum && !event_of(settings_.vacuum_event)) {
      return fmt::format("object '{}' has no event '{}': --vacuum-event", robot_name_, settings_.vacuum_event);
    }
    has_vacuum_ = event_of(settings_.vacuum_event);
    has_blow_off_ = event_of(settings_.blow_off_event);
    if (settings_.sequence == nullptr) return {};
    for (const model::Item& item : settings_.sequence->items) {
      const std::string name = record::log_name(item.parcel);
      const auto found = handshake_.objects.find(name);
      const bool can_come = found != handshake_.objects.end() && found->second.events.contains(kFeedEvent);
      boxes_.push_back(can_come ? name : "");
    }
    return {};
  }

  /// Takes over what the simulator sensed.
  std::string take(Expected<Sensor, std::string> sensor) {
    if (!sensor) return sensor.error();
    const auto found = sensor->objects.find(robot_name_);
    if (found == sensor->objects.end()) return fmt::format("no sensors of '{}'", robot_name_);
    const ObjectSensors& robot = found->second;
    const std::size_t n = robot_->joints.size();
    if (robot.angles.size() != n || robot.velocities.size() != n) {
      return fmt::format("'{}' has {} joints but senses {} angles and {} speeds", robot_name_, n, robot.angles.size(),
                         robot.velocities.size());
    }
    const auto count = static_cast<Eigen::Index>(joints_.size());
    measured_.q.resize(count);
    measured_.qd.resize(count);
    measured_.qdd.setZero(count);
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      measured_.q[static_cast<Eigen::Index>(j)] = robot.angles[static_cast<std::size_t>(joints_[j].sensor)];
      measured_.qd[static_cast<Eigen::Index>(j)] = robot.velocities[static_cast<std::size_t>(joints_[j].sensor)];
    }
    if (!measured_.q.allFinite() || !measured_.qd.allFinite()) return "the simulator senses what are no numbers";
    result_.last = std::move(*sensor);
    return {};
  }

  std::string sense() { return take(client_.sense()); }

  std::string work() {
    double end = kLongestProgram;
    bool has_ended = false;
    while (result_.last.time < end) {
      const control::MachineTick tick = think();
      result_.row = std::max(0, tick.program.row);
      if (tick.outcome == "Stuck") {
        const motion::Waypoint& row = plan_.program.waypoints[static_cast<std::size_t>(result_.row)];
        const std::string text = fmt::format("stuck toward {} (row {})", row.name, result_.row + 1);
        client_.report_error(text);
        return text;
      }
      std::string trouble = take(client_.control(command(tick.program)));
      if (!trouble.empty()) return trouble;
      ++result_.ticks;
      if (!tick.program.finished_now || has_ended) continue;
      has_ended = true;
      result_.duration = result_.last.time;
      end = result_.duration + kSettleTime;
    }
    if (!has_ended) return "the program did not end within two hours";
    return client_.reset();
  }

  control::MachineTick think() {
    state_.machine.tool = control::tool_at(arm_.model(), measured_);
    return arm_.tick(plan_, program_, state_, work_);
  }

  Control command(const motion::ControllerOutput& out) {
    Control control;
    ObjectControl& robot = control.objects[robot_name_];
    robot.list = CommandList::Values;
    robot.values.resize(joints_.size());
    const control::JointState& joints = state_.machine.joints;
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      robot.values[static_cast<std::size_t>(joints_[j].control)] = joints_[j].is_position ? joints.q[k] : joints.qd[k];
    }
    if (has_vacuum_) robot.events[settings_.vacuum_event] = out.io.vacuum;
    if (has_blow_off_) robot.events[settings_.blow_off_event] = out.io.blow_off;
    feed(out, control);
    return control;
  }

  /// A box comes when the program starts toward it. The first command names all boxes: whoever does brings them.
  void feed(const motion::ControllerOutput& out, Control& control) {
    if (fed_ >= 0) control.objects[boxes_[static_cast<std::size_t>(fed_)]].events[kFeedEvent] = false;
    fed_ = -1;
    if (result_.ticks == 0) {
      for (const std::string& box : boxes_) {
        if (!box.empty()) control.objects[box].events[kFeedEvent] = false;
      }
    }
    if (out.departed < 0 || boxes_.empty()) return;
    const auto& rows = plan_.program.waypoints;
    const auto row = static_cast<std::size_t>(out.departed);
    const int item = cell::find_item(*settings_.sequence, rows[row].name, "PrePick");
    if (item < 0 || boxes_[static_cast<std::size_t>(item)].empty()) return;
    const std::string& box = boxes_[static_cast<std::size_t>(item)];
    if (is_present(box)) return;
    const int quarter = cell::choose_quarter(scenario_, settings_.sequence->items[static_cast<std::size_t>(item)],
                                             cell::next_pick(plan_.program, out.departed));
    Named<bool>& events = control.objects[box].events;
    events[kFeedEvent] = true;
    events[kQuarterTurnEvent] = quarter % 2 == 1;
    events[kHalfTurnEvent] = quarter >= 2;
    fed_ = item;
  }

  bool is_present(const std::string& box) const {
    const auto object = result_.last.objects.find(box);
    if (object == result_.last.objects.end()) return false;
    const auto sensor = object->second.sensors.find(kPresentSensor);
    return sensor != object->second.sensors.end() && !sensor->second.empty() && sensor->second.front().is_active;
  }

  struct JointPlace {
    int control = 0, sensor = 0;  ///< in the lists of the simulator
    bool is_position = false;
  };

  Client& client_;
  const model::Scenario& scenario_;
  const cell::CellArm& arm_;
  const motion::PreparedProgram& plan_;
  const ProgramClientSettings& settings_;
  Handshake handshake_;
  const ObjectDescription* robot_ = nullptr;
  std::string robot_name_;
  std::vector<JointPlace> joints_;  ///< in the order of the arm
  std::vector<std::string> boxes_;  ///< objects of the sequence's items; empty for those that cannot be brought
  bool has_vacuum_ = false, has_blow_off_ = false;
  int fed_ = -1;  ///< item that the last command brought
  control::JointMotion measured_;
  cell::ArmState state_;
  motion::ControllerState program_;
  control::JointControllerWork work_;
  ProgramClientResult result_;
};

}  // namespace

ProgramClientResult run_program(Client& client, const model::Scenario& scenario, const cell::CellArm& arm,
                                const motion::PreparedProgram& plan, const ProgramClientSettings& settings) {
  return ProgramClient(client, scenario, arm, plan, settings).run();
}

}  // namespace snug::click
