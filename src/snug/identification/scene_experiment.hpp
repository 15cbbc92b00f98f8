// SceneExperiment: recordings beside simulations of a scenario whose numbers are still open.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "snug/identification/driven_path.hpp"
#include "snug/identification/recorded_motion.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/scene_task.hpp"
#include "snug/numerics/batched_least_squares.hpp"

namespace snug::identification {

namespace internal {
struct SimulatedMotion;
struct ProgramRun;
struct OwnValues;
}  // namespace internal

/// How far the simulation of one recording is from it.
struct MotionError {
  double position = 0.0;         ///< m, mean over samples and bodies
  double rotation = 0.0;         ///< rad
  double position_square = 0.0;  ///< m^2, mean of squares
  double rotation_square = 0.0;  ///< rad^2
  double end_position = 0.0;     ///< m, of the last sample
  double end_rotation = 0.0;     ///< rad
  double right = 0.0;            ///< share of the bodies whose orientation is right at the end
  Eigen::VectorXd residuals;     ///< in units of the noise, those of own unknowns against what is expected of them last
  std::string failure;           ///< empty, or why there is no simulation
};

/// Mean over recordings, each counted once.
struct SceneError {
  double position_mm = 0.0;
  double rotation_deg = 0.0;
  double end_position_mm = 0.0;
  double end_rotation_deg = 0.0;
  double right_orientation_percent = 0.0;
  double cost = 0.0;  ///< mm, see cost_of
  int recordings = 0, failed = 0;
  bool operator==(const SceneError&) const = default;
};

class SceneExperiment {
 public:
  /// Throws InputError when task, scenario and recordings do not fit: unknown bodies, paths that lead nowhere, values
  /// that the scenario cannot have.
  SceneExperiment(model::SceneTask task, std::vector<RecordedMotion> motions, int threads);
  SceneExperiment(SceneExperiment&&) noexcept;
  ~SceneExperiment();

  struct Job {
    std::size_t point = 0;     ///< of `points`
    std::size_t motion = 0;    ///< recording
    Eigen::VectorXd own = {};  ///< its own unknowns; empty: all zero
    double clock_rate = 0.0;   ///< by how much the clock that recorded is fast, relative; not in a program's run
  };
  /// `points`: values of all parameters of the task, in its order. Each job is a simulation, but those of a point that
  /// differ in nothing that moves a body share one, and all that a program leads share one run. The result does not
  /// depend on the number of threads. What cannot be simulated says so. Samples after `until`, s on the recording's
  /// clock, count nothing. The latest runs of programs are kept. One call at a time.
  [[nodiscard]] std::vector<MotionError> evaluate(std::span<const Eigen::VectorXd> points, std::span<const Job> jobs,
                                                  double until = std::numeric_limits<double>::infinity()) const;
  /// Errors that the noise of the start alone sets: each recording is replaced by its own simulation, the poses of its
  /// free flight get noise as large as those recorded are off theirs, and it is predicted again. Needs
  /// StartFrom::FreeFlight and at least four rows of flight; recordings with fewer count as failed.
  [[nodiscard]] std::vector<MotionError> evaluate_floor(const Eigen::VectorXd& values, std::uint64_t seed) const;
  /// The scenario at these values. Throws InputError when it cannot be.
  [[nodiscard]] model::Scenario scenario_at(const Eigen::VectorXd& values) const;

  [[nodiscard]] const model::SceneTask& task() const { return task_; }
  [[nodiscard]] const std::vector<RecordedMotion>& motions() const { return motions_; }
  [[nodiscard]] Eigen::VectorXd start() const;  ///< values of the task
  /// Of the bodies that a recording drives, smoothed; none in a program's run.
  [[nodiscard]] std::vector<DrivenPath> driven_of(std::size_t motion) const { return driven_of(motion, {}); }
  /// Own unknowns of a recording that are shares of paths near the smoothed ones; 0 where none is noisy.
  [[nodiscard]] Eigen::Index path_unknowns() const { return path_unknowns_; }
  [[nodiscard]] Eigen::VectorXd own_deviation() const;  ///< expected of the own unknowns; empty when there are none
  /// Numbers measured in a recording: residuals less those of own unknowns against what is expected of them.
  [[nodiscard]] Eigen::Index samples_of(std::size_t motion) const;
  [[nodiscard]] double longest() const;  ///< s, of what is simulated for a recording
  /// Where the residuals of a tracked body stand: sample by sample, in order of time.
  struct BodyRows {
    Eigen::Index first = 0, count = 0;
    int each = 6;                                       ///< rows of a sample
    const std::vector<std::size_t>* samples = nullptr;  ///< of the recording; lives as long as the experiment
  };
  [[nodiscard]] std::vector<BodyRows> rows_of(std::size_t motion) const;
  /// A recording as a term of a sum of squares that is computed in batches; its own unknowns start at zero.
  [[nodiscard]] numerics::BatchedProblem::Term term_of(std::size_t motion) const;

  /// mm: with TaskLoss::Distance the mean distance of centres and, times the ratio, of angles; with Squares the root of
  /// the mean of both squared.
  [[nodiscard]] double cost_of(const MotionError& error) const;
  [[nodiscard]] SceneError summarize(std::span<const MotionError> errors) const;

 private:
  /// A program's run, and of which point.
  struct KnownRun;
  [[nodiscard]] std::vector<MotionError> evaluate_program(std::span<const Eigen::VectorXd> points,
                                                          std::span<const Job> jobs, double until) const;
  [[nodiscard]] std::vector<MotionError> evaluate_scenes(std::span<const Eigen::VectorXd> points,
                                                         std::span<const Job> jobs, double until) const;
  /// None: these values are no scenario's.
  [[nodiscard]] std::optional<model::Scenario> find_scenario(const Eigen::VectorXd& values, std::string& failure) const;
  /// The recording that leads the tool in the simulation of this one, or their number: the program does.
  [[nodiscard]] std::size_t lead_of(std::size_t motion) const;
  [[nodiscard]] const internal::ProgramRun* find_run(const Eigen::VectorXd& point, std::size_t lead,
                                                     double until) const;
  [[nodiscard]] MotionError compare(const internal::SimulatedMotion& simulated, std::size_t motion,
                                    const Eigen::VectorXd& own, double until) const;
  void check_bodies() const;
  /// Unless the task says how far off the recorded world and the clock of a program's run may be.
  void expect_recording_errors();
  void find_flights();
  void find_driven();
  /// Fewer modes, combinations that change most of what is compared.
  void keep_largest_modes();
  [[nodiscard]] std::vector<DrivenPath> driven_of(std::size_t motion, const Eigen::VectorXd& shares) const;
  [[nodiscard]] internal::SimulatedMotion simulate(const model::Scenario& scenario, const Job& job, double until) const;
  [[nodiscard]] internal::OwnValues own_values(const Eigen::VectorXd& values) const;

  model::SceneTask task_;
  std::vector<RecordedMotion> motions_;
  int threads_ = 1;
  model::Scenario base_;
  std::vector<std::vector<double>> base_numbers_;  ///< of each parameter's paths, for scales and offsets
  /// A body that a recording drives: its smoothed path, and paths that are as far off it as one deviation of an own
  /// unknown, the same one for all driven bodies of a recording.
  struct Driven {
    DrivenPath path;
    std::vector<DrivenPath> modes;
  };
  std::vector<std::vector<Driven>> driven_;        ///< of each motion
  Eigen::Index path_unknowns_ = 0;                 ///< that each motion has of its own: shares of modes
  std::vector<std::vector<std::size_t>> flights_;  ///< rows before the first touch, of each motion's bodies
  std::vector<std::vector<std::vector<std::size_t>>> samples_;  ///< that are compared, of each motion's bodies
  mutable std::vector<KnownRun> runs_;                          ///< the latest last
};

}  // namespace snug::identification
