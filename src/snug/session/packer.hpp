// Packer: brings one item in: look, plan, rehearse, send, look, and what is done when that goes wrong.
#pragma once

#include <future>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "snug/plant/event.hpp"
#include "snug/session/reach.hpp"
#include "snug/session/session.hpp"

namespace snug::session {

/// A box that was packed before and was taken out and packed once more.
struct Repacked {
  packing::Placement planned;
  Pose X_TP;  ///< where it was seen (or is believed to be) then
};

/// An item and who decides where it goes.
struct ComingItem {
  int item = 0;
  packing::Agent* agent = nullptr;  ///< asked while the tool moves, in a thread of its own
};

class Packer {
 public:
  /// Throws InputError for an unknown sequence and for scenarios that cannot be packed.
  Packer(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options,
         plant::Plant& plant);

  [[nodiscard]] const std::vector<packing::Item>& items() const { return items_; }
  [[nodiscard]] const skills::CellLayout& layout() const { return layout_; }
  [[nodiscard]] const Belief& belief() const { return belief_; }
  /// What is believed to be in the container.
  [[nodiscard]] packing::ContainerState container_state() const;

  /// It is seen over the rim, beyond a wall, or not in the container at all.
  [[nodiscard]] bool is_seen_outside(const std::string& id) const;
  /// Nothing is believed of where it is: its place was seen and is empty, or it was let go unseen.
  [[nodiscard]] bool is_gone(const std::string& id) const { return !belief_.box(index_of(id)); }
  /// It was packed before and was returned to the aligner.
  [[nodiscard]] bool was_returned(const std::string& id) const { return returned_.contains(index_of(id)); }
  /// The items that bring_in will be called with, one after the other. While the tool leaves an item that came to its
  /// place as planned, the one that follows is brought, seen and planned.
  void expect(std::vector<ComingItem> coming) { coming_ = std::move(coming); }
  /// Everything for one item, from its arrival to what became of it.
  [[nodiscard]] ItemReport bring_in(int item, packing::Agent& agent);
  /// The tool back at its start, or why it did not get there.
  [[nodiscard]] SessionFailure go_home();

  /// Since the last call.
  [[nodiscard]] std::vector<Repacked> take_repacked() { return std::exchange(repacked_, {}); }

  /// Items without a place that may still be skipped; below 0: more had none.
  [[nodiscard]] int skips_left() const { return skips_left_; }
  /// Set when nothing more can be done.
  [[nodiscard]] std::optional<StopReason> stop_reason() const { return stop_reason_; }
  [[nodiscard]] const motion::Program& sent() const { return sent_; }
  [[nodiscard]] double time() const { return robot_.time; }

 private:
  struct Planned {
    Attempt attempt;
    skills::PlannedBox box;
  };
  /// What a plan came to; no value: no place.
  using PlanResult = std::optional<Planned>;
  /// The next item: brought while the tool left the one before.
  struct Ahead {
    Ahead(int which, const std::string& id) : item(which) { report.id = id; }
    int item;
    ItemReport report;
    plant::Feedback robot;  ///< where it will stand
    double since = 0.0;     ///< s, of the plant
    bool is_seen = false;   ///< as what was to come
    std::future<PlanResult> planning;
    std::optional<PlanResult> planned;
  };
  /// The motion with which an item comes to its place, and what is done while the tool leaves it: the boxes are
  /// perceived; where it went as planned the next item is brought, perceived, and its planning begun.
  struct Leaving {
    enum class Stage { Inserts, PerceivesItem, BringsNext, PerceivesNext, Done };
    int item = 0;
    const Attempt& attempt;
    const std::vector<std::optional<Pose>>& before;
    ItemReport& report;
    motion::WaypointIndex waypoint;  ///< of the motion: over the box that was let go
    Stage stage = Stage::Inserts;
  };
  void look_ahead(Leaving& leaving, const plant::Event& event);
  void bring_next(Leaving& leaving, const perception::Observation& seen);
  void plan_next(const Attempt& attempt, const perception::Observation& seen, double time);
  /// Whether a look told what it was to, and nothing new; then it is believed.
  [[nodiscard]] bool take_in_if_plain(const perception::Observation& seen, const ItemReport& report);
  /// The motion has ended.
  void finish_planning_ahead();
  /// None where it is not known, or the item is not to be followed by another.
  [[nodiscard]] const ComingItem* follower_of(int item) const;
  /// Where the tool goes when the item is at its place: there the next one, as it is expected, would be picked if the
  /// container were `state` then. None: it stays over the box.
  [[nodiscard]] std::optional<Pose> tool_after(int item, const packing::ContainerState& state) const;
  /// What one look told.
  void take_in(const perception::Observation& seen, const ItemReport& report);
  /// Another one came, by its size.
  [[nodiscard]] bool is_wrong(int item) const;
  /// Then the report says so.
  void refuse(int item, ItemReport& report) const;
  [[nodiscard]] int index_of(const std::string& id) const;
  /// `stays`: the tool does not leave for a picture that something blocks.
  void look(ItemReport& report, bool stays = false);
  /// One that tells something, if there is any; troubles with that are in the report.
  [[nodiscard]] perception::Observation take_picture(std::span<const perception::Expectation> expected, bool stays,
                                                     ItemReport& report);
  /// m, the largest difference of the edges from what the scenario says of the item.
  [[nodiscard]] double size_off(int item) const;
  void move_home(ItemReport& report);
  /// Extents in T of what is in the container beside boxes.
  [[nodiscard]] std::vector<packing::Extent> obstacle_extents() const;
  /// An obstacle lies on the box: it is neither picked nor pressed on.
  [[nodiscard]] bool is_under_obstacle(int item) const;
  [[nodiscard]] Location locate(int item) const;
  [[nodiscard]] bool can_be_picked(int item) const;
  /// m, over the inner floor of the container: the highest point of all obstacles and of all boxes but `item` (-1: of
  /// all), those that were left outside too: what is carried passes over it.
  [[nodiscard]] double obstacle_top(int item) const;
  [[nodiscard]] cell::ContainerFit fit_of(int item, const Pose& X_WP) const;
  /// `robot`: where the tool will be.
  [[nodiscard]] PlanResult plan(int item, packing::Agent& agent, const plant::Feedback& robot, ItemReport& report);
  /// `candidates`: in the order in which they are tried.
  [[nodiscard]] std::optional<Attempt> best_attempt(const RehearsalTask& task, double least_percent,
                                                    const std::vector<packing::Candidate>& candidates,
                                                    ItemReport& report);
  /// In the end, when the item stays where it lies in the container; nothing: the agent does not know, or it may not.
  [[nodiscard]] std::optional<double> expected_percent(int item, packing::Agent& agent) const;
  /// Percent of the container that is expected more with the item in the best other place; 0 where that is not known.
  [[nodiscard]] double gain_elsewhere(int item, packing::Agent& agent) const;
  /// In the container without it.
  [[nodiscard]] packing::ContainerState state_without(int item) const;
  /// How it stands now, as the agent counts.
  [[nodiscard]] packing::Item item_as_it_stands(int item) const;
  /// A box that stands somewhere, to be brought to a place.
  struct Standing {
    int item = 0;
    Pose X_WP;
    Location location = Location::Aligner;
  };
  [[nodiscard]] std::optional<GraspOutline> outline_of(const Standing& box,
                                                       const packing::Orientation& orientation) const;
  /// Percent of the container that turning the box for a place costs.
  [[nodiscard]] double cost_of(const Standing& box, const packing::Placement& placement) const;
  /// By what is expected of them, less what turning the box costs.
  void sort(const Standing& box, std::vector<packing::Candidate>& candidates) const;
  [[nodiscard]] double utility_of(const packing::Candidate& candidate, double rate, double cost) const;
  [[nodiscard]] bool is_enough(const std::optional<Attempt>& best, int attempts) const;
  void submit(const std::string& id, std::vector<motion::Waypoint> waypoints, const plant::Guards& guards,
              ItemReport& report, Leaving* leaving = nullptr);
  /// Stage by stage. False when the box was let go on the way and does not stand where the plan needs it.
  [[nodiscard]] bool send(const Attempt& attempt, const std::vector<std::optional<Pose>>& before, ItemReport& report);
  /// The box met more than it should on the way to its place.
  [[nodiscard]] bool was_stopped_by_load() const;
  /// rad, from standing on a face in the container, turned about the vertical as it may be.
  [[nodiscard]] double tilt_of(int item) const;
  [[nodiscard]] Trouble assess(int item, const packing::Placement& planned,
                               const std::vector<std::optional<Pose>>& before, ItemReport& report) const;
  [[nodiscard]] int who_sticks_out(int item) const;
  /// Of the others that were moved beyond the limit the highest: it may lie on the rest. -1: none was.
  [[nodiscard]] int who_was_moved(int item, const std::vector<std::optional<Pose>>& before) const;
  /// Higher than it was by more than the limit of displacements: it lies on others.
  [[nodiscard]] bool was_lifted(int item, const std::vector<std::optional<Pose>>& before) const;
  /// m, as it was seen, less what the look may be off.
  [[nodiscard]] double moved(int item, const std::vector<std::optional<Pose>>& before) const;
  /// The vacuum says that something hangs from the cup.
  [[nodiscard]] bool is_holding() const;
  /// The tool straight up, vacuum off.
  void retreat(const std::string& id, ItemReport& report);
  /// Until nothing is wrong, or nothing more can be done. True: the item is to be planned once more.
  [[nodiscard]] bool recover(int item, const Planned& planned, std::vector<std::optional<Pose>> before,
                             packing::Agent& agent, ItemReport& report);
  /// Look and compare, after a retreat where the motion did not end as it should.
  [[nodiscard]] Trouble find_trouble(int item, const packing::Placement& planned,
                                     const std::vector<std::optional<Pose>>& before, ItemReport& report);
  [[nodiscard]] Situation situation_of(int item, Trouble trouble, packing::Agent& agent, const ItemReport& report);
  void resume(const std::string& id, ItemReport& report);
  void press(int item, ItemReport& report);
  /// How a box hangs from the cup and how it is to stand.
  struct Carried {
    skills::PlannedBox box;
    Matrix3 R_WP;  ///< put down like that
    Pose X_PS;     ///< lip on it
    std::optional<motion::Swing> swing;
  };
  /// After `rows`, at whose end it hangs from the cup: the box to `place`.
  void put_down(const Carried& carried, const skills::FlipPlace& place, std::vector<motion::Waypoint> rows,
                ItemReport& report);
  /// Straight up from where the tool is, with the held box.
  [[nodiscard]] motion::Waypoint lift(const Carried& carried) const;
  /// The held box, as it hangs for `planned`, to the bench.
  void set_down(const Planned& planned, ItemReport& report);
  /// Back to the aligner: held as it hangs for `planned`, or picked where it lies.
  void return_to_aligner(int item, const Planned* planned, ItemReport& report);
  [[nodiscard]] bool can_return(int item) const;
  /// A pick of the box where it lies or leans, so that it can be put down like R_WP.
  [[nodiscard]] std::vector<motion::Waypoint> plan_pick_to_return(int item, const Matrix3& R_WP) const;
  /// How a box that lies or leans is put down to the aligner.
  [[nodiscard]] Matrix3 rotation_at_aligner(int item) const;
  /// Another box, that sticks out or was moved, once more: to a place that is planned anew.
  /// False: no way was found, and nothing was moved.
  bool repack(int item, packing::Agent& agent, ItemReport& report);
  [[nodiscard]] std::optional<Pose> pose_of(int item) const;  ///< X_WP, as believed
  [[nodiscard]] std::vector<std::optional<Pose>> believed_poses() const;
  /// Plan, send, look, recover, until it is packed or given up. `ready`: a plan that is made already.
  void bring_to_place(int item, packing::Agent& agent, std::optional<PlanResult> ready, ItemReport& report);
  [[nodiscard]] bool is_handled(int item) const;
  void give_up(int item, Trouble trouble, ItemReport& report);
  /// No motion is planned for it any more: one that was moved before stays where it lies.
  void leave(int item, ItemReport& report) const;

  model::Scenario scenario_;
  SessionOptions options_;
  settings::PlaceLimits limits_;  ///< of the motions that are done: fast or not
  plant::Plant& plant_;
  skills::CellLayout layout_;
  ToolReach reaches_;
  Belief belief_;
  std::vector<packing::Item> items_;
  std::vector<int> order_;            ///< items that were sent, in that order
  std::vector<std::string> skipped_;  ///< items that came and are not packed
  int skips_left_;                    ///< below 0: more items had no place than may be skipped
  std::set<int> left_out_;            ///< of them, those that stick out and that nothing more is done about
  std::vector<Repacked> repacked_;
  std::vector<int> handled_;  ///< under way now: the item that came, and boxes that are packed anew because of it
  std::set<int> returned_;    ///< packed before, and returned to the aligner
  int let_go_ = -1;           ///< item that fell, or was let go, before its motion ended: to be found at the next look
  std::vector<ComingItem> coming_;
  std::optional<Ahead> ahead_;
  plant::Feedback robot_;
  motion::Program sent_;
  std::vector<motion::Waypoint> last_;  ///< motion
  std::optional<StopReason> stop_reason_;
};

}  // namespace snug::session
