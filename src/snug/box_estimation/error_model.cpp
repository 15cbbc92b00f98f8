// ErrorModel: what the camera's stated errors mean for planes and edges.
#include "snug/box_estimation/internal/error_model.hpp"

#include <cmath>

#include "snug/camera/loss.hpp"

namespace snug::box_estimation::internal {

ErrorModel::ErrorModel(const model::CameraParams& camera) : camera_(camera) {
  const double s = camera.errors.noise.correlation;
  if (s > 0.05) {
    // Sum of the correlations of a Gaussian cut to whole pixels with itself, along both directions.
    double sum = 0.0, squares = 0.0;
    for (int i = -40; i <= 40; ++i) {
      const double w = std::exp(-0.5 * i * i / (s * s));
      sum += w;
      squares += w * w;
    }
    likeness_ = std::pow(sum * sum / squares, 2);
  }
  const auto lost = camera::edge_loss(camera.errors.loss);
  for (std::size_t d = 0; d < lost.size(); ++d) {
    double p = lost[d];
    if (d == 0) p = 1.0 - (1.0 - p) * (1.0 - camera.errors.mixed_pixels.probability);
    edge_shift_ += p;
  }
  if (lost.empty()) edge_shift_ = camera.errors.mixed_pixels.probability;
}

double ErrorModel::point_noise(double depth) const {
  const double relative = depth / camera_.range.focus;
  return camera_.errors.noise.precision * relative * relative;
}

double ErrorModel::point_error(double depth) const {
  const model::Planarity& waves = camera_.errors.planarity;
  return std::sqrt(std::pow(point_noise(depth), 2) + waves.local * waves.local + waves.global * waves.global);
}

double ErrorModel::wave_covariance(double dcol, double drow) const {
  // A cubic spline over independent knots is alike with itself like a spline of degree 7: nearly a Gaussian of variance
  // 2/3 of a knot distance squared.
  const model::Planarity& waves = camera_.errors.planarity;
  const auto part = [square = dcol * dcol + drow * drow](double size, double length) {
    return size * size * std::exp(-0.75 * square / (length * length));
  };
  return part(waves.local, waves.local_length) + part(waves.global, waves.global_length);
}

camera::CommonError ErrorModel::common_error(const Vector3& p_CP) const {
  const model::HandEye& eye = camera_.errors.hand_eye;
  const model::Trueness& trueness = camera_.errors.trueness;
  camera::CommonError error = camera::CommonError::Zero();
  error.topLeftCorner<3, 3>() = -eye.rotation * skew(p_CP);  // of the camera about its own axes
  error.bottomLeftCorner<3, 3>() = eye.rotation * Matrix3::Identity();
  error.block<3, 3>(0, 3) = std::hypot(eye.position, trueness.position) * Matrix3::Identity();
  error.topRightCorner<3, 1>() = trueness.dimension * (p_CP - Vector3(0.0, 0.0, camera_.range.focus));
  return error;
}

}  // namespace snug::box_estimation::internal
