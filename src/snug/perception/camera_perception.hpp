// CameraPerception: boxes as a depth camera over the container tells them, behind the interface of perception.
#pragma once

#include <cstdint>
#include <memory>

#include "snug/camera/frame_source.hpp"
#include "snug/model/scenario.hpp"
#include "snug/perception/perception.hpp"

namespace snug::perception {

/// Of the stations that measure boxes outside the container (at the aligner, on the bench): half widths of uniform
/// draws, and so the root mean squares of errors of position and turn. A camera of the demonstrator's class has 0.81 mm
/// and 2.4 mrad of one box alone in the container (`camera.alone` of `snug bench camera`). Edges: an assumption.
inline constexpr NoiseLevels kStationNoise{0.0009, 0.003, 0.0005};

/// As make_perception, with Kind::Camera as well: one shot of the scenario's first camera each time, arm
/// out of the view, and the estimate from its depth. `scenario`: what is known of the cell, not how it was drawn.
/// `seed`: of the camera's errors and of noise. Throws InputError for Kind::Camera without a camera or a container, and
/// for Kind::Frames.
[[nodiscard]] std::unique_ptr<Perception> make_perception(Kind kind, std::uint64_t seed,
                                                          const model::Scenario& scenario);

/// As that, with Kind::Frames as well: each look asks `frames` for one. Boxes outside the container are measured by
/// stations where the scene tells of them, and are not looked for elsewhere. What stands at the scene's tool is no
/// obstacle. Throws InputError for Kind::Frames without
/// a source.
[[nodiscard]] std::unique_ptr<Perception> make_perception(Kind kind, std::uint64_t seed,
                                                          const model::Scenario& scenario, camera::FrameSource frames);

}  // namespace snug::perception
