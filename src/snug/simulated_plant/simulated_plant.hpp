// SimulatedPlant: a cell drawn from a scenario's uncertainty by a seed of its own, behind the interface of a plant.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "snug/cell/rest_watch.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/model/scenario_edit.hpp"
#include "snug/perception/perception.hpp"
#include "snug/plant/motion_runner.hpp"
#include "snug/simulated_plant/faults.hpp"
#include "snug/simulated_plant/foreign_objects.hpp"
#include "snug/simulated_plant/motion_truth.hpp"

namespace snug::simulated_plant {

class LiveRecording;

/// A cell that is taken up where a session before left it.
struct TakenUp {
  double time = 0.0;                                    ///< s
  int brought = 0;                                      ///< items that came before, by which faults are counted
  std::vector<std::pair<model::ParcelId, Pose>> boxes;  ///< X_WP of those that stand in it, at rest
};

struct SimulatedPlantOptions {
  std::uint64_t seed = 1;  ///< of what is drawn; 0: the cell is exactly what the scenario says
  perception::Kind perception = perception::Kind::Exact;
  std::vector<Fault> faults;
  /// What is otherwise in this cell than in the scenario that the planner has, before the seed draws from it.
  std::vector<model::KeyValue> set;
  cell::SimulationOptions simulation{.tracking = motion::FastTracking{}};
  std::optional<TakenUp> taken_up;
};

/// The cell that a seed stands for.
[[nodiscard]] model::Scenario draw_plant(const model::Scenario& scenario, const std::string& sequence,
                                         std::uint64_t seed);

class SimulatedPlant final : public plant::Plant {
 public:
  /// Throws InputError as cell::Simulation does.
  SimulatedPlant(const model::Scenario& scenario, const std::string& sequence, const SimulatedPlantOptions& options);

  [[nodiscard]] plant::Description describe() const override;
  [[nodiscard]] plant::Feedback read() override;
  [[nodiscard]] bool is_moving() const override { return runner_.is_moving(); }
  void start(const plant::Motion& motion) override;
  [[nodiscard]] std::vector<plant::Event> advance() override;
  void cancel() override;
  [[nodiscard]] bool bring(const model::ParcelId& item) override;
  void perceive(std::span<const perception::Expectation> expected) override;
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
  /// Of the last tick that was made; nothing before the first.
  [[nodiscard]] const std::optional<cell::CellTick>& last_tick() const { return last_tick_; }
  /// Every tick from now on; not owned, nullptr: no more.
  void record_to(LiveRecording* recording) { recording_ = recording; }

 private:
  struct ItemFaults {
    bool no_seal = false, drop = false, stop = false, displace = false, push = false;
  };
  /// After what a fault moved, or after the last waypoint.
  struct Rest {
    double start = 0.0;  ///< s
    cell::RestWatch boxes;
    bool has_objects = false;  ///< foreign ones were put in
    cell::CellTick before;     ///< the tick that it follows
  };
  void take_up(const TakenUp& begin);
  [[nodiscard]] bool is_at_end() const;
  void step();
  void tick();
  /// Guards, and whatever else ends the motion, by the last tick.
  void finish_tick(const cell::CellTick& tick);
  /// The last waypoint was reached and the tool stands.
  void finish_settling();
  void end_motion();
  void begin_rest(bool has_objects);
  /// A tick, or their end: then what was interrupted by them goes on.
  void step_rest();
  /// An item that was brought comes now.
  void feed();
  /// What is kept of an item begins anew.
  void begin_item(int index);
  void fail(const cell::CellTick& tick);
  [[nodiscard]] cell::CellTick advance_cell();
  [[nodiscard]] double time() const { return simulation_.time(state_); }
  [[nodiscard]] double tool_speed() const;
  [[nodiscard]] plant::TickReading reading() const;
  /// What is due by now; may begin a rest.
  void inject();
  /// The part of it for a box that was let go, which goes on after each rest.
  void inject_let_go();
  void break_suction();
  void move_aside(int item, FaultKind kind);
  /// Whether anything was done: boxes and objects have to come to rest then.
  [[nodiscard]] bool put_and_take_objects();
  /// The last motion of the item has ended: it was let go in the container and the tool is over it.
  [[nodiscard]] bool is_let_go() const;
  /// Whether any was.
  [[nodiscard]] bool move_boxes();
  void note(const char* kind, int item, std::string text);
  [[nodiscard]] plant::Feedback sensors() const;
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
  int current_ = -1;              ///< item brought last, or the one before while that moves
  int arrived_ = -1;              ///< item brought while that moved
  std::optional<int> coming_;     ///< item that comes with the next tick
  motion::PreparedProgram plan_;  ///< of the motion under way
  plant::MotionRunner runner_;
  std::optional<Rest> rest_;
  std::optional<cell::CellTick> last_tick_;
  ItemFaults pending_;   ///< of that item
  int objects_due_ = 0;  ///< to be put in when an item is let go in the container
  bool clear_is_due_ = false;
  bool is_stopped_ = false;
  bool has_failed_ = false;
  MotionWitness witness_;
  LiveRecording* recording_ = nullptr;
};

}  // namespace snug::simulated_plant
