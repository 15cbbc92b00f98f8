// choose_camera: the camera of a scenario that a user names.
#pragma once

#include <optional>
#include <string>

#include "snug/model/scenario.hpp"

namespace snug::app {

/// The first where none is named. Throws InputError for a scenario (`source`) without cameras and for an unknown name.
[[nodiscard]] model::CameraParams choose_camera(const model::Scenario& scenario, const std::optional<std::string>& name,
                                                const std::string& source);

}  // namespace snug::app
