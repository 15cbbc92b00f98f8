// identify_scene: numbers of a scenario with which simulated bodies follow recorded ones.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/identification/scene_experiment.hpp"

namespace snug::identification {

/// What one step of a parameter does to the simulations, at the values found.
struct Sensitivity {
  std::string name;
  double step = 0.0;
  double position_mm = 0.0;  ///< root mean square over all samples
  double rotation_deg = 0.0;
  double error_alone = 0.0;     ///< standard error if it were the only unknown
  double error_together = 0.0;  ///< with all others unknown too; infinite where the data cannot tell
};

/// A combination of parameters that the recordings do not tell. Shares are of what the bounds span; signs matter.
struct UnknownDirection {
  std::vector<std::pair<std::string, double>> shares;
  double error = 0.0;  ///< standard error along it, in spans of the bounds
};

/// Samples that jumped away from their neighbours: left out.
struct Rejected {
  std::string recording, body;
  int samples = 0;
};

/// A driven body's path (DrivenPath): the noise found in its samples, and up to which frequency it was followed.
struct Smoothing {
  std::string recording, body;
  double position_noise = 0.0;                                ///< m, of each axis
  double rotation_noise = 0.0;                                ///< rad
  double position_bandwidth = 0.0, rotation_bandwidth = 0.0;  ///< Hz
};

/// How the sum of squares rises with one parameter, all others fitted again at each value.
struct Profile {
  std::string name;
  std::vector<double> values,
      rises;  ///< rises: in units of the misfit's own variance, 3.84 at the ends of the interval
  /// 95 % interval; infinite where the sum does not rise enough within four standard errors and the bounds.
  double low = 0.0, high = 0.0;
};

/// From this time on a body's motion hangs on less than the parameters' errors (it tips one way or the other): it was
/// not fitted, and does not count against the fit.
struct Unpredictable {
  std::string recording, body;
  double from = 0.0;  ///< s, on the recording's clock
};

struct SceneFitProgress {
  int evaluations = 0;  ///< of the whole set
  double cost = 0.0;    ///< best so far
  const char* phase = "";
};

struct SceneFitOptions {
  /// Evaluated points are added to it, and those of an earlier run are not computed again; empty: none.
  std::filesystem::path log;
  std::function<void(const SceneFitProgress&)> progress;
  bool with_errors = true;    ///< standard errors, which need more simulations
  bool with_profile = false;  ///< SceneFit::profiles, which need many more; least squares only
};

struct SceneFit {
  std::vector<Parameter> parameters;  ///< all of the task, in its order
  Eigen::VectorXd values;             ///< of all parameters
  /// Of all; zero where one is fixed. What is not told stays where it is, known to what its bounds say (uniform), and
  /// what it does to the others is in their errors.
  Eigen::MatrixXd covariance;
  double chi2_per_dof = 0.0;               ///< with the noise declared
  double held_back_error = 0.0;            ///< mm, cost on what was kept out of the fit; not a number when nothing was
  SceneError before, fitted;               ///< of the recordings fitted, at the start and at the end
  SceneError held_back_before, held_back;  ///< of those held back
  std::vector<Sensitivity> sensitivity;
  std::vector<UnknownDirection> unknown;
  std::vector<Unpredictable> unpredictable;
  std::vector<Profile> profiles;
  std::vector<Rejected> rejected;
  std::vector<Smoothing> smoothed;
  int evaluations = 0;
  bool is_systematic = false;  ///< residuals hang together: no noise; nothing is then called identified
  bool is_trusted = true;      ///< false: the simulation misses the recordings by far more than noise
  std::string message;         ///< how the search ended
};

/// Held back: each so many-th recording of the task; where there are too few recordings, the end of each.
/// The same experiment gives the same numbers at any number of threads. Throws InputError for a log of another task.
[[nodiscard]] SceneFit identify_scene(const SceneExperiment& experiment, const SceneFitOptions& options = {});

/// Errors of the task's present values on all recordings; own unknowns are fitted to each recording first.
[[nodiscard]] std::vector<MotionError> evaluate_scene(const SceneExperiment& experiment, const Eigen::VectorXd& values);

}  // namespace snug::identification
