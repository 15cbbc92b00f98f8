// Recorder: turns the state of a running cell into frames of a recording.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "snug/cell/cell_arm.hpp"
#include "snug/cell/gripper.hpp"
#include "snug/motion/controller.hpp"
#include "snug/record/writer.hpp"

namespace snug::runs {

/// Sees a run while it goes on: the same frames and events as a recording of it.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void begin(const record::RecordingHeader& header) = 0;
  /// May take its time: the run waits. False: the run is to stop here.
  virtual bool add(const record::Frame& frame) = 0;
  virtual void add(const record::Event& event) = 0;
};

/// Keeps a run's recording in memory.
class RunCapture final : public RunObserver {
 public:
  void begin(const record::RecordingHeader& header) override { recording.header = header; }
  bool add(const record::Frame& frame) override {
    recording.frames.push_back(frame);
    return true;
  }
  void add(const record::Event& event) override { recording.events.push_back(event); }
  record::Recording recording;
};

struct RecorderSetup {
  std::filesystem::path path;       ///< HDF5, or empty: nothing is written
  OutputFile* file = nullptr;       ///< instead of `path`: reserved before; taken; not owned
  RunObserver* observer = nullptr;  ///< not owned
  double period = 0.008;            ///< s between frames
  std::string program_text;
  bool program_grows = false;  ///< append_program instead of `program_text`
  std::string program_name;
  std::string sequence;
  std::string settings_json = "{}";
  std::string version;
  std::vector<std::string> joints;  ///< names, with a robot
};

/// What a frame shows besides the world.
struct FrameInput {
  Pose X_WE;
  Twist V_WE;
  Pose X_WE_command;
  int program_row = -1;
  const cell::GripperState* gripper = nullptr;
  cup::CupCommand command;
  const cell::ArmReading* arm = nullptr;  ///< with a robot
};

class Recorder {
 public:
  /// Throws InputError when the file cannot be written.
  Recorder(const model::Scenario& scenario, const cell::CellWorld& world, const RecorderSetup& setup);
  /// False when the observer wants the run to stop.
  [[nodiscard]] bool add_frame(const cell::CellWorld& world, const physics::WorldState& state,
                               const physics::Workspace& work, const physics::StepReport& report,
                               const FrameInput& input);
  /// Records those of a growing list that it has not seen.
  void add_events(const std::vector<record::Event>& events);
  /// Whole lines, with RecorderSetup::program_grows.
  void append_program(std::string_view lines);
  /// `result_json` is kept in the recording; `is_interrupted`: the observer ended the run early.
  void close(const std::string& result_json, bool is_interrupted);

 private:
  /// Contacts of the world into the frame: those found in the step, and of pairs at rest, at which a step does not
  /// look, those that the frame before had.
  void add_contacts(const cell::CellWorld& world, const physics::WorldState& state, const physics::Workspace& work);

  std::optional<record::RecordingWriter> writer_;
  RunObserver* observer_ = nullptr;
  std::size_t recorded_events_ = 0;
  record::Frame frame_;
  std::vector<record::ContactSample> contacts_;  ///< of the world in the frame before
};

}  // namespace snug::runs
