// FrameSource: where frames come from that no cell here renders.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "snug/camera/frame.hpp"
#include "snug/core/expected.hpp"

namespace snug::camera {

/// The frame of one look, or why there is none, for people. `look`: counts looks from 1; `time`: s, of the plant.
/// Returns when the frame is there, or when it will not come any more.
using FrameSource = std::function<Expected<Frame, std::string>(std::uint64_t look, double time)>;

}  // namespace snug::camera
