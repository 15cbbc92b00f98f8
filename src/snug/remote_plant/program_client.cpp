// ProgramClient: snug's own joint controller as a client of CLICK: a program through the joints of any simulator.
#include "snug/remote_plant/program_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/click/joint_link.hpp"
#include "snug/click/names.hpp"
#include "snug/cup/phases.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/record/csv.hpp"

namespace snug::remote_plant {
namespace {

using click::Client;
using click::Control;
using click::feel_of;
using click::JointLink;
using click::kFeedEvent;
using click::kHalfTurnEvent;
using click::kPresentSensor;
using click::kQuarterTurnEvent;
using click::Named;
using click::RobotFeel;

class ProgramClient {
 public:
  ProgramClient(Client& client, const model::Scenario& scenario, const cell::CellArm& arm,
                const motion::PreparedProgram& plan, const ProgramClientSettings& settings)
      : client_(client),
        scenario_(scenario),
        arm_(arm),
        plan_(plan),
        settings_(settings),
        link_(client, arm.model(),
              {settings.object, settings.vacuum_event, settings.blow_off_event,
               std::ranges::any_of(plan.program.waypoints, [](const auto& row) { return row.io.vacuum; })}) {}

  ProgramClientResult run() {
    const auto start = std::chrono::steady_clock::now();
    result_.failure = link_.connect(arm_.controller().settings().tick);
    result_.has_begun = result_.failure.empty();
    if (result_.has_begun) result_.failure = work();
    result_.last = link_.last();
    result_.simulated = result_.last.time;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    result_.wall = wall.count();
    return std::move(result_);
  }

 private:
  void find_boxes() {
    if (settings_.sequence == nullptr) return;
    for (const model::Item& item : settings_.sequence->items) {
      const std::string name = record::log_name(item.parcel);
      const auto found = link_.handshake().objects.find(name);
      const bool can_come = found != link_.handshake().objects.end() && found->second.events.contains(kFeedEvent);
      boxes_.push_back(can_come ? name : "");
    }
  }

  std::string work() {
    find_boxes();
    state_ = arm_.make_state(scenario_.seed, link_.measured().q);
    program_ = motion::make_controller_state(state_.machine.tool.X_WE);
    double end = motion::kLongestProgram;
    bool has_ended = false;
    while (link_.last().time < end) {
      const control::MachineTick tick = think();
      result_.row = std::max(0, tick.program.row);
      if (tick.outcome == control::Outcome::Stuck) {
        const motion::Waypoint& row = plan_.program.waypoints[static_cast<std::size_t>(result_.row)];
        const std::string text = fmt::format("stuck toward {} (row {})", motion::name_of(row), result_.row + 1);
        client_.report_error(text);
        return text;
      }
      std::string trouble = link_.send(command(tick.program));
      if (!trouble.empty()) return trouble;
      if (stands_still()) {
        const std::string text =
            fmt::format("the simulator's time stays at {} s: its answers to Controls showed no step for {} s", latest_,
                        settings_.patience);
        client_.report_error(text);
        return text;
      }
      feel();
      ++result_.ticks;
      if (!tick.program.finished_now || has_ended) continue;
      has_ended = true;
      result_.duration = link_.last().time;
      end = result_.duration + motion::kSettleTime;
    }
    if (!has_ended) return "the program did not end within two hours";
    return client_.reset();
  }

  /// Time that goes back does not go on.
  bool stands_still() {
    const auto now = std::chrono::steady_clock::now();
    if (link_.last().time > latest_ || result_.ticks == 0) {
      latest_ = link_.last().time;
      moved_ = now;
    }
    return std::chrono::duration<double>(now - moved_).count() > settings_.patience;
  }

  control::MachineTick think() {
    state_.machine.tool = control::tool_at(arm_.model(), link_.measured());
    return arm_.tick(plan_, program_, state_, work_);
  }

  /// What fast motions end by. A simulator that lacks a sensor of load or pressure tells the controller nothing.
  void feel() {
    const std::optional<RobotFeel> felt = feel_of(link_.last_of_robot());
    if (!felt) return;
    const Matrix3 R_WE = control::tool_at(arm_.model(), link_.measured()).X_WE.R;
    program_.sensed = {felt->pressure_gauge, R_WE * felt->F_E.force,
                       cup::sensed_hold_factor(scenario_.cup, felt->pressure_gauge, felt->F_E)};
  }

  Control command(const motion::ControllerOutput& out) {
    Control control;
    link_.command(state_.machine.joints, out.io, control);
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
    const motion::Waypoint& row = plan_.program.waypoints[static_cast<std::size_t>(out.departed)];
    if (row.motion_class != motion::MotionClass::PrePick) return;
    const int item = cell::find_item(*settings_.sequence, row);
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
    const auto object = link_.last().objects.find(box);
    return object != link_.last().objects.end() && is_active(object->second, kPresentSensor);
  }

  Client& client_;
  const model::Scenario& scenario_;
  const cell::CellArm& arm_;
  const motion::PreparedProgram& plan_;
  const ProgramClientSettings& settings_;
  JointLink link_;
  std::vector<std::string> boxes_;  ///< objects of the sequence's items; empty for those that cannot be brought
  double latest_ = 0.0;             ///< s, simulated, seen so far
  std::chrono::steady_clock::time_point moved_;  ///< when it was seen first
  int fed_ = -1;                                 ///< item that the last command brought
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

}  // namespace snug::remote_plant
