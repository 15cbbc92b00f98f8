// Recorder: turns the state of a running cell into frames of a recording.
#pragma once

#include <filesystem>
#include <memory>

#include "snug/cell/gripper.hpp"
#include "snug/motion/controller.hpp"
#include "snug/record/writer.hpp"

namespace snug::cell {

struct RecorderSetup {
  std::filesystem::path path;
  double period = 0.008;  ///< s between frames
  std::string program_text;
  std::string program_name;
  std::string sequence;
  std::string settings_json = "{}";
  std::string version;
};

/// What a frame shows besides the world.
struct FrameInput {
  Pose X_WE;
  Twist V_WE;
  Pose X_WE_command;
  int program_row = -1;
  const GripperState* gripper = nullptr;
  cup::CupCommand command;
};

class Recorder {
 public:
  /// Throws InputError when the file cannot be written.
  Recorder(const model::Scenario& scenario, const CellWorld& world, const RecorderSetup& setup);
  void add_frame(const CellWorld& world, const physics::WorldState& state, const physics::Workspace& work,
                 const physics::StepReport& report, const FrameInput& input);
  void add_event(const record::Event& event) { writer_.append(event); }
  void close() { writer_.close(); }

 private:
  record::RecordingWriter writer_;
  record::Frame frame_;
};

}  // namespace snug::cell
