// A small program through the joints of the demonstrator's arm, for the tests of exports.
#pragma once

#include <optional>
#include <vector>

#include "demonstrator.hpp"
#include "snug/control/joint_run.hpp"
#include "snug/control/robot_program.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::control::test {

inline motion::Program small_program() {
  motion::Program program{"test", {}};
  const auto row = [&](const Vector3& offset, const char* name, bool vacuum) {
    motion::Waypoint waypoint = motion::named_waypoint(name, demonstrator().controller.X_WE_start, {.vacuum = vacuum});
    waypoint.X_WE.p += offset;
    program.waypoints.push_back(waypoint);
  };
  row({0.1, 0.0, 0.0}, "PrePick013", false);
  row({0.1, 0.0, -0.05}, "Box013", false);
  row({0.1, 0.0, 0.0}, "PostPick013", true);
  row({0.0, 0.05, 0.0}, "home", true);
  return program;
}

struct Exported {
  motion::Tracking tracking = motion::LaggedTracking{};
  JointController controller = make_controller();
  motion::PreparedProgram plan = motion::prepare(small_program(), program_settings(tracking));
  JointRun run = run_joints(plan, controller, make_demonstrator_machine(), start_joints(controller));

  [[nodiscard]] RobotProgram for_robot() const {
    return {plan, controller.arm(), start_joints(controller), std::vector<std::optional<CarriedLoad>>(4)};
  }
};

}  // namespace snug::control::test
