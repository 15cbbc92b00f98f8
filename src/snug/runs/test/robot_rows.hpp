// Rows for the arm of the demonstrator, and another arm, for the tests of this module.
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "snug/cell/test/demonstrator.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/runs/run.hpp"

namespace snug::runs::test {

inline const Pose& home() { return cell::demonstrator().controller.X_WE_start; }

inline motion::Waypoint row_at(const Vector3& p_WE, const std::string& name = "home") {
  return motion::named_waypoint(name, {home().R, p_WE});
}

inline RunResult simulate(const model::Scenario& scenario, std::vector<motion::Waypoint> rows,
                          const std::filesystem::path& record = {}) {
  RunOptions options;
  options.program = motion::Program{"test", std::move(rows)};
  options.sequence = "1";
  options.simulation.robot = "ur10";
  options.record_path = record;
  return run(scenario, options);
}

/// Into the container and then sideways through its wall.
inline std::vector<motion::Waypoint> into_the_wall() {
  const model::Container& tote = *model::find_container(cell::demonstrator(), cell::demonstrator().target);
  const auto at = [&](double along, double height) {
    return tote.X_WT * Vector3(along, 0.0, tote.inner_size.z() + height);
  };
  return {row_at(at(0.0, 0.1)), row_at(at(0.0, -0.1)), row_at(at(0.5 * tote.inner_size.x() + 0.05, -0.1))};
}

/// Tool level, down into the container beside its wall, then the wrist against it.
inline std::vector<motion::Waypoint> wrist_into_the_wall() {
  std::vector<motion::Waypoint> rows;
  for (const Vector3& p : {Vector3(0.505, -0.45, 0.30), Vector3(0.505, -0.55, -0.05), Vector3(0.505, -0.50, -0.05)}) {
    rows.push_back(row_at(p));
    rows.back().X_WE.R = exp_rotation(Vector3(0.5 * std::numbers::pi, 0.0, 0.0));
  }
  return rows;
}

/// An arm as most makers build it: three axes in the wrist that meet in a point, unlike a UR's. Efforts are not known.
inline std::string spherical_wrist() {
  struct Row {
    const char *origin, *axis;
    double limit, speed;
  };
  constexpr Row kRows[] = {{"0 0 0.4", "0 0 1", 2.9, 3.0}, {"0.2 0 0", "0 1 0", 2.0, 3.0},
                           {"0 0 0.6", "0 1 0", 2.0, 3.0}, {"0.3 0 0", "1 0 0", 6.1, 6.0},
                           {"0.3 0 0", "0 1 0", 2.2, 6.0}, {"0.1 0 0", "1 0 0", 6.1, 6.0}};
  std::string text = "<robot name=\"ball\"><link name=\"l0\"/>";
  int i = 0;
  for (const Row& row : kRows) {
    ++i;
    text += fmt::format(
        "<link name=\"l{0}\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" iyy=\"0.01\" "
        "izz=\"0.01\"/></inertial></link>\n<joint name=\"a{0}\" type=\"revolute\"><parent link=\"l{1}\"/>"
        "<child link=\"l{0}\"/><origin xyz=\"{2}\"/><axis xyz=\"{3}\"/>"
        "<limit lower=\"{4}\" upper=\"{5}\" effort=\"0\" velocity=\"{6}\"/></joint>\n",
        i, i - 1, row.origin, row.axis, -row.limit, row.limit, row.speed);
  }
  std::string parent = "l6";
  for (const char* name : {"flange", "ft_sensor", "E"}) {
    const bool is_tool = std::string(name) == "E";
    text += fmt::format(
        "<link name=\"{0}\"/><joint name=\"to_{0}\" type=\"fixed\"><parent link=\"{1}\"/><child link=\"{0}\"/>{2}"
        "</joint>\n",
        name, parent, is_tool ? "<origin xyz=\"0.3 0 0\" rpy=\"0 1.5707963267948966 0\"/>" : "");
    parent = name;
  }
  return text + "</robot>\n";
}

/// The demonstrator's cell with that arm, which points away from everything.
struct BallWrist {
  snug::test::ScratchFolder folder;
  model::Scenario scenario = cell::demonstrator();

  BallWrist() {
    const std::filesystem::path path = folder / "wrist.urdf";
    std::ofstream(path) << spherical_wrist();
    model::RobotParams robot;
    robot.name = "ur10";
    robot.urdf = path.string();
    robot.X_WB.p = Vector3(0.0, 0.0, 0.3);
    robot.posture = robot.joints_start = {0.0, 0.0, 0.0, 0.0, -0.3, 0.0};
    robot.self_collision.clear();
    scenario.robot = robot;
  }
};

/// The tool turned about the middle of that wrist, which stays: pitch and yaw from where it points along the forearm.
inline motion::Waypoint turned_tool(double pitch, double yaw) {
  const Vector3 wrist(0.8, 0.0, 1.3);
  const Matrix3 R = exp_rotation(Vector3(0.0, 0.0, yaw)) * exp_rotation(Vector3(0.0, pitch, 0.0));
  return motion::make_waypoint(
      motion::MotionClass::Home, {},
      {R * exp_rotation(Vector3(0.0, 0.5 * std::numbers::pi, 0.0)), wrist + R * Vector3(0.4, 0.0, 0.0)});
}

}  // namespace snug::runs::test
