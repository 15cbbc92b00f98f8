// What a viewer draws of a recording: bodies and cup as foxglove.SceneUpdate. Internal to the module.
#pragma once

#include <cstdint>

#include "snug/record/recording.hpp"
#include "snug/replay/internal/mcap_messages.hpp"
#include "snug/replay/internal/robot_look.hpp"

namespace snug::replay::internal {

/// All bodies that are there in `frame`, each fixed to the frame of its name, in the place of all drawn before.
/// Not those that have a look of their own.
[[nodiscard]] Json scene_message(std::uint64_t ns, const record::RecordingHeader& header, const record::Frame& frame,
                                 const std::vector<LinkLook>& looks = {});

/// The links of the robot as they look, each fixed to the frame of its body.
[[nodiscard]] Json robot_message(std::uint64_t ns, const record::RecordingHeader& header,
                                 const std::vector<LinkLook>& looks);

/// What the drawing of the cup needs beside the frame.
struct CupLook {
  double lip_radius = 0.0;   ///< m
  double free_length = 0.0;  ///< m, E to S when nothing is held
};

/// The cup from E to its lip, as it is bent and stretched, in E.
[[nodiscard]] Json cup_message(std::uint64_t ns, const CupLook& look, const record::CupSample& cup);

}  // namespace snug::replay::internal
