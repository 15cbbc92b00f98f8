// identify_stiffness: the cup's stiffness from a held load at rest in several poses.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/identification/static_poses.hpp"

namespace snug::identification {

enum class StiffnessMethod {
  Wrench,            ///< least squares of the wrench: exact without noise, biased low by the noise of the poses
  Compliance,        ///< least squares of the deformation, compensated for the noise of the wrench
  ErrorsInVariables  ///< maximum likelihood: poses and wrenches are both noisy
};
enum class WrenchSource {
  Sensor,  ///< measured
  Gravity  ///< of the known payload at the pose measured
};
enum class StiffnessForm {
  Symmetric,  ///< the 5 numbers of a cup that looks the same from all sides
  Full        ///< the 21 of a symmetric matrix
};
[[nodiscard]] const char* name_of(StiffnessMethod method);
[[nodiscard]] const char* name_of(WrenchSource source);

struct StiffnessOptions {
  StiffnessMethod method = StiffnessMethod::Compliance;
  std::optional<WrenchSource> wrench;  ///< nothing: the sensor's where every pose has one, else gravity's
  StiffnessForm form = StiffnessForm::Symmetric;
  /// Where a parameter that the data do not know stays, give or take a thousand times.
  model::CupElasticity prior = model::CupParams{}.stiffness;
};

/// Do the data contradict a cup that looks the same from all sides? The 16 conditions that make 5 numbers of 21,
/// tested on the compliance fit with 21 (Wald test).
struct SymmetryTest {
  double statistic = 0.0;    ///< chi-square with 16 degrees of freedom when the symmetry holds
  double p_value = 1.0;      ///< chance of a larger one then
  bool is_supported = true;  ///< p_value of 1 % or more
  std::string worst;         ///< the condition that is missed most, for people
  bool operator==(const SymmetryTest&) const = default;
};

/// What the force/torque sensor reads too much, in the gripper's frame about the lip.
struct SensorBias {
  Wrench bias;                      ///< N, Nm
  Wrench error;                     ///< standard errors
  bool is_against_gravity = false;  ///< found from known loads; else an unknown beside the cup's numbers
  double statistic = 0.0;           ///< chi-square with 6 degrees of freedom when there is none
  double misfit = 0.0;              ///< against gravity: what a constant leaves of the difference, chi2 per number
  bool is_removed = false;          ///< the fit is of the wrenches without it
  bool operator==(const SensorBias&) const = default;
};

struct StiffnessFit {
  StiffnessMethod method = StiffnessMethod::Compliance;
  WrenchSource wrench = WrenchSource::Sensor;
  std::vector<Parameter> parameters;  ///< k_lat, k_ax, k_bend, k_tors, c; or the upper triangle, row by row
  Matrix6 K = Matrix6::Zero();        ///< in S1
  Eigen::MatrixXd covariance;         ///< of the parameters
  model::CupElasticity elasticity;    ///< the five numbers nearest to K
  double chi2_per_dof = 0.0;          ///< squared misfit in units of the noise declared, per degree of freedom
  int degrees_of_freedom = 0;
  double position = 0.0;                 ///< m, root mean square of measured less predicted place of the lip
  double rotation = 0.0;                 ///< rad, of its orientation
  std::vector<int> outliers;             ///< indices of poses left out: beyond 6 standard deviations of the rest
  int poses = 0;                         ///< used
  std::optional<SymmetryTest> symmetry;  ///< of the symmetric form, with enough poses
  std::optional<SensorBias> bias;        ///< of the sensor's wrenches, with enough poses
  /// False: more than twice the noise is left (chi2_per_dof above 4): the law of the cup does not explain these data.
  bool is_explained = true;
};

/// Standard errors follow from the noise declared, and grow with the root of chi2_per_dof where that is above 1. Above
/// 1.5 nothing is called identified, above 4 nothing is called known at all. A bias of the sensor is removed where it
/// is no chance (one in a million), and its error is in those of the numbers.
/// docs/theory/identification.md. Throws InputError when the data cannot be used: too few poses, no wrench of the kind
/// asked for, wrenches that pull against the deformation.
[[nodiscard]] StiffnessFit identify_stiffness(const StaticPoses& poses, const StiffnessOptions& options = {});

/// Every fifth pose in turn is predicted by the fit of the others. Poses that `fit` left out stay out.
[[nodiscard]] HeldBackError compute_held_back_error(const StaticPoses& poses, const StiffnessOptions& options,
                                                    const StiffnessFit& fit);

}  // namespace snug::identification
