// identify_damping: the cup's damping from free oscillations after a release, by output error.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/identification/releases.hpp"

namespace snug::identification {

/// How a load moves when its record begins.
enum class ReleaseStart {
  Auto,   ///< at rest, unless the records contradict that
  Rest,   ///< at rest; only the pose is unknown
  Moving  ///< pose and velocity are unknown
};

struct DampingOptions {
  model::CupElasticity prior = model::CupParams{}.damping;
  /// Of the cup, for releases that bring none.
  Matrix6 K = Matrix6::Zero();
  ReleaseStart start = ReleaseStart::Auto;
  bool with_coupling = false;   ///< also the damping that couples shear and bending at S1
  bool with_stiffness = false;  ///< the five stiffnesses too, from K on: a wrong frequency looks like damping
};

/// One release by itself.
struct ReleaseFit {
  std::string name;
  std::vector<Parameter> parameters;
  double chi2_per_dof = 0.0;
  double position = 0.0;      ///< m, root mean square of measured less simulated
  double rotation = 0.0;      ///< rad
  std::vector<int> outliers;  ///< samples left out: beyond 6 standard deviations of the rest
};

struct DampingFit {
  std::vector<Parameter> parameters;  ///< d_lat, d_ax, d_bend, d_tors, perhaps d_c and the k's
  Eigen::MatrixXd covariance;
  model::CupElasticity damping;                   ///< of S1; prior's coupling unless asked for
  std::optional<model::CupElasticity> stiffness;  ///< when asked for
  double chi2_per_dof = 0.0;
  int degrees_of_freedom = 0;
  ReleaseStart start = ReleaseStart::Rest;  ///< what was assumed in the end
  std::vector<ReleaseFit> releases;         ///< each fitted alone, when there are several
  /// Do the releases, each fitted alone, agree within their errors (chance of 1 in 1000 to be wrong)?
  bool releases_agree = true;
  int iterations = 0;
};

/// docs/theory/identification.md, section 6. Throws InputError when the data cannot be used.
[[nodiscard]] DampingFit identify_damping(const std::vector<Release>& releases, const DampingOptions& options = {});

/// The last third of every release is predicted from a fit of the first two.
[[nodiscard]] HeldBackError compute_held_back_error(const std::vector<Release>& releases, const DampingOptions& options,
                                                    const DampingFit& fit);

}  // namespace snug::identification
