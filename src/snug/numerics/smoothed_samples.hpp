// SmoothedSamples: a curve through noisy samples, as smooth as the samples themselves say, and where they say it.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace snug::numerics {

/// m numbers at n times: the least sum of squared residuals plus stiffness times the sum of squared second derivatives
/// (Whittaker 1923), each times its weight.
struct SmoothedSamples {
  std::vector<double> times;  ///< s, n of them
  Eigen::MatrixXd values;     ///< n x m
  Eigen::VectorXd stiffness;  ///< of each second derivative, n - 2, s^3; empty: the samples are followed exactly
  double unknowns = 0.0;      ///< degrees of freedom of each of the m curves, 2 (a line) to n
  double noise = 0.0;         ///< standard deviation of one number of a sample, from the residuals
  /// Hz: as many unknowns in the same time tell frequencies up to this one.
  [[nodiscard]] double bandwidth() const;
};

/// `samples`: n x m at `times`, s, which grow strictly. The stiffness is that with the least generalised
/// cross-validation score, degrees of freedom counted 1.4 times (Craven and Wahba 1979; Kim and Gu 2004), all m curves
/// together; where plain counting is clearly better, as for exact samples, that is taken. It is chosen three times:
/// first equal everywhere, then weighted by the inverse of the square of the second derivative found around each time:
/// where a body rests or goes straight more noise is taken out than where it brakes. Fewer than five samples, and such
/// without noise, are followed exactly.
[[nodiscard]] SmoothedSamples smooth_samples(const std::vector<double>& times, const Eigen::MatrixXd& samples);
/// Other samples at the same times, with the same stiffness.
[[nodiscard]] SmoothedSamples smooth_alike(const SmoothedSamples& model, const Eigen::MatrixXd& samples);

}  // namespace snug::numerics
