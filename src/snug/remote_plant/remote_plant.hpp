// RemotePlant: a cell that another program serves over CLICK, behind the interface of a plant.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/camera/frame_source.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/click/joint_link.hpp"
#include "snug/perception/perception.hpp"
#include "snug/plant/motion_runner.hpp"

namespace snug::remote_plant {

struct RemotePlantOptions {
  std::string address;     ///< click://HOST:PORT or click+ipc://PATH
  double patience = 10.0;  ///< s, for an answer
  perception::Kind perception = perception::Kind::Exact;
  std::uint64_t seed = 1;  ///< of the noise of perception alone
  /// How the joints are led to the waypoints: the tracking counts.
  cell::SimulationOptions motions;
  std::optional<click::ClientKeys> keys = {};  ///< where the served cell asks for them
  camera::FrameSource frames = {};             ///< of perception::Kind::Frames
};

/// The CLICK address of a plant's: "tcp://HOST:PORT" of "click://HOST:PORT". Throws InputError for other words.
[[nodiscard]] std::string endpoint_of(const std::string& address);

/// The robot's controller runs here and commands the joints tick by tick; everything else is what the served cell's
/// sensors say. One Control is one tick: its time stands still between calls.
class RemotePlant final : public plant::Plant {
 public:
  /// Connects. Throws InputError when nobody answers, and for a cell that lacks the robot, a box of the sequence, or a
  /// sensor or switch that packing needs; as cell::CellArm for the scenario's robot.
  RemotePlant(const model::Scenario& scenario, const std::string& sequence, const RemotePlantOptions& options);

  [[nodiscard]] plant::Description describe() const override;
  [[nodiscard]] plant::Feedback read() override;
  [[nodiscard]] bool is_moving() const override { return runner_.is_moving(); }
  void start(const plant::Motion& motion) override;
  [[nodiscard]] std::vector<plant::Event> advance() override;
  void cancel() override;
  [[nodiscard]] bool bring(const model::ParcelId& item) override;
  void perceive(std::span<const perception::Expectation> expected) override;
  void acknowledge() override;

  /// What the object sensors said last, for each item of the sequence; nothing of those that are not in the cell.
  [[nodiscard]] std::vector<std::optional<perception::SceneBox>> boxes() const;
  /// m, as the sensors say, or the scenario where they do not.
  [[nodiscard]] Vector3 size_of(std::size_t item) const;
  [[nodiscard]] bool was_brought(std::size_t item) const { return was_brought_[item]; }
  /// Ends the run at the server: it has its result then. Empty, or why it could not be told.
  [[nodiscard]] std::string finish();

 private:
  [[nodiscard]] std::string find_what_packing_needs() const;
  void take_over_tracking();
  [[nodiscard]] click::Control make_control();
  [[nodiscard]] bool send(const click::Control& control);
  void step();
  [[nodiscard]] control::MachineTick command_tick();
  /// The last waypoint was reached and the tool stands.
  void finish_settling();
  void end_motion();
  void begin_motion();
  void stand();
  void fail(std::string why);
  [[nodiscard]] plant::TickReading reading() const;
  [[nodiscard]] plant::Feedback sensors() const;
  /// With a Control of its own: the robot stands.
  void feed();
  [[nodiscard]] std::size_t put_coming(click::Control& control);
  void note_arrival(std::size_t item);
  [[nodiscard]] std::optional<perception::SceneBox> box_of(std::size_t item) const;

  RemotePlantOptions options_;
  model::Scenario scenario_;  ///< arrivals fixed, as plants have them
  model::Sequence sequence_;
  robot::ArmModel model_;
  click::Client client_;
  click::JointLink link_;
  std::unique_ptr<cell::CellArm> arm_;
  std::unique_ptr<const cell::JointPace> pace_;
  cell::ArmState state_;
  motion::ControllerState program_;
  control::JointControllerWork work_;
  std::unique_ptr<perception::Perception> perception_;
  plant::Feedback feedback_;
  std::vector<std::string> names_;  ///< of the items' objects
  std::vector<bool> was_brought_;
  std::optional<std::size_t> coming_;  ///< item that comes with the next tick
  motion::PreparedProgram plan_;       ///< of the motion under way
  plant::MotionRunner runner_;
  bool has_commanded_ = false;
  bool is_stopped_ = false;
  std::string trouble_;  ///< of the last tick: why it stopped
  std::string failure_;  ///< why no motion can follow
};

}  // namespace snug::remote_plant
