// RecordedPlant: any plant, and beside it a recording of what it says: of a robot that no simulation knows all about.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "snug/cell/simulation.hpp"
#include "snug/plant/event.hpp"
#include "snug/simulated_plant/live_recording.hpp"

namespace snug::study {

/// Hands everything on. A frame for each tick of motion has the joints, the tool, the load on it, outputs and pressure
/// as the plant's sensors read. Boxes stand where they were perceived last, hang from the tool while the vacuum says
/// so, and stay where they are let go until they are perceived. The sensor's wrench is that load with the gripper's
/// weight added, the robot at rest. The tool's reference is where the tool is; contacts, velocities of boxes and the
/// cup's own wrench are not known, and empty.
class RecordedPlant final : public plant::Plant {
 public:
  /// Begins the file. `plant` is not owned; `scenario`: with a robot, as whoever packs knows it. Throws InputError as
  /// cell::Simulation, and for a file that cannot be written; every call OutputError when writing fails.
  RecordedPlant(plant::Plant& plant, const model::Scenario& scenario, const std::string& sequence,
                const cell::SimulationOptions& options, const simulated_plant::LiveRecordingOptions& recording);

  [[nodiscard]] plant::Description describe() const override { return plant_.describe(); }
  [[nodiscard]] plant::Feedback read() override { return plant_.read(); }
  [[nodiscard]] bool is_moving() const override { return plant_.is_moving(); }
  void start(const plant::Motion& motion) override;
  [[nodiscard]] std::vector<plant::Event> advance() override;
  void cancel() override { plant_.cancel(); }
  [[nodiscard]] bool bring(const model::ParcelId& item) override { return plant_.bring(item); }
  void perceive(std::span<const perception::Expectation> expected) override { plant_.perceive(expected); }
  void acknowledge() override { plant_.acknowledge(); }

  /// What who packs has to say, when it happens.
  void note(record::Event event);
  /// The rest, and the result. `boxes`: what became of them.
  void close(const simulated_plant::RecordingEnd& end, std::vector<cell::BoxResult> boxes);

 private:
  struct Held {
    int item = -1;
    Pose X_EP;
  };
  void take(const plant::Event& event, const plant::Feedback& now);
  void see(const perception::Observation& seen, const Pose& X_WE);
  void hold(const Pose& X_WE);
  void let_go(const Pose& X_WE);
  void move_to(const plant::Feedback& now);
  void add_frame(const plant::Feedback& now);
  void add_events();
  [[nodiscard]] int find_item(const std::string& id) const;
  [[nodiscard]] physics::BodyId body_of(int item) const {
    return simulation_.world().parcels[static_cast<std::size_t>(item)];
  }

  plant::Plant& plant_;
  const model::Scenario& scenario_;
  cell::Simulation simulation_;  ///< never advanced: it knows bodies and shapes
  cell::CellState state_;        ///< as it is told
  cell::CellWorkspace work_;
  runs::Recorder recorder_;
  model::ParcelId item_;  ///< of the motion
  std::optional<Held> held_;
  std::vector<record::Event> events_;
  std::size_t own_ = 0;       ///< events of `state_` that are among them
  int waypoint_count_ = 0;    ///< of all motions before
  int next_count_ = 0;        ///< with that under way
  int row_ = 0;               ///< of the motion under way, aimed at
  bool is_written_ = false;   ///< the motion under way is in the program
  double last_frame_ = -1.0;  ///< s
};

}  // namespace snug::study
