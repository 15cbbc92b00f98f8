// compare_robot: what of a UR does not fit the robot of a scenario, and what is to be set.
#pragma once

#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/remote_ur/read_robot.hpp"

namespace snug::remote_ur {

enum class Verdict {
  Fits,
  Differs,
  Unknown,  ///< the controller does not tell
};

struct Finding {
  std::string what;  ///< "kinematics"
  Verdict verdict = Verdict::Fits;
  std::string robot;     ///< what the controller says
  std::string expected;  ///< what packing by the scenario needs
  std::string remedy;    ///< what to set; empty where it fits
};

struct Tolerances {
  double position = 1e-3;  ///< m, of the tool's end by the controller's kinematics, over the arm's range; of the TCP
  double angle = 3.5e-3;   ///< rad, of the TCP (0.2 degrees)
  double mass = 0.05;      ///< kg, of the payload
  double centre = 5e-3;    ///< m, of the payload's centre of gravity
};

/// The largest distance between the tool's end by the controller's Denavit-Hartenberg parameters and by the scenario's
/// URDF, over 200 seeded joint positions: m. Parameters alone do not compare: those of parallel axes can be exchanged
/// for each other, and calibrated robots have such. NaN or infinity where the controller's are.
/// Throws InputError for an arm that is not built as a UR.
[[nodiscard]] double kinematic_deviation(const ur::RobotFacts& robot, const model::Scenario& scenario);

/// In the order in which they are to be mended. The scenario has a robot. Throws as kinematic_deviation.
[[nodiscard]] std::vector<Finding> compare_robot(const RobotReport& robot, const model::Scenario& scenario,
                                                 const Tolerances& tolerances = {});

}  // namespace snug::remote_ur
