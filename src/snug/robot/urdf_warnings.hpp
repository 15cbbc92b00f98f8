// UrdfWarnings: what was assumed of a URDF that says too little, or more than an arm needs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace snug::robot {

/// One line for all moving joints that do not lie between the root and `tool_frame` (fingers, balancers, second arms),
/// which parse_urdf fixes, one for each continuous joint without limit and each with velocity 0, whose speed it
/// assumes, and one for each package:// whose meshes come from a folder of another name: "file:line: ...". Empty for
/// what is no URDF.
[[nodiscard]] std::vector<std::string> find_assumptions(const std::filesystem::path& path,
                                                        const std::string& tool_frame);

}  // namespace snug::robot
