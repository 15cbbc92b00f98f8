// CupPoses: a cup deformed by a robot, wrench read in many poses; a law of it that is the gradient of one potential.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/model/cup_law.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::identification {

/// Poses of one end of a cup in the frame B of the other, and wrenches of the cup as a sensor reads them: axes of B
/// (N, Nm), about a point that is not known. In the order in which they were measured: the sensor's zero may drift.
struct CupPoses {
  std::string source;
  std::vector<Pose> poses;        ///< X_BS
  std::vector<Vector6> wrenches;  ///< force, torque
};

/// CSV (docs/formats.md, cup poses). Throws InputError with file, line and column.
[[nodiscard]] CupPoses load_cup_poses(const std::filesystem::path& path);
[[nodiscard]] CupPoses parse_cup_poses(const std::string& text, const std::string& name);

/// Axisymmetric cup whose axial force is a polynomial of its compression and whose lateral, bending and coupling
/// stiffness change with it (docs/theory/cup.md, section 8): wrench = -J^T dV/dq, so that it stores what it takes.
struct PotentialLaw {
  Vector3 centre_B = Vector3::Zero();     ///< m: there the spring's two frames coincide where nothing deforms them
  double rest = 0.0;                      ///< m, along Bz: the least compressed pose, taken for that of no deformation
  Vector3 reference_B = Vector3::Zero();  ///< m: the sensor's torque is about it
  double middle = 0.0;                    ///< m, along Bz from `rest`: where u = 0
  double half_range = 1.0;                ///< m: from there to u = 1
  Eigen::VectorXd coefficients;           ///< in the order of coefficient_names()
  Eigen::Matrix<double, 6, 7> linear = Eigen::Matrix<double, 6, 7>::Zero();  ///< on (1, p_BS, rotation), to compare
};
/// axial_0 .. (N), lateral_0 .. (N/m), bend_0 .. (Nm/rad), coupling_0 .. (N), torsion_0 .. (Nm/rad) of powers of u, and
/// the sensor's zero, the mean where it drifts, tare_fx .. tare_tz.
[[nodiscard]] std::vector<std::string> coefficient_names();
[[nodiscard]] std::string unit_of_coefficient(const std::string& name);

/// What the sensor reads at this pose, N and Nm.
[[nodiscard]] Vector6 predict_wrench(const PotentialLaw& law, const Pose& X_BS);
/// V, J; zero where u = 0 without rotation or shift across.
[[nodiscard]] double stored_energy(const PotentialLaw& law, const Pose& X_BS);
/// The law of a scenario's cup, with the sign of a cup's force whichever side the sensor reads.
[[nodiscard]] model::CupLaw cup_law_of(const PotentialLaw& law);

/// Root mean squares over poses of predicted less measured, each component divided by its standard deviation in the
/// file: 1 says no more than the mean does. A zero that drifts is found from the other poses of the file.
struct PoseErrors {
  double normalised = 0.0;               ///< of the law, with the zero, constant or drifting, that predicts better
  bool zero_drifts = false;              ///< which of them that is
  double constant_zero = 0.0;            ///< of the law with a constant zero
  double drifting_zero = 0.0;            ///< of the law with a drifting zero
  double linear = 0.0;                   ///< of the linear fit, which need not be passive, with a constant zero
  double linear_drifting = 0.0;          ///< the same with a drifting zero
  Vector6 components = Vector6::Zero();  ///< of the law: fx, fy, fz, tx, ty, tz
};
inline constexpr double kExplainedComponent = 0.5;  ///< of a standard deviation: three quarters of the variance
/// Components, by name, of which the law leaves more than that.
[[nodiscard]] std::vector<std::string> find_unexplained(const PoseErrors& errors);

struct PoseFit {
  PotentialLaw law;
  std::vector<Parameter> parameters;  ///< standard errors: jackknife over the five parts held back
  PoseErrors held_back;               ///< each fifth pose in turn predicted from the others; frames are those of all
};

/// Throws InputError: too few poses, a component or the compression that does not change.
[[nodiscard]] PoseFit fit_pose_law(const CupPoses& poses);
[[nodiscard]] PoseErrors evaluate_pose_law(const CupPoses& poses, const PotentialLaw& law);

/// The law as YAML, and read again; InputError with file, line and key.
[[nodiscard]] std::string format_pose_law(const PoseFit& fit, const std::string& note);
[[nodiscard]] PotentialLaw load_pose_law(const std::filesystem::path& path);

}  // namespace snug::identification
