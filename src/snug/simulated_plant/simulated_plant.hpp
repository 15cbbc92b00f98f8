// SimulatedPlant: a cell drawn from a scenario's uncertainty by a seed of its own, behind the interface of a plant.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/model/scenario_edit.hpp"
#include "snug/perception/perception.hpp"
#include "snug/plant/motion_watch.hpp"
#include "snug/simulated_plant/faults.hpp"
#include "snug/simulated_plant/foreign_objects.hpp"
#include "snug/simulated_plant/motion_truth.hpp"

namespace snug::simulated_plant {

struct SimulatedPlantOptions {
  std::uint64_t seed = 1;  ///< of what is drawn; 0: the cell is exactly what the scenario says
  perception::Kind perception = perception::Kind::Exact;
  std::vector<Fault> faults;
  /// What is otherwise in this cell than in the scenario that the planner has, before the seed draws from it.
  std::vector<model::KeyValue> set;
  cell::SimulationOptions simulation{.tracking = motion::FastTracking{}};
};

/// One call that changed the plant, with what it was called with: enough to run the same again.
struct Call {
  enum class Kind { Bring, Submit, Acknowledge } kind = Kind::Submit;
  std::string item;
  plant::Motion motion;
  int passed = -1;  ///< OnPassing::waypoint of a Submit, and of the Brings then, which follow it; -1: none
};

/// The cell that a seed stands for.
[[nodiscard]] model::Scenario draw_plant(const model::Scenario& scenario, const std::string& sequence,
                                         std::uint64_t seed);

class SimulatedPlant final : public plant::Plant {
 public:
  /// Throws InputError as cell::Simulation does.
  SimulatedPlant(const model::Scenario& scenario, const std::string& sequence, const SimulatedPlantOptions& options);

  [[nodiscard]] plant::Description describe() const override;
  [[nodiscard]] plant::Feedback read() override { return feedback_; }
  [[nodiscard]] bool bring(const std::string& item) override;
  using plant::Plant::submit;
  [[nodiscard]] plant::Feedback submit(const plant::Motion& motion, const plant::OnPassing& passing) override;
  [[nodiscard]] perception::Observation perceive(std::span<const perception::Expectation> expected) override;
  void acknowledge() override;

  /// The truth, for scores and recordings alone; no planner has this type.
  [[nodiscard]] const cell::Simulation& simulation() const { return simulation_; }
  [[nodiscard]] const cell::CellState& state() const { return state_; }
  [[nodiscard]] const cell::CellWorkspace& work() const { return work_; }
  [[nodiscard]] std::vector<cell::BoxResult> boxes() const { return simulation_.boxes(state_); }
  /// Of the item brought last, from its first motion on where it was brought during one.
  [[nodiscard]] const MotionTruth& motion_truth() const { return witness_.truth(); }
  /// Those that faults asked for.
  [[nodiscard]] const std::vector<ForeignObject>& objects() const { return objects_.objects(); }
  [[nodiscard]] const std::vector<Call>& calls() const { return calls_; }
  /// Called after each tick of the controller.
  void watch(std::function<void(const cell::CellTick&)> watcher) { watcher_ = std::move(watcher); }

 private:
  struct ItemFaults {
    bool no_seal = false, drop = false, stop = false, displace = false, push = false;
  };
  [[nodiscard]] bool advance(const plant::Motion& motion, const motion::PreparedProgram& plan,
                             plant::MotionWatch& course);
  /// What is kept of an item begins anew.
  void begin_item(int index);
  enum class Until { ToolStands, BoxesRest };
  /// At most `longest_settle` of the scenario's motion_guards.
  void settle(const motion::PreparedProgram& plan, plant::MotionWatch& course, Until until = Until::ToolStands);
  void fail(const cell::CellTick& tick, plant::MotionWatch& course);
  [[nodiscard]] plant::TickReading reading() const;
  void inject(const motion::PreparedProgram& plan, plant::MotionWatch& course);
  void break_suction();
  void move_aside(int item, FaultKind kind);
  /// Whether anything was done: boxes and objects have to come to rest then.
  [[nodiscard]] bool put_and_take_objects();
  /// The last motion of the item has ended: it was let go in the container and the tool is over it.
  [[nodiscard]] bool is_let_go(const motion::PreparedProgram& plan) const;
  void move_boxes(const motion::PreparedProgram& plan, plant::MotionWatch& course);
  void note(const char* kind, int item, std::string text);
  void read_sensors(const plant::MotionWatch& course, const plant::End& end);
  [[nodiscard]] Pose X_WE() const;
  [[nodiscard]] int item_of(const std::string& id) const;

  SimulatedPlantOptions options_;
  cell::Simulation simulation_;
  cell::CellState state_;
  cell::CellWorkspace work_;
  ForeignObjects objects_;
  std::unique_ptr<perception::Perception> perception_;
  plant::Feedback feedback_;
  std::vector<bool> was_brought_;
  int brought_count_ = 0;
  int current_ = -1;            ///< item brought last, or the one before while that moves
  int arrived_ = -1;            ///< item brought while that moved
  std::optional<int> passed_;   ///< waypoint that the motion under way is asked to pass
  bool was_passed_ = false;     ///< it has done so
  std::function<void()> tick_;  ///< of the motion, while it is asked to do something: an item comes with a tick
  ItemFaults pending_;          ///< of that item
  int objects_due_ = 0;         ///< to be put in when an item is let go in the container
  bool clear_is_due_ = false;
  bool is_stopped_ = false;
  bool has_failed_ = false;
  std::vector<Call> calls_;
  MotionWitness witness_;
  std::function<void(const cell::CellTick&)> watcher_;
};

}  // namespace snug::simulated_plant
