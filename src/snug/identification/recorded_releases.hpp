// RecordedRelease: a box that hangs at rest under a vertical cup, and how it leaves once the vacuum is switched off.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace snug::identification {

/// One recording, from the switch on. Heights in the world, m: gripper's end E, box B, and lip S where it was tracked.
struct RecordedRelease {
  std::string where;  ///< "file:line" of its first sample
  double mass = 0.0;  ///< kg
  std::vector<double> times, gripper, box;
  std::vector<double> lip;  ///< empty: not tracked
};

/// Reads columns mass_kg, rep, t_s, E_z_m, B_z_m and perhaps S_z_m; rows of one mass and rep are one recording,
/// together and in the order of time. Throws InputError with file, line and column.
[[nodiscard]] std::vector<RecordedRelease> load_recorded_releases(const std::filesystem::path& path);
[[nodiscard]] std::vector<RecordedRelease> parse_recorded_releases(const std::string& text, const std::string& name);

/// When the lip left the box, s: the straight line through the growing gap between them, brought back to the gap that
/// the stretched foam had before. Negative: the lip was not tracked, or did not leave.
[[nodiscard]] double find_recorded_opening(const RecordedRelease& release);

}  // namespace snug::identification
