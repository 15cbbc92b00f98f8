// ItemEventLog: what became of every box: picked, flipped, re-picked, placed, lost; the answer of a run.
#pragma once

#include <string>
#include <vector>

#include "snug/cell/gripper.hpp"
#include "snug/record/recording.hpp"

namespace snug::cell {

enum class BoxState {
  Waiting,  ///< never left the aligner (or never came)
  Held,     ///< by the cup at the end
  Packed,   ///< rests in the container, inside its walls and not above its rim by more than the stated tolerances
  Outside,  ///< was released over the container but is not packed
  Dropped,  ///< lies somewhere else
  Lost,     ///< left the cell
};
[[nodiscard]] const char* name_of(BoxState state);

/// A box counts as packed with corners at most this far beyond the inner walls and above the rim, m. Boxes and tote
/// give way (docs/scenario.md, contact stiffness), and a B3 on its long edge stands 9 mm over the rim of the report.
inline constexpr double kPackedBeyondWall = 0.005;
inline constexpr double kPackedAboveRim = 0.012;

/// How far a box reaches out of a container.
struct ContainerFit {
  double outside = 0.0;    ///< m, farthest corner beyond the inner walls, 0 inside
  double above_rim = 0.0;  ///< m, highest corner over the rim, 0 below
  bool is_in = false;      ///< within the tolerances above, and its middle over the floor
};
[[nodiscard]] ContainerFit fit_in(const Vector3& inner_size, const Vector3& box_size, const Pose& X_TP);

struct BoxResult {
  std::string id;
  BoxState state = BoxState::Waiting;
  Pose X_TP;               ///< in the target container
  char up = 'Z';           ///< axis of the box nearest to vertical
  double outside = 0.0;    ///< m, farthest corner beyond the inner walls, 0 inside
  double above_rim = 0.0;  ///< m, highest corner over the rim, 0 below
  std::vector<record::Event> events;
};

/// A pick of a box that was set down before.
struct Repick {
  std::string id;
  double offset = 0.0;  ///< m, from the face's centre to where the waypoint aims
  char up_before = 'Z', up_after = 'Z', up_intended = 'Z';
};

/// Follows the boxes of a sequence through the events of the gripper.
class ItemEventLog {
 public:
  ItemEventLog() = default;
  ItemEventLog(const model::Scenario& scenario, const model::Sequence& sequence);

  void box_appeared(int item, double time);
  /// It was placed before the log began.
  void box_was_placed(int item);
  void box_removed(int item, double time);
  /// A body left the cell; one of the boxes or another.
  void body_lost(record::Event event);
  void add(const GripperEvent& event, double time, const CellWorld& world, const physics::WorldState& state,
           const Pose& X_WE, const std::string& waypoint);
  /// Something that concerns no box.
  void note(record::Event event) { events_.push_back(std::move(event)); }
  [[nodiscard]] const std::vector<record::Event>& events() const { return events_; }
  [[nodiscard]] const std::vector<Repick>& repicks() const { return repicks_; }
  /// What became of the items, in the order of the sequence; items that never appeared are left out.
  [[nodiscard]] std::vector<BoxResult> results(const CellWorld& world, const physics::WorldState& state,
                                               int held_body) const;

 private:
  struct Item {
    bool has_appeared = false;
    bool was_removed = false;
    bool was_lost = false;
    int seals = 0;
    bool was_held = false;
    bool was_set_down = false;    ///< let go by the program since the last seal
    bool over_container = false;  ///< at the last release
    int up_at_seal = 2;
    int up_intended = 2;  ///< at the last release, from the tool's pose
    Matrix3 R_EP = Matrix3::Identity();
    bool operator==(const Item&) const = default;
  };
  void log(double time, std::string kind, int item, std::string text, std::vector<record::EventNumber> numbers = {});
  void add_seal(int item, const GripperEvent& event, double time, const Matrix3& R_WP, const Matrix3& R_WE,
                const std::string& waypoint);
  void add_release(int item, const GripperEvent& event, double time, const Pose& X_WE, const Pose& X_WP);

  std::vector<std::string> ids_;
  std::vector<Vector3> sizes_;
  Pose X_WT_;
  Vector3 inner_size_ = Vector3::Zero();
  std::vector<Item> items_;
  std::vector<record::Event> events_;
  std::vector<Repick> repicks_;
};

}  // namespace snug::cell
