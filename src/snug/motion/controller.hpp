// Controller: runs a Program on the tool frame, one tick at a time: as the demonstrator did, or as it should have.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "snug/motion/fast_settings.hpp"
#include "snug/motion/limits.hpp"
#include "snug/motion/lspb.hpp"
#include "snug/motion/tool_path.hpp"
#include "snug/motion/tracking.hpp"
#include "snug/motion/waypoint.hpp"

namespace snug::motion {

/// A program under way for longer than this does not end, s.
inline constexpr double kLongestProgram = kLatestDeparture;
/// What boxes that still move are given after the last waypoint, s.
inline constexpr double kSettleTime = 1.0;

struct ControllerSettings {
  Tracking tracking;
  double tick = 0.008;                       ///< s
  double task_stiffness = 10.0;              ///< 1/s^2 (lagged)
  double vacuum_wait = 0.5;                  ///< s, hold after the vacuum changed or the blow-off was switched on
  double convergence_deg_per_metre = 500.0;  ///< degrees of orientation error that weigh as much as one metre
  bool sampled_coast = true;                 ///< lagged: LspbSegment::with_sampled_coast; lengthens a program by ~1 %
  FastSettings fast;                         ///< fast only
  std::vector<NamedLimits> limits;
  bool operator==(const ControllerSettings&) const = default;
};

/// A program with everything looked up and checked, so that a tick can neither fail nor allocate.
struct PreparedProgram {
  Program program;
  ControllerSettings settings;
  std::vector<MotionLimits> row_limits;     ///< one per waypoint
  std::vector<Pose> X_WE;                   ///< one per waypoint
  std::vector<Smoothing> held_smoothing;    ///< fast, one per waypoint: as its swing says, or the settings
  const PathLimits* path_limits = nullptr;  ///< fast: what the joints allow; not owned; none: not limited by them
};

/// Throws InputError for an unknown waypoint name, an empty program, and settings or limits out of range.
[[nodiscard]] PreparedProgram prepare(Program program, ControllerSettings settings);

enum class ControllerPhase {
  Ready,
  Waiting,   ///< for the vacuum, before it moves to the waypoint aimed at
  Moving,    ///< to it
  Standing,  ///< at it, until the next may begin (Waypoint::not_before)
  Finished,
};

/// All that changes from tick to tick. Copying it is a snapshot.
struct ControllerState {
  ControllerPhase phase = ControllerPhase::Ready;
  int row = -1;                  ///< the waypoint aimed at (or last reached, when finished); -1 before the first
  std::int64_t tick_count = 0;   ///< ticks since the start; time is tick_count * tick
  std::int64_t phase_ticks = 0;  ///< ticks since the present phase began
  IO io;                         ///< commanded now
  Pose X_WE_departure;           ///< where the tool was when it left the row before: the segment's start
  LspbSegment segment;           ///< toward `row`; not yet set while waiting
  Pose X_WE_reference;           ///< what the task follows
  ToolState command;             ///< at the end of the last tick
  // fast only:
  PacedSegment paced;                        ///< toward `row`
  PacedSegment tail;                         ///< the rest of the motion before, where they are blended
  std::int64_t tail_ticks = 0;               ///< since the tail began
  bool was_felt = false;                     ///< the row before ended by a force
  Vector3 force_before_W = Vector3::Zero();  ///< N, felt when the motion to `row` began
  double hold_factor_before = std::numeric_limits<double>::infinity();  ///< Sensed::hold_factor then
  Sensed sensed;  ///< at the end of the last tick; whoever moves the tool puts it here
  bool operator==(const ControllerState&) const = default;
};

struct ControllerOutput {
  ToolState tool;       ///< commanded, at the end of the coming tick
  Pose X_WE_reference;  ///< what the task followed (recordings)
  IO io;                ///< from the start of the coming tick
  ControllerPhase phase = ControllerPhase::Ready;
  int row = -1;               ///< aimed at
  int reached = -1;           ///< row found reached at the start of this tick, -1 if none
  int departed = -1;          ///< row whose IO took effect at the start of this tick, -1 if none; equals `row` then
  bool finished_now = false;  ///< the last row was reached at the start of this tick
};

/// The state before the first tick, tool at rest.
[[nodiscard]] ControllerState make_controller_state(const Pose& X_WE_start) noexcept;

/// One tick. `measured`: the tool at its start; a tool that follows exactly is measured where the last tick put it.
/// After the last row the tool stays (exact) or settles (lagged) on it.
[[nodiscard]] ControllerOutput tick(const PreparedProgram& plan, const ToolState& measured,
                                    ControllerState& state) noexcept;

/// Whether a tick from here would find the last row reached and end the program.
[[nodiscard]] bool will_finish(const PreparedProgram& plan, const ToolState& measured,
                               const ControllerState& state) noexcept;

/// |position error| + angle / (convergence_deg_per_metre), m: what is compared with a row's precision.
[[nodiscard]] double convergence_error(const Pose& X_WE, const Pose& X_WE_target,
                                       double convergence_deg_per_metre) noexcept;

/// Whether the row may not begin yet.
[[nodiscard]] bool is_too_early(const PreparedProgram& plan, const ControllerState& state, int row) noexcept;

/// Duration of a program without any physics, the tool following exactly, s. Stops at `longest` seconds.
[[nodiscard]] double compute_duration(const PreparedProgram& plan, const Pose& X_WE_start, double longest = 3600.0);

}  // namespace snug::motion
