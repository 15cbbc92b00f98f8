// CellForm: a cell as it stands before anything is done, in the replay form: one frame, for who draws it.
#include "snug/replay/cell_form.hpp"

#include <filesystem>
#include <optional>

#include "snug/control/pose_solver.hpp"
#include "snug/core/input_error.hpp"
#include "snug/replay/frame_coder.hpp"
#include "snug/replay/replay.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/runs/recorder.hpp"

namespace snug::replay {
namespace {

constexpr int kMostSteps = 200;  ///< as cell::CellArm looks for its start

struct StandingArm {
  robot::ArmModel model;
  robot::JointVector q;
};

std::optional<StandingArm> find_arm(const model::Scenario& scenario) {
  std::error_code error;
  if (!scenario.robot || !scenario.tool || !std::filesystem::exists(robot::urdf_path(scenario), error))
    return std::nullopt;
  StandingArm arm{robot::load_arm(scenario), robot::joint_vector(scenario.robot->posture)};
  if (!scenario.robot->joints_start.empty()) {
    arm.q = robot::joint_vector(scenario.robot->joints_start);
  } else {
    const control::PoseSolution start =
        control::solve_pose(arm.model, scenario.controller.X_WE_start, arm.q, kMostSteps);
    if (start.is_reached()) arm.q = start.q;
  }
  return arm;
}

RobotDescription description_of(const model::Scenario& scenario) {
  try {
    return read_robot(robot::urdf_path(scenario));
  } catch (const InputError&) {
    return {};  // meshes that are not there: the shapes that it touches with are drawn
  }
}

}  // namespace

std::string encode_cell(const model::Scenario& scenario) {
  const std::optional<StandingArm> arm = find_arm(scenario);
  cell::WorldOptions options;
  options.with_tool = scenario.tool.has_value();
  if (arm) {
    options.arm = &arm->model;
    options.q = arm->q;
  }
  const cell::CellWorld world = cell::build_world(scenario, options);
  const physics::WorldState state = cell::make_initial_state(scenario, world);
  const physics::Workspace work(world.model, 1);
  runs::RunCapture capture;
  runs::RecorderSetup setup;
  setup.observer = &capture;
  setup.period = scenario.controller.tick;
  if (arm) {
    for (const robot::Joint& joint : arm->model.joints) setup.joints.push_back(joint.name);
  }
  runs::FrameInput input;
  input.X_WE = arm ? robot::forward_tool(arm->model, arm->q) : scenario.controller.X_WE_start;
  input.X_WE_command = input.X_WE;
  runs::Recorder recorder(scenario, world, setup);
  (void)recorder.add_frame(world, state, work, {}, input);
  record::Frame& frame = capture.recording.frames.front();
  if (world.tool.index >= 0)
    frame.bodies[static_cast<std::size_t>(world.tool.index)].X_WB =
        record::PoseSample(input.X_WE.p, Quaternion(input.X_WE.R));
  frame.joints.resize(setup.joints.size());
  for (std::size_t j = 0; j < frame.joints.size(); ++j) frame.joints[j].position = arm->q[static_cast<Eigen::Index>(j)];
  HeaderInput header;
  header.name = scenario.name;
  header.header = &capture.recording.header;
  header.is_complete = true;
  header.frames = 1;
  if (arm) header.robot = description_of(scenario);
  FrameCoder coder(capture.recording.header);
  coder.add(frame);
  return encode_form(make_header_json(header), coder.finish());
}

}  // namespace snug::replay
