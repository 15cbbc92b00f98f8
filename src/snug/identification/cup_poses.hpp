// CupPoses: a cup deformed by a robot, wrench read in many poses; a law of it that is the gradient of one potential.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::identification {

/// Poses of one end of a cup in the frame B of the other, and wrenches of the cup as a sensor reads them: axes of B
/// (N, Nm), about a point that is not known.
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
  Vector3 centre_B = Vector3::Zero();     ///< m: there the spring's two frames coincide in the pose at zero
  Vector3 reference_B = Vector3::Zero();  ///< m: the sensor's torque is about it
  double middle = 0.0;                    ///< m, along Bz: where u = 0
  double half_range = 1.0;                ///< m: from there to u = 1
  Eigen::VectorXd coefficients;           ///< in the order of coefficient_names()
  Eigen::Matrix<double, 6, 7> linear = Eigen::Matrix<double, 6, 7>::Zero();  ///< on (1, p_BS, rotation), to compare
};
/// axial_0 .. (N), lateral_0 .. (N/m), bend_0 .. (Nm/rad), coupling_0 .. (N), torsion_0 .. (Nm/rad) of powers of u, and
/// the constant that the sensor reads, tare_fx .. tare_tz.
[[nodiscard]] std::vector<std::string> coefficient_names();
[[nodiscard]] std::string unit_of_coefficient(const std::string& name);

/// What the sensor reads at this pose, N and Nm.
[[nodiscard]] Vector6 predict_wrench(const PotentialLaw& law, const Pose& X_BS);
/// V, J; zero in the pose at zero compression coordinate u = 0 and no rotation or shift across.
[[nodiscard]] double stored_energy(const PotentialLaw& law, const Pose& X_BS);

/// Root mean squares over poses of predicted less measured, each component divided by its standard deviation in the
/// file: 1 says no more than the mean does.
struct PoseErrors {
  double normalised = 0.0;
  double linear = 0.0;                   ///< the same of the linear fit, which need not be passive
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
