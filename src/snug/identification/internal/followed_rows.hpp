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
[[nodiscard]] double total(const RowCounts& rows);
/// Sets the residuals of a recording to zero beyond the first `rows` of each of its bodies, so that they do not count.
void keep_rows(const SceneExperiment& experiment, std::size_t motion, const std::vector<Eigen::Index>& rows,
               Eigen::VectorXd& residuals);

/// Residuals around a point, recording by recording.
struct Neighbourhood {
  std::vector<Eigen::VectorXd> middle;
  std::vector<std::vector<Eigen::VectorXd>> up, down;  ///< of each parameter, moved there and back
  Eigen::VectorXd span;                                ///< from down to up
  std::vector<bool> is_between;                        ///< whether bounds let it go both ways
};

/// Of `within`, rows before what one step of a parameter does and what the opposite step does stop being each other's
/// opposite for good: what comes later no derivative predicts, as when a box tips one way or the other. `is_bent`: by
/// parameter, whether it is why.
[[nodiscard]] RowCounts find_straight(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                                      const Neighbourhood& at, const RowCounts& within, std::vector<bool>& is_bent);
/// `straight`, but for bodies whose recording is further off than what the steps change there: with these, that a
/// motion cannot be predicted does not explain where it went, and all rows count, `within`.
[[nodiscard]] RowCounts excused(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                                const Neighbourhood& at, const RowCounts& straight, const RowCounts& within);
/// Rows before a body begins to stay further from its recording than ten times what noise and parameters of this
/// covariance explain.
[[nodiscard]] RowCounts find_followed(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                                      const Neighbourhood& at, const Eigen::MatrixXd& covariance);

}  // namespace snug::identification::internal
