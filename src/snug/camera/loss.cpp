// What part of the points near edges of depth and on grazing faces is lost.
#include "snug/camera/loss.hpp"

#include <algorithm>
#include <cmath>

namespace snug::camera {

std::vector<float> edge_loss(const model::PointLoss& loss) {
  std::vector<float> probabilities;
  for (int d = 1; d <= 40; ++d) {
    const double x = (d - 0.5) / loss.edge_width;  // the middle of the pixel
    const double p = loss.edge * std::exp(-x * x);
    if (p < 0.005) break;
    probabilities.push_back(static_cast<float>(p));
  }
  return probabilities;
}

double edge_loss_at_ridge(double ridge, double step) {
  // Each surface continued to the other's pixel is nearer to it by the part of step / ridge on its own side.
  return std::clamp(1.0 - 2.0 * kEdgeOfDepth * ridge / step, 0.0, 1.0);
}

GrazingLoss::GrazingLoss(const model::PointLoss& loss)
    : onset_(static_cast<float>(std::cos(loss.grazing_onset))),
      full_(static_cast<float>(std::cos(loss.grazing_full))) {}

}  // namespace snug::camera
