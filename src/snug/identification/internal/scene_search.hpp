// SceneSearch: the searches of identify_scene, with what they have found so far.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "snug/identification/internal/followed_rows.hpp"
#include "snug/identification/internal/search_log.hpp"
#include "snug/identification/scene_fit.hpp"
#include "snug/numerics/batched_least_squares.hpp"

namespace snug::identification::internal {

inline constexpr double kAlways = std::numeric_limits<double>::infinity();  ///< s, the end of no recording

struct SplitErrors {
  SceneError fitted, held_back;
  double held_back_error = 0.0;  ///< mm; not a number when nothing is held back
  double chi2_per_dof = 0.0;     ///< of what is fitted
  double numbers = 0.0;          ///< that chi2 is of
  double correlation = 0.0;      ///< of each residual with the next one of its body and axis
  double drift = 0.0;            ///< deviations by which an axis is off through parts of the recordings; see find_drift
  /// Whether residuals hang together by more than chance and a twentieth, or an axis is off through a part of all
  /// recordings: then it is no noise that is left.
  [[nodiscard]] bool is_systematic() const;
  /// What the squares of standard errors are to be enlarged by (docs/theory/scene-identification.md, 1).
  [[nodiscard]] double inflation() const;
};

/// Own unknowns are fitted to each recording, then its errors are returned.
[[nodiscard]] std::vector<MotionError> evaluate_all(const SceneExperiment& experiment, const Eigen::VectorXd& values);

class SceneSearch {
  /// What least squares are at: parameters, what recordings have of their own, how well they are known.
  struct Fitted {
    Eigen::VectorXd x, step;
    std::vector<Eigen::VectorXd> own;
    RowCounts rows;      ///< that are fitted
    RowCounts straight;  ///< that can be predicted
    RowWeights weights;
    double misfit = 1.0;  ///< sum of squares of a row, at least 1
    numerics::BatchedDerivatives derivatives;
    std::string message;
    bool is_solved = false;
  };

 public:
  SceneSearch(const SceneExperiment& experiment, const SceneFitOptions& options, std::vector<std::size_t> free);

  [[nodiscard]] const SceneExperiment& experiment() const { return experiment_; }
  /// Indices of the task's parameters that are searched.
  [[nodiscard]] const std::vector<std::size_t>& free() const { return free_; }
  /// The others stay where they are.
  void restrict_to(const std::vector<std::size_t>& free);
  [[nodiscard]] const Eigen::VectorXd& best() const { return best_; }
  [[nodiscard]] int evaluations() const { return evaluations_; }

  struct Derivatives {
    Eigen::MatrixXd information;   ///< of the free parameters, in units of the noise declared
    Eigen::VectorXd position_rms;  ///< m for each unit of each free parameter
    Eigen::VectorXd rotation_rms;  ///< rad
  };
  [[nodiscard]] Derivatives differentiate() const;

  /// Scatter, controlled random search, subplex, on the mean cost. Returns how it ended.
  std::string search_distance();
  /// Scatter, then least squares from the start and from the best point found. Where chi2 per degree of freedom stays
  /// above `rescue`, points are scattered even if none were asked for.
  std::string search_squares(double rescue);
  /// Least squares from where best() is, and nowhere else. Returns how it ended.
  std::string search_near();
  /// Of search_near or search_squares: bounded, per number; infinite where there was none.
  [[nodiscard]] double misfit() const { return misfit_; }
  /// Values of all parameters, the cheapest of `count` points spread over the bounds of the free ones.
  [[nodiscard]] std::vector<Eigen::VectorXd> spread_points(int count, std::size_t kept);
  /// Everything that was found so far is forgotten but the recordings: best() is there.
  void move_to(const Eigen::VectorXd& values);
  /// Rise of the sum of squares, all other free parameters and own unknowns fitted, with the free parameter `index` at
  /// each of these values; not a number where nothing could be simulated.
  [[nodiscard]] std::vector<double> profile(std::size_t index, const std::vector<double>& values);
  /// Of all parameters; zero where one is not free. Squares: inverse information, as far as the sum of squares rises as
  /// it says, enlarged by chi2 per degree of freedom above 1. Distance: from the scatter of the recordings' slopes and
  /// the curvature of the mean.
  [[nodiscard]] Eigen::MatrixXd covariance();
  [[nodiscard]] SplitErrors errors_at(const Eigen::VectorXd& values) const;
  [[nodiscard]] std::vector<Unpredictable> unpredictable() const;

  /// What was found, to come back to.
  struct Kept {
    Eigen::VectorXd best;
    std::optional<Fitted> result;
    std::vector<std::size_t> free;
    double misfit = std::numeric_limits<double>::infinity();
  };
  [[nodiscard]] Kept keep() const { return {best_, result_, free_, misfit_}; }
  void go_back(const Kept& kept);

 private:
  [[nodiscard]] Eigen::VectorXd full(const Eigen::VectorXd& free_values) const;
  [[nodiscard]] Eigen::VectorXd free_of(const Eigen::VectorXd& values) const;
  /// Around a point, of the rows named; `prior`: standard deviations of the parameters about it, or empty.
  [[nodiscard]] numerics::BatchedProblem problem(const Fitted& at, double until, const Eigen::VectorXd& prior) const;
  [[nodiscard]] Fitted unfitted(const Eigen::VectorXd& start) const;
  /// Mean cost over the recordings fitted, of each point; known ones come from the log.
  std::vector<double> costs(const std::vector<Eigen::VectorXd>& points, const char* phase);
  double cost(const Eigen::VectorXd& point, const char* phase);
  /// Latin hypercube over the bounds.
  [[nodiscard]] std::vector<Eigen::VectorXd> scattered(int count) const;
  void take(const Eigen::VectorXd& free_values, double cost, const char* phase);
  /// Recording by recording as far as simulation follows, over longer and longer parts of the time.
  [[nodiscard]] Fitted least_squares_from(const Eigen::VectorXd& start) const;
  /// Least squares of at.rows. Rows that were not fitted `before` and stay unexplained are taken out again: a body that
  /// goes another way says nothing of the parameters.
  [[nodiscard]] numerics::BatchedResult solve_explained(double until, const Eigen::VectorXd& prior,
                                                        const numerics::BatchedOptions& options,
                                                        const std::optional<RowCounts>& before, Fitted& at) const;
  bool solve_stage(double horizon, bool is_last, Eigen::MatrixXd& covariance, Fitted& at) const;
  [[nodiscard]] Neighbourhood look_around(const Fitted& at, double until) const;
  /// Along some of the parameters.
  void look(const Fitted& at, double until, const std::vector<std::size_t>& along, Neighbourhood& found) const;
  struct Straight {
    Neighbourhood around;
    RowCounts rows;  ///< that can be predicted
    RowWeights weights;
  };
  /// `may_widen`: at.step becomes larger where small steps show only roughness.
  [[nodiscard]] Straight find_straight_rows(double until, const RowCounts& within, bool may_widen, Fitted& at) const;
  /// Of the free parameters: what the rate of the clock that recorded does to them.
  [[nodiscard]] Eigen::MatrixXd clock_covariance(const Fitted& at, const numerics::BatchedDerivatives& found) const;
  [[nodiscard]] Eigen::MatrixXd distance_covariance();
  /// Shifts of the free parameters at which the mean cost has risen by more than its roughness.
  [[nodiscard]] Eigen::VectorXd curvature_steps(const Eigen::VectorXd& middle);
  void judge_misfit(const std::vector<MotionError>& errors, SplitErrors& split) const;
  /// Of the rows that can be predicted, each bounded: what starts are compared by.
  [[nodiscard]] double bounded_misfit(const Fitted& at) const;
  /// Samples that rows of a body are the means of.
  [[nodiscard]] double count_samples(std::size_t motion, std::size_t body, Eigen::Index begin, Eigen::Index end) const;

  const SceneExperiment& experiment_;
  const SceneFitOptions& options_;
  std::vector<std::size_t> free_;
  std::vector<std::size_t> fitted_, held_;  ///< recordings
  bool holds_ends_ = false;                 ///< the end of each recording is held back instead
  RowCounts fitted_rows_;                   ///< before what is held back
  std::optional<Fitted> result_;            ///< of least squares, the best
  Eigen::VectorXd best_, lower_, upper_, step_;
  double best_cost_;
  double misfit_ = std::numeric_limits<double>::infinity();
  mutable int evaluations_ = 0;
  SearchLog log_;
};

}  // namespace snug::identification::internal
