// RowCounts: which residuals of recordings are fitted: those of each body up to where its motion can be predicted.
#pragma once

#include <limits>
#include <vector>

#include "snug/identification/scene_experiment.hpp"

namespace snug::identification::internal {

/// Of each tracked body of each recording in a list, the first so many residuals, in order of time.
using RowCounts = std::vector<std::vector<Eigen::Index>>;

/// Those of samples up to a time, s on the recordings' clocks.
[[nodiscard]] RowCounts rows_until(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                                   const std::vector<double>& until);
[[nodiscard]] RowCounts fewer(const RowCounts& a, const RowCounts& b);
[[nodiscard]] RowCounts more(const RowCounts& a, const RowCounts& b);
[[nodiscard]] double total(const RowCounts& rows);
/// Of each recording in a list, the root of what each of its rows counts.
using RowWeights = std::vector<Eigen::VectorXd>;
/// Those of rows that count all the same.
[[nodiscard]] RowWeights equal_weights(const SceneExperiment& experiment, const std::vector<std::size_t>& motions);
/// What all of these rows count together: their number, where weights are equal.
[[nodiscard]] double total(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                           const RowCounts& rows, const RowWeights& weights);
/// Weighs the residuals of a recording; those beyond the first `rows` of each of its bodies become zero.
void weigh(const SceneExperiment& experiment, std::size_t motion, const std::vector<Eigen::Index>& rows,
           const Eigen::VectorXd& weights, Eigen::VectorXd& residuals);

/// Residuals around a point, recording by recording.
struct Neighbourhood {
  std::vector<Eigen::VectorXd> middle;
  std::vector<std::vector<Eigen::VectorXd>> up, down;  ///< of each parameter, moved there and back
  Eigen::VectorXd span;                                ///< from down to up
  std::vector<bool> is_between;                        ///< whether bounds let it go both ways
};

/// Of `within`, rows before what one step of a parameter does and what the opposite step does stop being each other's
/// opposite for good: what comes later no derivative predicts, as when a box tips one way or the other. `is_bent`: by
/// parameter, whether it is why. A body whose motion was bent before by B, a sum of squares of what both steps have in
/// common, says no more of the parameters than one number with a variance of B: `weights` of its rows become
/// 1 / sqrt(1 + B).
[[nodiscard]] RowCounts find_straight(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                                      const Neighbourhood& at, const RowCounts& within, std::vector<bool>& is_bent,
                                      RowWeights& weights);
/// Rows before a body begins to stay further from its recording than ten times what noise and parameters of this
/// covariance explain.
[[nodiscard]] RowCounts find_followed(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                                      const Neighbourhood& at, const Eigen::MatrixXd& covariance);

/// Rows before a body begins to stay, after a fit, further off than four times what noise and a sum of squares of
/// `misfit` a row explain.
[[nodiscard]] RowCounts find_explained(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                                       const std::vector<Eigen::VectorXd>& residuals, double misfit);

}  // namespace snug::identification::internal
