// Waypoint, Program: where the tool goes and what it switches.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/motion/tracking.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::motion {

/// The six switches of a row. They act when the tool departs toward the row, not when it arrives.
struct IO {
  bool vacuum = false;
  bool blow_off = false;
  bool conveyor_cw = false;
  bool conveyor_ccw = false;
  bool optitrack = false;
  bool reserved = false;
  bool operator==(const IO&) const = default;
};

/// What the tool does at a waypoint. In files the name of a waypoint begins with its class (waypoint_name.hpp).
enum class MotionClass {
  Other,       ///< names that begin with none of these words
  Home,        ///< `home`: where the tool waits
  PrePick,     ///< above, or before, a box where it arrives
  Pick,        ///< `Box`: onto that box
  PostPick,    ///< up with it
  PreRePick,   ///< as of a pick, of a box that was set down on the way
  RePick,      ///< onto it
  PostRePick,  ///< up with it
  PreTwist,    ///< to and from a flat surface where boxes are turned
  Twist,       ///< onto it, turned over an edge
  TwistDrag,   ///< let go on the way
  PrePlace,    ///< over the place
  Place,       ///< down to it
  PlaceSlow,   ///< pushed, slowly
  PostPlace,   ///< up, the box let go
};
/// The word that names of this class begin with; empty for Other.
[[nodiscard]] std::string_view name_of(MotionClass motion_class) noexcept;
/// Whether a waypoint of this class is brought about in contact: picks, places, twists. The others touch nothing.
[[nodiscard]] bool is_contact(MotionClass motion_class) noexcept;

/// How a box is carried that hangs from the cup: its two longest periods, s, 0.01 to 9.99, and at which fraction of the
/// tempo, 0.01 to 1. A file keeps hundredths.
struct Swing {
  double slow = 0.0;
  double fast = 0.0;
  double pace = 1.0;
  bool operator==(const Swing&) const = default;
};

/// The latest instant that a waypoint may wait for, s.
inline constexpr double kLatestDeparture = 7200.0;

struct Waypoint {
  Pose X_WE;  ///< tool frame E (gripper end, z toward the package)
  MotionClass motion_class = MotionClass::Other;
  std::string item;        ///< id of the box that it is for; empty: for none
  bool item_is_id = true;  ///< false: as a file of the demonstrator has it, such as 027: fit_of (waypoint_name.hpp)
  std::string variant;     ///< what tells it from others of its class and item, such as _2; of Other the whole name
  /// Of the box that hangs on the way to it. Fast motions leave nothing of these swings: they are averaged over the
  /// slow one, and half of them comes half the fast one later (straight down to its place: half the slow one).
  std::optional<Swing> swing;
  /// s since the program's start: the tool stands at the waypoint before until then. 0.001 to kLatestDeparture; a file
  /// keeps milliseconds.
  std::optional<double> not_before;
  IO io;
  int line = 0;  ///< in the file it was read from, from 1; 0: made by the program itself

  bool operator==(const Waypoint&) const = default;
};

[[nodiscard]] Waypoint make_waypoint(MotionClass motion_class, std::string_view item, const Pose& X_WE,
                                     const IO& io = {}, std::string_view variant = {});

struct Program {
  std::string name;  ///< file or label, for messages
  std::vector<Waypoint> waypoints;
  Tracking tracking = {};  ///< for which it was made
  std::string robot = {};  ///< name of the robot through whose joints it was sent; empty: none, or not said
  bool operator==(const Program&) const = default;
};

/// "file:line" of a waypoint, or "file row N" (from 1) for one that was not read from a file.
[[nodiscard]] std::string place_of(const Program& program, std::size_t row);

}  // namespace snug::motion
