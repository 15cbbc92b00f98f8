// export of programs: for the controllers of real robots.
#pragma once

#include "apps/snug/export/export.hpp"

namespace snug::app {

[[nodiscard]] int write_urscript(const ExportOptions& options, OutputFile output);
[[nodiscard]] int write_ros_trajectory(const ExportOptions& options, OutputFile output);
[[nodiscard]] int write_mc_rtc_csv(const ExportOptions& options, OutputFile output);
[[nodiscard]] int write_mc_rtc_flat(const ExportOptions& options, OutputFile output);

}  // namespace snug::app
