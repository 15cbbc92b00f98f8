// RemotePlant: a cell that another program serves over CLICK, behind the interface of a plant.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/click/joint_link.hpp"
#include "snug/perception/perception.hpp"
#include "snug/plant/motion_watch.hpp"

namespace snug::remote_plant {

struct RemotePlantOptions {
  std::string address;     ///< click://HOST:PORT or click+ipc://PATH
  double patience = 10.0;  ///< s, for an answer
  perception::Kind perception = perception::Kind::Exact;
  std::uint64_t seed = 1;  ///< of the noise of perception alone
  /// How the joints are led to the waypoints: the tracking counts.
  cell::SimulationOptions motions;
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
  [[nodiscard]] plant::Feedback read() override { return feedback_; }
  [[nodiscard]] bool bring(const std::string& item) override;
  using plant::Plant::submit;
  [[nodiscard]] plant::Feedback submit(const plant::Motion& motion, const plant::OnPassing& passing) override;
  [[nodiscard]] perception::Observation perceive(std::span<const perception::Expectation> expected) override;
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
  [[nodiscard]] plant::End step(const motion::PreparedProgram& plan);
  [[nodiscard]] bool advance(const plant::Motion& motion, const motion::PreparedProgram& plan,
                             plant::MotionWatch& course);
  void settle(const motion::PreparedProgram& plan, bool was_passed, plant::MotionWatch& course);
  void begin_motion();
  void stand();
  void fail(std::string why);
  [[nodiscard]] plant::TickReading reading() const;
  void read_sensors(const plant::MotionWatch& course, const plant::End& end);
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
  /// Object and its events, of an item that is brought with the next tick of the motion under way.
  std::optional<std::pair<std::string, click::Named<bool>>> fed_;
  std::function<void()> tick_;  ///< of the motion under way: the next one; empty while the robot stands
  bool has_commanded_ = false;
  bool is_stopped_ = false;
  std::string failure_;  ///< why no motion can follow
};

}  // namespace snug::remote_plant
