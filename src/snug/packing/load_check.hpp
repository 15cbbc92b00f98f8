// check_finished_load: whether a finished load is one: every box level, inside, supported, and carrying what it may.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "snug/packing/container_state.hpp"

namespace snug::packing {

/// How far soft surfaces give way: a face of `full_area` or more by `per_force` under each newton, a smaller one by
/// more in proportion. Both 0: rigid.
struct Give {
  double per_force = 0.0;  ///< m/N
  double full_area = 0.0;  ///< m^2
  bool operator==(const Give&) const = default;
};

/// What is asked of every box of a finished load.
struct LoadLimits {
  double tilt = 0.105;       ///< rad, from standing on a face
  double outside = 0.005;    ///< m, beyond a wall (of a pallet: its edge)
  double above = 0.005;      ///< m, over the rim
  double min_support = 0.3;  ///< part of the lower face over something that is near enough
  /// m, between the lower face and what carries it, and under the floor: boxes give way and are seen with errors.
  double support_slack = 0.010;
  /// Where boxes stand on the floor and on each other. A box may sink by `support_slack` and by twice what its weight,
  /// with all that it carries, presses its face in: so deep is the edge of a face whose far edge just bears.
  Give on_floor, on_box;
  double load_slack = 0.02;  ///< part of `max_load` that may be exceeded: masses are known to a few percent
};

enum class LoadFault { Leans, Outside, Unsupported, Overloaded };
[[nodiscard]] const char* name_of(LoadFault fault);

struct LoadFinding {
  std::string item;  ///< id
  LoadFault fault = LoadFault::Leans;
  double value = 0.0;  ///< rad, m, part of the face, kg
  double limit = 0.0;  ///< the same
  bool operator==(const LoadFinding&) const = default;
};
/// "leans by 27.6 degrees (6.0 are allowed)".
[[nodiscard]] std::string describe(const LoadFinding& finding);

/// By how much the pose of a box may be off: it fails only by more than that.
struct PoseDoubt {
  double position = 0.0;  ///< m
  double angle = 0.0;     ///< rad
};

/// Every box that fails, with its first fault in the order of LoadFault; in the order of the state. Support and loads
/// count boxes by their upright extents: of a box that leans its neighbours are judged as if it stood. `doubts`: box by
/// box, or none.
[[nodiscard]] std::vector<LoadFinding> check_finished_load(const ContainerState& state, const LoadLimits& limits,
                                                           std::span<const PoseDoubt> doubts = {});

/// kg that rest on each box, those that stand on others included: masses go down through the areas that they share.
[[nodiscard]] std::vector<double> loads_on(const ContainerState& state, double support_slack);

/// How far the whole is from moving when what carries it accelerates level: the least over all boxes of the
/// acceleration, m/s^2, at which one tips or, with this friction, slides, where nothing beside it holds it. Beside a
/// box that is as high, or a wall, within `gap` [m] of it counts as held. A proxy of `snug shake`: no dynamics.
/// Infinite for no boxes.
[[nodiscard]] double least_level_acceleration(const ContainerState& state, double friction, double gap);

}  // namespace snug::packing
