// Fast controller: one tick of our own programs: exact tracking, blends, rows and waits that end by what is felt.
#pragma once

#include "snug/motion/controller.hpp"

namespace snug::motion {

/// What the program does at the start of a tick, as `tick` does for the other controllers. `measured`: the tool then.
void advance_fast(const PreparedProgram& plan, const ToolState& measured, ControllerState& state,
                  ControllerOutput& output) noexcept;
/// Where the tool is to be at the end of the tick that begins now.
[[nodiscard]] ToolState sample_fast(const PreparedProgram& plan, const ControllerState& state) noexcept;
/// Whether the row aimed at is reached now.
[[nodiscard]] bool has_reached_fast(const PreparedProgram& plan, const ToolState& measured,
                                    const ControllerState& state) noexcept;
/// Throws InputError for settings out of range.
void check_fast(const FastSettings& settings, const std::string& where);

}  // namespace snug::motion
