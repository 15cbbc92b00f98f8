// The demonstrator's controller table, corrections and files, for the tests of this module.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/motion/controller.hpp"
#include "snug/motion/corrections.hpp"

namespace snug::motion {

inline std::vector<NamedLimits> demonstrator_limits() {
  return {{"PrePick", {0.01, 3.0, 0.35, 2.0, 2.0}},   {"Box", {0.005, 4.0, 0.6, 1.0, 1.5}},
          {"PostPick", {0.05, 4.0, 0.6, 1.5, 2.0}},   {"PrePlace", {0.005, 3.0, 0.5, 2.0, 2.0}},
          {"Place", {0.005, 3.0, 0.4, 1.0, 1.0}},     {"PreTwist", {0.05, 3.0, 0.4, 2.0, 1.5}},
          {"Twist", {0.005, 3.0, 0.4, 2.0, 1.5}},     {"PreRepick", {0.005, 4.0, 0.6, 2.0, 1.5}},
          {"PreRePick", {0.005, 4.0, 0.6, 2.0, 1.5}}, {"RePick", {0.005, 3.0, 0.5, 2.0, 1.5}},
          {"PostPlace", {0.01, 4.0, 0.6, 1.5, 2.0}},  {"PrePlace018", {0.005, 0.8, 0.2, 1.0, 1.5}},
          {"home", {0.005, 3.0, 0.5, 1.5, 0.5}},      {"PostRePick", {0.01, 3.0, 0.5, 1.5, 1.5}},
          {"midpoint", {0.2, 2.0, 0.5, 1.5, 2.0}},    {"PrePlace017_seq3", {0.005, 0.8, 0.2, 1.0, 1.5}}};
}

/// Sequence 1 has its own shift of the re-picks.
inline std::vector<Correction> demonstrator_corrections(int sequence) {
  return {{{"Box", "RePick"}, Vector3(0.0, 0.0, -0.020)},
          {{"Place"}, Vector3(0.0, 0.0, -0.005)},
          {{"PreRepick", "PreRePick", "RePick"}, Vector3(sequence == 1 ? 0.030 : 0.050, 0.010, 0.0)}};
}

inline ControllerSettings demonstrator_settings(int sequence) {
  ControllerSettings settings;
  settings.task_stiffness = sequence == 2 ? 15.0 : 10.0;
  settings.limits = demonstrator_limits();
  return settings;
}

inline std::filesystem::path waypoint_folder() {
  return std::filesystem::path(SNUG_SOURCE_DIR) / ".." / "shared" / "data" / "waypoints";
}

inline const std::vector<std::string>& waypoint_files() {
  static const std::vector<std::string> files = {"poses1.csv",     "poses1real.csv", "poses2sim.csv",
                                                 "poses2real.csv", "poses3sim.csv",  "poses3real.csv"};
  return files;
}

/// Ends the test as skipped where the demonstrator's files are not there.
#define SNUG_NEED_WAYPOINT_FILES() \
  if (!std::filesystem::exists(waypoint_folder())) GTEST_SKIP() << "no waypoint files at " << waypoint_folder()

/// The file and line that the text of an InputError begins with, for EXPECT_EQ; "no error" when nothing is thrown.
template <class Call>
std::string where_it_fails(Call&& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.where + " " + error.key;
  }
  return "no error";
}

inline constexpr double kTick = 0.008;      // s, of the demonstrator's controller
inline constexpr double kRounding = 1e-12;  // a few operations on numbers near 1

inline Vector3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

}  // namespace snug::motion
