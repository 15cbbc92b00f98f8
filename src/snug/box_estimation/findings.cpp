// findings_of: moved, leaning, on the rim, of the wrong size.
#include "snug/box_estimation/internal/findings.hpp"

#include <cmath>

namespace snug::box_estimation {
namespace internal {
namespace {

bool has_moved(const BoxEstimate& estimate, const ExpectedBox& box, const FindingSettings& settings) {
  const double distance = (estimate.X_WP.p - box.X_WP.p).norm(), angle = angle_between(estimate.X_WP.R, box.X_WP.R);
  return (distance > settings.moved_distance && distance > settings.moved_deviations * box.position_spread) ||
         (angle > settings.moved_angle && angle > settings.moved_deviations * box.rotation_spread);
}

bool is_on_rim(const BoxEstimate& estimate, const ExpectedBox& box, const EstimateInput& input,
               const FindingSettings& settings) {
  const Vector3 reach = estimate.X_WP.R.cwiseAbs() * (0.5 * box.size);
  const Vector3 low = estimate.X_WP.p - reach, high = estimate.X_WP.p + reach;
  if (high.z() <= input.region_high.z() - 0.001 || input.region_high.z() >= 1e2) return false;
  return (low.head<2>().array() < input.region_low.head<2>().array() - settings.rim_slack).any() ||
         (high.head<2>().array() > input.region_high.head<2>().array() + settings.rim_slack).any();
}

}  // namespace

std::vector<Finding> findings_of(const BoxEstimate& estimate, const ExpectedBox& box, const EstimateInput& input,
                                 const SizeMisfit& size, const FindingSettings& settings) {
  std::vector<Finding> findings;
  if (has_moved(estimate, box, settings)) findings.push_back(Finding::Moved);
  if (estimate.X_WP.R.row(2).cwiseAbs().maxCoeff() < std::cos(settings.leaning)) findings.push_back(Finding::Leaning);
  if (is_on_rim(estimate, box, input, settings)) findings.push_back(Finding::OnRim);
  const double misfit = size.misfit.array().isFinite().select(size.misfit.array().abs(), 0.0).maxCoeff();
  if (size.deviations > settings.wrong_size_deviations && misfit > settings.wrong_size)
    findings.push_back(Finding::WrongSize);
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
