// DhTable: Denavit-Hartenberg parameters of an arm, and the deviations from them that a manufacturer measured.
#pragma once

#include <array>
#include <filesystem>
#include <string>

#include "snug/robot/arm.hpp"

namespace snug::calibration {

/// One joint: Rz(theta + q) Tz(d) Tx(a) Rx(alpha).
struct DhRow {
  double theta = 0.0;  ///< rad
  double d = 0.0;      ///< m
  double a = 0.0;      ///< m
  double alpha = 0.0;  ///< rad
  bool operator==(const DhRow&) const = default;
};

using DhTable = std::array<DhRow, 6>;

/// Pose of the last frame in the first: K(DH, q) of report eq. 15.
[[nodiscard]] Pose forward(const DhTable& table, const robot::JointVector& q);

/// Rows of a and b added.
[[nodiscard]] DhTable add(const DhTable& a, const DhTable& b);

/// The table of an arm whose joint frames are those of a DH chain, as in a URDF of a UR: between frame i and i + 1 the
/// origin is Tx(a) Rx(alpha) Rz(theta) Tz(d). InputError (naming `source`) when the arm has not six such joints.
[[nodiscard]] DhTable nominal_dh(const robot::ArmModel& arm, const std::string& source);

/// A controller's calibration.conf: section [mounting], delta_theta, delta_a, delta_d, delta_alpha = [6 numbers].
[[nodiscard]] DhTable load_deltas(const std::filesystem::path& path);
[[nodiscard]] DhTable parse_deltas(const std::string& text, const std::string& name);

}  // namespace snug::calibration
