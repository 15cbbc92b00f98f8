// findings_of: moved, leaning, on the rim, of the wrong size.
#include "snug/box_estimation/internal/findings.hpp"

#include <cmath>
#include <numbers>

namespace snug::box_estimation {
namespace internal {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMovedDistance = 0.010, kMovedAngle = 3.0 * kDegree;
constexpr double kLeaning = 4.0 * kDegree;
constexpr double kRimSlack = 0.005;  // m
constexpr double kWrongSize = 3e-3;  // m
constexpr double kWrongSizeSigmas = 4.0;

bool has_moved(const BoxEstimate& estimate, const ExpectedBox& box) {
  const double distance = (estimate.X_WP.p - box.X_WP.p).norm(), angle = angle_between(estimate.X_WP.R, box.X_WP.R);
  return (distance > kMovedDistance && distance > 3.0 * box.position_spread) ||
         (angle > kMovedAngle && angle > 3.0 * box.rotation_spread);
}

bool is_on_rim(const BoxEstimate& estimate, const ExpectedBox& box, const EstimateInput& input) {
  const Vector3 reach = estimate.X_WP.R.cwiseAbs() * (0.5 * box.size);
  const Vector3 low = estimate.X_WP.p - reach, high = estimate.X_WP.p + reach;
  if (high.z() <= input.region_high.z() - 0.001 || input.region_high.z() >= 1e2) return false;
  return (low.head<2>().array() < input.region_low.head<2>().array() - kRimSlack).any() ||
         (high.head<2>().array() > input.region_high.head<2>().array() + kRimSlack).any();
}

}  // namespace

std::vector<Finding> findings_of(const BoxEstimate& estimate, const ExpectedBox& box, const EstimateInput& input,
                                 const Vector3& size_misfit, double size_error) {
  std::vector<Finding> findings;
  if (has_moved(estimate, box)) findings.push_back(Finding::Moved);
  if (estimate.X_WP.R.row(2).cwiseAbs().maxCoeff() < std::cos(kLeaning)) findings.push_back(Finding::Leaning);
  if (is_on_rim(estimate, box, input)) findings.push_back(Finding::OnRim);
  const double misfit = size_misfit.array().isFinite().select(size_misfit.array().abs(), 0.0).maxCoeff();
  if (size_error > kWrongSizeSigmas && misfit > kWrongSize) findings.push_back(Finding::WrongSize);
  return findings;
}

}  // namespace internal

const char* name_of(Sight sight) {
  constexpr const char* kNames[] = {"seen", "hidden", "missing"};
  return kNames[static_cast<int>(sight)];
}

const char* name_of(Finding finding) {
  constexpr const char* kNames[] = {"moved", "leaning", "on_rim", "wrong_size"};
  return kNames[static_cast<int>(finding)];
}

const char* name_of(FrameFault fault) {
  constexpr const char* kNames[] = {"none", "too_few_points", "view_blocked"};
  return kNames[static_cast<int>(fault)];
}

}  // namespace snug::box_estimation
