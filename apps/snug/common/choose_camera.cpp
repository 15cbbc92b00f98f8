// choose_camera: the camera of a scenario that a user names.
#include "apps/snug/common/choose_camera.hpp"

#include <fmt/format.h>

#include <vector>

#include "snug/core/input_error.hpp"

namespace snug::app {

model::CameraParams choose_camera(const model::Scenario& scenario, const std::optional<std::string>& name,
                                  const std::string& source) {
  if (scenario.cameras.empty())
    throw InputError(source, "cameras", "none", "a scenario with cameras; --scenario names another one");
  if (!name) return scenario.cameras.front();
  if (const model::CameraParams* camera = model::find_camera(scenario, *name)) return *camera;
  std::vector<std::string> names;
  for (const model::CameraParams& camera : scenario.cameras) names.push_back(camera.name);
  const std::string_view nearest = find_nearest(*name, names);
  throw InputError("command line", "--camera", "'" + *name + "'",
                   fmt::format("one of {}{}", fmt::join(names, ", "),
                               nearest.empty() ? "" : fmt::format(", nearest is '{}'", nearest)));
}

}  // namespace snug::app
