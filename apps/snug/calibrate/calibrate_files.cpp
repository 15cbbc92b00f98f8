// What the parts of calibrate share.
#include "apps/snug/calibrate/calibrate_files.hpp"

#include <vector>

#include "apps/snug/command_line/shipped.hpp"
#include "snug/core/input_error.hpp"

namespace snug::app {

NominalArm load_nominal(const CalibrateOptions& options) {
  std::filesystem::path path = options.urdf;
  if (path.empty()) path = find_shipped("scenarios/robots/ur10.urdf");
  const std::filesystem::path beside = options.output.value_or(path.string());
  return {path, robot::load_urdf(path, options.tool_frame), std::filesystem::absolute(beside).parent_path()};
}

int require_link(const robot::ArmModel& arm, const std::string& option, const std::string& name) {
  const int index = robot::find_link(arm, name);
  if (index >= 0) return index;
  std::vector<std::string> names;
  for (const robot::Link& link : arm.links) names.push_back(link.name);
  const std::string_view nearest = find_nearest(name, names);
  throw InputError(
      "command line", option, "'" + name + "'",
      nearest.empty() ? "a link of the URDF" : "a link of the URDF, nearest is '" + std::string(nearest) + "'");
}

}  // namespace snug::app
