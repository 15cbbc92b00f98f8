// What the parts of calibrate share: the nominal arm, its links by name, and the URDF that is written.
#pragma once

#include <filesystem>
#include <string>

#include "apps/snug/calibrate/calibrate.hpp"
#include "snug/robot/arm.hpp"

namespace snug::app {

struct NominalArm {
  std::filesystem::path path;
  robot::ArmModel arm;
  std::filesystem::path out_folder;  ///< of the URDF to be written
};

[[nodiscard]] NominalArm load_nominal(const CalibrateOptions& options);
/// Index of a link; InputError that names the option and the nearest link.
[[nodiscard]] int require_link(const robot::ArmModel& arm, const std::string& option, const std::string& name);

}  // namespace snug::app
