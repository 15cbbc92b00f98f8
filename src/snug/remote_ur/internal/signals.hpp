// What the parts of RemoteUr share: whether a digital signal is on, how long a robot may take to brake.
#pragma once

#include <cstdint>
#include <optional>

#include "snug/model/robot_io.hpp"

namespace snug::remote_ur::internal {

inline constexpr double kLongestBraking = 1.0;  ///< s, then the robot counts as standing

/// Of the controller's bits of inputs or outputs; false for a signal that is not wired.
inline bool is_on(const std::optional<model::DigitalIo>& io, std::uint64_t bits) {
  return io && (((bits >> io->bit()) & 1U) != 0) != io->active_low;
}

}  // namespace snug::remote_ur::internal
