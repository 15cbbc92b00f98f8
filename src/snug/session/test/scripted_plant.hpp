// ScriptedPlant: a plant without physics, and sessions that pack it: motions end as a test says, looks show what it put
// there.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "snug/model/test/shortened.hpp"
#include "snug/plant/event.hpp"
#include "snug/session/session.hpp"

namespace snug::session::test {

/// BOX027 and BOX028.
inline const model::Scenario& two_boxes() {
  static const model::Scenario one = model::test::shortened(2);
  return one;
}

/// Motions that hold a box end as the script says.
class ScriptedPlant : public plant::Plant {
 public:
  using EndReason = plant::EndReason;

  std::deque<EndReason> ends;                ///< of motions with the vacuum on; when they are used up: Completed
  std::map<std::string, Pose> visible;       ///< X_WP
  std::set<std::string> missing;             ///< seen to be nowhere
  std::function<void(int motion)> happens;   ///< after each of those motions, from 1; may be empty
  std::vector<std::string> pressed;          ///< items that were pressed on from above
  std::function<void()> when_pressed;        ///< may be empty
  std::deque<perception::LookFault> faults;  ///< of looks; when they are used up: none
  std::string trouble;                       ///< of looks without a frame
  std::optional<Vector3> size;               ///< measured of what stands at the aligner
  std::map<std::string, Vector3> sizes;      ///< the same of single items
  std::optional<std::vector<perception::Obstacle>> obstacles;  ///< of every look
  Pose X_WE_let_go;                                            ///< of the last motion with the vacuum on
  int home_count = 0;                                          ///< motions that do nothing but go home
  std::deque<EndReason> retreat_ends;                          ///< of retreats; when they are used up: Completed
  std::deque<EndReason> home_ends;                             ///< of motions home; the same
  std::string item;                                            ///< of the last motion
  int acknowledged = 0;
  std::set<std::string> not_brought;            ///< items that do not come
  std::vector<std::string> brought;             ///< in their order
  std::vector<std::string> brought_on_the_way;  ///< those of them that came while a motion passed a waypoint
  bool passes = false;                          ///< does what motions are to do on passing, where they complete
  /// Ends the motion then, though what was to be done on passing was done; once.
  std::optional<EndReason> ends_after_passing;
  std::vector<plant::Motion> motions;  ///< that were sent
  /// Motions that do not complete end on the way to the first waypoint of this class; else at the first with vacuum.
  std::optional<motion::MotionClass> ends_at;

  /// What the sensors say before anything moves.
  [[nodiscard]] plant::Feedback& sensors() { return now_; }

  [[nodiscard]] plant::Description describe() const override { return {"scripted", {}}; }
  [[nodiscard]] plant::Feedback read() override { return now_; }
  [[nodiscard]] bool is_moving() const override { return ending_.has_value(); }
  [[nodiscard]] bool bring(const model::ParcelId& id) override {
    if (not_brought.contains(id.value)) return false;
    brought.push_back(id.value);
    if (is_moving()) brought_on_the_way.push_back(id.value);
    events_.push_back({now_.time, plant::ItemArrived{id}});
    return true;
  }
  [[nodiscard]] std::vector<plant::Event> advance() override {
    if (events_.empty() && ending_) {
      events_.push_back({now_.time, plant::MotionEnded{*std::exchange(ending_, std::nullopt)}});
    }
    return std::exchange(events_, {});
  }
  void cancel() override {
    if (ending_) ending_->end = now_.end = {EndReason::Cancelled, std::nullopt, 0.0, 0.0, ""};
  }
  void acknowledge() override { ++acknowledged; }

  void start(const plant::Motion& motion) override {
    motions.push_back(motion);
    const auto held = std::ranges::find_if(motion.waypoints, [](const auto& row) { return row.io.vacuum; });
    const bool holds = held != motion.waypoints.end();
    item = motion.item.value;
    const bool is_retreat = motion.waypoints.back().variant == "_retreat", is_home = motion.item.empty();
    const EndReason end = holds        ? next(ends)
                          : is_retreat ? next(retreat_ends)
                          : is_home    ? next(home_ends)
                                       : EndReason{};
    for (const motion::Waypoint& row : motion.waypoints) {
      if (row.variant == "_press" && row.motion_class == motion::MotionClass::PlaceSlow) pressed.push_back(item);
    }
    const bool is_press = motion.guards.force && !motion.guards.vacuum;
    if (is_press && when_pressed) when_pressed();
    if (is_home) ++home_count;
    auto last = end == EndReason::Completed || !holds ? motion.waypoints.end() - 1 : held;
    if (end != EndReason::Completed && ends_at) {
      const auto found = std::ranges::find(motion.waypoints, *ends_at, &motion::Waypoint::motion_class);
      if (found != motion.waypoints.end()) last = found;
    }
    if (holds) X_WE_let_go = last->X_WE;
    now_.time += 1.0;
    const auto reached = ends_at && end != EndReason::Completed ? last - motion.waypoints.begin() : 0;
    now_.end = {end, motion::WaypointIndex(static_cast<int>(reached)), 0.0, 0.0, ""};
    now_.X_WE = last->X_WE;
    now_.io = last->io;
    now_.pressure_gauge = last->io.vacuum && end != EndReason::NoSeal && end != EndReason::VacuumLost ? -6.0e4 : 0.0;
    now_.times.assign(1, {1.0, 0.0});
    if (holds && happens) happens(++motion_count_);
    if (passes && end == EndReason::Completed && motion.perceive_after) {
      events_.push_back({now_.time, plant::WaypointPassed{*motion.perceive_after}});
      if (ends_after_passing) {
        now_.end = {*std::exchange(ends_after_passing, std::nullopt), motion::WaypointIndex(), 0.0, 0.0, ""};
      }
    }
    ending_ = now_;
  }

  void perceive(std::span<const perception::Expectation> expected) override {
    perception::Observation seen;
    seen.time = now_.time;
    seen.obstacles = obstacles;
    if (!faults.empty()) {
      seen.fault = faults.front();
      if (seen.fault == perception::LookFault::NoFrame) seen.trouble = trouble;
      faults.pop_front();
    }
    for (const perception::Expectation& one : expected) {
      const auto own = sizes.find(one.item);
      if (size || own != sizes.end()) {
        seen.seen.push_back({one.item, *one.X_WP, Matrix6::Zero(), own != sizes.end() ? own->second : size, 0.0});
        continue;
      }
      if (const auto found = visible.find(one.item); found != visible.end()) {
        seen.seen.push_back({one.item, found->second, Matrix6::Zero(), {}, 0.0});
        continue;
      }
      seen.not_seen.push_back(one.item);
      if (missing.contains(one.item)) seen.missing.push_back(one.item);
    }
    events_.push_back({now_.time, plant::Perceived{seen}});
  }

 private:
  static EndReason next(std::deque<EndReason>& script) {
    if (script.empty()) return EndReason::Completed;
    const EndReason end = script.front();
    script.pop_front();
    return end;
  }

  plant::Feedback now_ = [] {
    plant::Feedback start;
    start.X_WE = two_boxes().controller.X_WE_start;
    return start;
  }();
  int motion_count_ = 0;
  std::vector<plant::Event> events_;
  std::optional<plant::Feedback> ending_;  ///< of the motion under way
};

inline SessionOptions quick_options() {
  SessionOptions options;
  options.agent = "margin";
  options.samples = 0;
  return options;
}

/// It was done about this trouble of this item.
inline bool has(const ItemReport& item, Trouble trouble, Remedy remedy) {
  return std::ranges::any_of(item.recoveries,
                             [&](const Recovery& one) { return one.trouble == trouble && one.remedy == remedy; });
}

}  // namespace snug::session::test
