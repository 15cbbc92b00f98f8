// Arms with calibrated joint frames: from a DH table, and brought near to the nominal frames.
#include "snug/calibration/exact_arm.hpp"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "snug/calibration/internal/frames.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/robot/kinematics.hpp"

namespace snug::calibration {
namespace {

constexpr int kSamples = 1000;
constexpr double kFarthestFrame = 0.1;     ///< m
constexpr double kLargestFrameTurn = 0.2;  ///< rad

/// All joints zero, then uniform in +-pi; the same ones always.
std::vector<robot::JointVector> sample_joints(int joints) {
  std::vector<robot::JointVector> samples = {robot::JointVector::Zero(joints)};
  Rng rng = Rng(1).split("calibration samples");
  for (int k = 0; k < kSamples; ++k) {
    robot::JointVector q(joints);
    for (int i = 0; i < joints; ++i) q(i) = rng.uniform(-std::numbers::pi, std::numbers::pi);
    samples.push_back(q);
  }
  return samples;
}

/// Slide along the joint's axis and turn about it.
Pose on_axis(const robot::Joint& joint, double slide, double turn) {
  return {exp_rotation(turn * joint.axis), slide * joint.axis};
}

void widen(FrameShift& shift, const Pose& X_WA, const Pose& X_WB) {
  shift.position = std::max(shift.position, (X_WA.p - X_WB.p).norm());
  shift.angle = std::max(shift.angle, angle_between(X_WA.R, X_WB.R));
}

}  // namespace

robot::ArmModel arm_from_dh(const robot::ArmModel& nominal, const DhTable& table) {
  robot::ArmModel arm = nominal;
  Pose across;  // Tx(a) Rx(alpha) of the row before
  for (std::size_t i = 0; i < table.size(); ++i) {
    const Pose along{internal::turn_z(table[i].theta), Vector3(0.0, 0.0, table[i].d)};
    const Pose& X_SL = nominal.links[static_cast<std::size_t>(internal::joint_parent(nominal, i))].X_SL;
    arm.joints[i].X_SJ = X_SL * across * along;
    across = {internal::turn_x(table[i].alpha), Vector3(table[i].a, 0.0, 0.0)};
  }
  if (table.back().a != 0.0 || table.back().alpha != 0.0) internal::move_end(arm, across);
  return arm;
}

robot::ArmModel with_frames_near(const robot::ArmModel& exact, const robot::ArmModel& nominal) {
  const std::size_t n = exact.joints.size();
  std::vector<double> slide(n, 0.0);
  std::vector<Matrix3> turned(n, Matrix3::Zero());
  const std::vector<robot::JointVector> samples = sample_joints(exact.joint_count());
  for (const robot::JointVector& q : samples) {
    const robot::ArmPose at = robot::forward(exact, q);
    const robot::ArmPose wanted = robot::forward(nominal, q);
    for (std::size_t i = 0; i < n; ++i) {
      slide[i] += at.axis_W[i].dot(wanted.X_WS[i + 1].p - at.X_WS[i + 1].p) / static_cast<double>(samples.size());
      turned[i] += at.X_WS[i + 1].R.transpose() * wanted.X_WS[i + 1].R;
    }
  }
  robot::ArmModel near = exact;
  Pose before;  // of the frame before, to be undone
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3& axis = exact.joints[i].axis;
    const Matrix3& M = turned[i];
    const Vector3 w(M(2, 1) - M(1, 2), M(0, 2) - M(2, 0), M(1, 0) - M(0, 1));
    const double turn = std::atan2(axis.dot(w), M.trace() - axis.dot(M * axis));
    const Pose G = i + 1 < n ? on_axis(exact.joints[i], slide[i], turn) : Pose{};
    near.joints[i].X_SJ = before.inverse() * exact.joints[i].X_SJ * G;
    before = G;
  }
  return near;
}

FrameShift largest_origin_shift(const robot::ArmModel& a, const robot::ArmModel& b) {
  FrameShift shift;
  for (std::size_t i = 0; i < a.joints.size(); ++i)
    widen(shift, internal::joint_origin(a, i), internal::joint_origin(b, i));
  return shift;
}

FrameShift largest_frame_shift(const robot::ArmModel& a, const robot::ArmModel& b) {
  FrameShift shift;
  for (const robot::JointVector& q : sample_joints(a.joint_count())) {
    const robot::ArmPose at_a = robot::forward(a, q);
    const robot::ArmPose at_b = robot::forward(b, q);
    for (std::size_t i = 1; i <= a.joints.size(); ++i) widen(shift, at_a.X_WS[i], at_b.X_WS[i]);
  }
  return shift;
}

void check_same_arm(const robot::ArmModel& arm, const robot::ArmModel& nominal, const std::string& where) {
  const robot::ArmModel near = with_frames_near(arm, nominal);
  const robot::ArmPose at = robot::forward(near, robot::JointVector::Zero(arm.joint_count()));
  const robot::ArmPose wanted = robot::forward(nominal, robot::JointVector::Zero(arm.joint_count()));
  for (std::size_t i = 0; i < arm.joints.size(); ++i) {
    FrameShift shift;
    widen(shift, at.X_WS[i + 1], wanted.X_WS[i + 1]);
    if (shift.position <= kFarthestFrame && shift.angle <= kLargestFrameTurn) continue;
    char got[120];
    std::snprintf(got, sizeof got, "its frame %.4g m and %.4g rad from that of the nominal arm", shift.position,
                  shift.angle);
    throw InputError(where, arm.joints[i].name, got,
                     "deviations of this arm, in metres and radians: frames within 0.1 m and 0.2 rad");
  }
}

FrameShift largest_end_error(const robot::ArmModel& arm, const robot::ArmModel& nominal, const DhTable& table) {
  FrameShift shift;
  const Pose X_base = nominal.X_WB * nominal.links[static_cast<std::size_t>(internal::joint_parent(nominal, 0))].X_SL;
  for (const robot::JointVector& q : sample_joints(arm.joint_count()))
    widen(shift, X_base * forward(table, q) * nominal.X_SE, robot::forward_tool(arm, q));
  return shift;
}

}  // namespace snug::calibration
