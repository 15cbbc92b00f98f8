// Rehearsal: one item's motions tried in the nominal world and in the sampled ones before they are sent.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/packing/placement.hpp"
#include "snug/planning/grasp.hpp"

namespace snug::planning {

struct AttemptForces {
  double force = 0.0;         ///< N
  double torque = 0.0;        ///< Nm
  double displacement = 0.0;  ///< m, of the other boxes, the largest
};

/// Why an attempt did not succeed in a rollout.
enum class AttemptFailure {
  None,
  Grasp,          ///< see Attempt::grasp_problem
  OutOfReach,     ///< the robot cannot follow the way to its place
  Rollout,        ///< it ended early: force, protective stop, arm contact
  HoldMargin,     ///< PlaceLimits::hold_factor
  Gone,           ///< the box left the cell
  SticksOut,      ///< over the rim or beyond a wall
  OffPlace,       ///< PlaceLimits::position
  Tilted,         ///< PlaceLimits::tilt
  OthersMoved,    ///< PlaceLimits::displacement
  OthersCameOut,  ///< of the container
  SentBefore      ///< not rehearsed: this motion was sent, and ended by what it met (FailedMotion)
};
[[nodiscard]] const char* name_of(AttemptFailure failure);

/// One grasp and insertion that bring one box to one place, rehearsed in every world but not yet sent.
struct Attempt {
  bool was_rehearsed = true;                      ///< false: the box cannot be held so, or failed so when it was sent
  AttemptFailure failure = AttemptFailure::None;  ///< in the nominal world, else the first of a sampled one
  std::string text;                               ///< what failed, for people
  bool succeeded = false;                         ///< in the nominal world
  bool was_stopped = false;                       ///< by a protective stop of the robot, in the nominal world
  double success_rate = 0.0;                      ///< of the samples, by weight
  int samples = 0;                                ///< that were rehearsed
  skills::Reorientation reorientation = skills::Reorientation::None;
  skills::InsertionSkill skill = skills::InsertionSkill::TopDown;
  packing::Placement planned;
  AttemptForces predicted;  ///< largest of the samples
  AttemptForces nominal;
  motion::Program program;
  std::vector<std::size_t> stages;  ///< as Grasp::stages
  std::vector<Pose> stage_poses;    ///< as Grasp::stage_poses
  Pose X_PS;                        ///< lip on the held box, nominal
  /// Waypoint over the box that was let go, from which the tool leaves for where it waits (RehearsalTask::X_WE_after).
  std::optional<std::size_t> leaves;
  std::vector<double> q_end;                           ///< rad, nominal
  std::optional<motion::Swing> swing;                  ///< as Grasp::swing
  std::vector<std::vector<std::optional<Pose>>> ends;  ///< world by world, X_WP of all items when boxes rest
};

/// What is rehearsed: one box from where it stands, by the robot of the belief.
struct RehearsalTask {
  model::ItemIndex item;
  Pose X_WP;  ///< where it is believed to be
  Location location = Location::Aligner;
  std::optional<Pose> X_WE_after;  ///< where the tool goes on to when the box is at its place
};

class Rehearsal {
 public:
  /// `rollouts`: of the worlds of the belief, taken up (RolloutPool). The result does not depend on `threads`.
  Rehearsal(const BeliefSnapshot& belief, const CellPlan& cell, std::span<const std::unique_ptr<Rollout>> rollouts,
            int threads, const RehearsalTask& task);

  [[nodiscard]] Attempt attempt(const packing::Candidate& candidate, const skills::Insertion& insertion,
                                double packed_top);
  [[nodiscard]] const skills::PlannedBox& box() const { return box_; }

 private:
  struct Outcome {
    AttemptFailure failure = AttemptFailure::None;
    std::string text;
    RolloutEnd end = RolloutEnd::Completed;
    AttemptForces forces;
  };
  [[nodiscard]] bool was_sent_in_vain(const Attempt& attempt) const;
  [[nodiscard]] std::vector<skills::Reorientation> refused_reorientations() const;
  const Grasp& grasp_for(const packing::Placement& placement, double packed_top);
  [[nodiscard]] Outcome judge(const Rollout& rollout, const std::vector<std::optional<Pose>>& before,
                              const Pose& X_TP) const;
  /// In one world, from where the box hangs from the cup.
  [[nodiscard]] Outcome execute(std::size_t world, const Grasp& grasp, const std::vector<motion::Waypoint>& waypoints,
                                Attempt& attempt) const;
  [[nodiscard]] std::vector<motion::Waypoint> waypoints_to_next(const motion::Waypoint& last) const;
  void rehearse_samples(const std::function<Outcome(std::size_t)>& execute, Attempt& attempt) const;

  const BeliefSnapshot& belief_;
  const CellPlan& cell_;
  int threads_;
  RehearsalTask task_;
  skills::PlannedBox box_;
  std::span<const std::unique_ptr<Rollout>> rollouts_;
  std::vector<double> weights_;
  std::vector<cell::CellState> states_;  ///< of the rollouts, where they were taken up
  std::vector<std::vector<std::optional<Pose>>> before_;
  std::vector<Grasp> grasps_;
};

}  // namespace snug::planning
