// PayloadEstimator: mass, centre of mass and inertia of what the cup holds, while the robot moves it.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "snug/identification/static_poses.hpp"

namespace snug::identification {

/// One instant. Times grow by about equal steps.
struct PayloadSample {
  double time = 0.0;              ///< s
  Pose X_WE;                      ///< of the gripper's end, from the joints
  Vector6 wrench_E;               ///< of the cup on the box, in E about E: the sensor's, less the gripper's own load
  std::optional<Pose> X_ES = {};  ///< of the lip where it is measured; else it follows from the wrench by the cup's law
};

struct PayloadSettings {
  Matrix6 K = Matrix6::Identity();  ///< of the cup in S1
  CupFrames frames;
  Vector3 gravity_W{0.0, 0.0, -9.81};
  /// Noise of a sample: of the wrench; of the pose of the lip, as the law gives it from that wrench.
  MeasurementNoise noise{2.0e-4, 4.0e-3, 0.3, 0.02};
  /// Standard deviation of what taring left, each axis of S: the empty gripper at rest for a second at 500 Hz.
  double force_bias = 0.015;   ///< N
  double torque_bias = 0.001;  ///< Nm
  double window = 0.2;         ///< s, over which motion and wrench are balanced; every half of it anew
  /// Before anything is known: standard deviations about a massless load.
  double mass_prior = 5.0;      ///< kg
  double moment_prior = 0.5;    ///< kg m, mass times centre of mass
  double inertia_prior = 0.02;  ///< kg m^2, about the lip
  /// m^2, inertia about the centre of mass over mass: what is expected, and its standard deviation. Boxes of the
  /// demonstrator: 0.0014 to 0.0083. Products of inertia: 0, half the deviation.
  double gyration_square = 0.005, gyration_square_prior = 0.003;
};

struct PayloadEstimate {
  SpatialInertia load_S;  ///< mass, centre of mass in S, inertia about it
  Eigen::Matrix<double, 10, 10> covariance =
      Eigen::Matrix<double, 10, 10>::Zero();  ///< mass, com, Ixx Iyy Izz Ixy Ixz Iyz
  int windows = 0;                            ///< balances used; 0: nothing is known yet

  [[nodiscard]] double mass_deviation() const;
  [[nodiscard]] Vector3 com_deviation() const;
};

/// Information filter over windows: forces and torques against changes of momentum, each multiplied by a smooth
/// function that vanishes at the window's ends, so that no acceleration is needed (docs/theory/identification.md,
/// section 7).
class PayloadEstimator {
 public:
  explicit PayloadEstimator(const PayloadSettings& settings);
  /// Time must grow.
  void add(const PayloadSample& sample);
  [[nodiscard]] PayloadEstimate estimate() const;

 private:
  struct Instant {
    double time;
    Pose X_WS;
    Vector6 wrench_S;
    Vector3 p_WE;
  };
  static constexpr int kUnknowns = 16;  // mass, moment (3), inertia about the lip (6), bias of force and torque
  void balance();

  PayloadSettings settings_;
  std::vector<Instant> instants_;  ///< of the window
  Eigen::MatrixXd information_;
  Eigen::VectorXd weighted_ = Eigen::VectorXd::Zero(kUnknowns);
  int windows_ = 0;
};

/// Pose of the lip at which the cup's spring gives this wrench (of the cup on the box, in E about E).
[[nodiscard]] Pose lip_under_wrench(const Matrix6& K, const CupFrames& frames, const Vector6& wrench_E);

}  // namespace snug::identification
