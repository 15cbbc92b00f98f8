// Executor: tries to bring a box to its place, in the course of events that counts and in those that could be.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "snug/task/grasp.hpp"
#include "snug/task/session.hpp"

namespace snug::task {

/// One way to bring one box to one place, executed everywhere but not yet taken.
struct Attempt {
  bool was_simulated = true;  ///< false: known from an attempt before that the box cannot be held so
  bool succeeded = false;     ///< in the course that counts
  double share = 0.0;         ///< of the samples that succeeded
  std::string reason;         ///< why it did not succeed
  bool was_stopped = false;   ///< by a protective stop of the robot, in the course that counts
  TurnManner turn = TurnManner::None;
  PlaceManner manner = PlaceManner::Straight;
  packing::Placement planned;
  AttemptForces predicted, happened;
  double position_error = 0.0, angle_error = 0.0;
  motion::Program program;
  std::vector<cell::CellState> states;  ///< of each lane at its end
  std::vector<bool> is_sound;           ///< lane by lane: whether it succeeded there
};

class Executor {
 public:
  Executor(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options);

  /// To be called before the attempts for another item.
  void begin(int item);
  [[nodiscard]] Attempt attempt(const packing::Candidate& candidate, const PlaceVariant& variant, double packed_top);
  /// What was attempted has happened.
  void take(Attempt attempt);
  /// Home row and time to rest. Returns when the program ended [s] and whether something went wrong on the last way.
  Episode finish();

  [[nodiscard]] const Lane& real() const { return *lanes_[0]; }
  [[nodiscard]] const motion::Program& program() const { return program_; }
  [[nodiscard]] const CellLayout& layout() const { return layout_; }

 private:
  struct Outcome {
    bool succeeded = false;
    std::string reason;
    bool was_stopped = false;
    AttemptForces forces;
    double position_error = 0.0, angle_error = 0.0;
  };
  const Grasp& grasp_for(const packing::Placement& placement, double packed_top);
  Outcome judge(const Lane& lane, const std::vector<std::optional<Pose>>& before, const Pose& X_TP) const;
  [[nodiscard]] std::vector<std::optional<Pose>> poses(const Lane& lane) const;

  model::Scenario scenario_;
  SessionOptions options_;
  CellLayout layout_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  std::vector<cell::CellState> states_;  ///< of the lanes, as far as things have happened
  motion::Program program_;
  PlannedBox box_;
  std::function<bool(const Pose& X_WE)> reaches_;
  std::vector<Grasp> grasps_;  ///< of this box
};

}  // namespace snug::task
