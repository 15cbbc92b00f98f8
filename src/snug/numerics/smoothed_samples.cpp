// SmoothedSamples: a banded system, and the trace of its inverse from the inverse's bands (Hutchinson, de Hoog 1985).
#include "snug/numerics/smoothed_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace snug::numerics {
namespace {

constexpr double kCounted = 1.4;  // of a degree of freedom in the score (Kim and Gu 2004)
constexpr double kClearly = 1.5;  // times the plain score: what is stiffer leaves out more than noise
constexpr int kTried = 64;        // stiffnesses
constexpr int kWeighted = 2;      // rounds with weights
constexpr Eigen::Index kLeast = 5;
constexpr double kNoNoise = 1e-12;  // of the largest value: rounding

/// Second derivatives of n samples: row j is of samples j, j+1, j+2.
class SecondDerivative {
 public:
  explicit SecondDerivative(const std::vector<double>& times) : rows_(static_cast<Eigen::Index>(times.size()) - 2, 3) {
    for (Eigen::Index j = 0; j < rows_.rows(); ++j) {
      const auto k = static_cast<std::size_t>(j);
      const double before = times[k + 1] - times[k], after = times[k + 2] - times[k + 1],
                   width = 0.5 * (before + after);
      rows_.row(j) << 1.0 / before, -1.0 / before - 1.0 / after, 1.0 / after;
      rows_.row(j) /= width;
    }
  }
  [[nodiscard]] Eigen::Index count() const { return rows_.rows(); }
  [[nodiscard]] Eigen::MatrixXd of(const Eigen::MatrixXd& samples) const {
    Eigen::MatrixXd result(count(), samples.cols());
    for (Eigen::Index j = 0; j < count(); ++j) result.row(j) = rows_.row(j) * samples.middleRows<3>(j);
    return result;
  }
  /// Diagonal and the two bands beside it of 1 + D^T diag(stiffness) D, n x n.
  [[nodiscard]] Eigen::MatrixX3d system(const Eigen::VectorXd& stiffness) const {
    Eigen::MatrixX3d bands = Eigen::MatrixX3d::Zero(count() + 2, 3);
    bands.col(0).setOnes();
    for (Eigen::Index j = 0; j < count(); ++j)
      for (Eigen::Index a = 0; a < 3; ++a)
        for (Eigen::Index b = a; b < 3; ++b) bands(j + a, b - a) += stiffness[j] * rows_(j, a) * rows_(j, b);
    return bands;
  }

 private:
  Eigen::MatrixX3d rows_;
};

/// L D L^T of a symmetric matrix with two bands beside the diagonal.
struct BandedFactor {
  Eigen::VectorXd d, l1, l2;
  explicit BandedFactor(const Eigen::MatrixX3d& bands) : d(bands.rows()), l1(bands.rows()), l2(bands.rows()) {
    for (Eigen::Index i = 0; i < d.size(); ++i) {
      d[i] = bands(i, 0);
      double next = bands(i, 1);
      if (i >= 1) {
        d[i] -= d[i - 1] * l1[i - 1] * l1[i - 1];
        next -= d[i - 1] * l1[i - 1] * l2[i - 1];
      }
      if (i >= 2) d[i] -= d[i - 2] * l2[i - 2] * l2[i - 2];
      l1[i] = next / d[i];
      l2[i] = bands(i, 2) / d[i];
    }
  }
  [[nodiscard]] Eigen::MatrixXd solve(Eigen::MatrixXd x) const {
    const Eigen::Index n = d.size();
    for (Eigen::Index i = 1; i < n; ++i) {
      x.row(i) -= l1[i - 1] * x.row(i - 1);
      if (i >= 2) x.row(i) -= l2[i - 2] * x.row(i - 2);
    }
    for (Eigen::Index i = n; i-- > 0;) {
      x.row(i) /= d[i];
      if (i + 1 < n) x.row(i) -= l1[i] * x.row(i + 1);
      if (i + 2 < n) x.row(i) -= l2[i] * x.row(i + 2);
    }
    return x;
  }
  [[nodiscard]] double trace_of_inverse() const {
    double trace = 0.0, own1 = 0.0, own2 = 0.0, next = 0.0;  // diagonal of rows i+1, i+2; between these two
    for (Eigen::Index i = d.size(); i-- > 0;) {
      const double a = i + 1 < d.size() ? l1[i] : 0.0, b = i + 2 < d.size() ? l2[i] : 0.0;
      const double beside = -a * own1 - b * next, far = -a * next - b * own2;
      const double own = 1.0 / d[i] - a * beside - b * far;
      trace += own;
      own2 = own1, own1 = own, next = beside;
    }
    return trace;
  }
};

/// The mean of a row's squares over `reach` rows to each side.
Eigen::VectorXd mean_squares(const Eigen::MatrixXd& rows, Eigen::Index reach) {
  const Eigen::VectorXd squares = rows.rowwise().squaredNorm();
  Eigen::VectorXd mean(squares.size());
  for (Eigen::Index j = 0; j < squares.size(); ++j) {
    const Eigen::Index first = std::max<Eigen::Index>(0, j - reach), last = std::min(squares.size() - 1, j + reach);
    mean[j] = squares.segment(first, last - first + 1).mean();
  }
  return mean;
}

/// 1 on average; what is small against most is as good as zero.
Eigen::VectorXd weights_of(const Eigen::VectorXd& squares) {
  constexpr double kLeastShare = 1e-3;  // of the largest
  Eigen::VectorXd sorted = squares;
  std::sort(sorted.data(), sorted.data() + sorted.size());
  const double floor = sorted[sorted.size() / 2] + kLeastShare * sorted[sorted.size() - 1];
  if (!(floor > 0.0)) return Eigen::VectorXd::Ones(squares.size());
  const Eigen::VectorXd weights = (squares.array() + floor).inverse();
  return weights / weights.mean();
}

}  // namespace

double SmoothedSamples::bandwidth() const {
  return times.size() < 2 ? 0.0 : 0.5 * unknowns / (times.back() - times.front());
}

SmoothedSamples smooth_alike(const SmoothedSamples& model, const Eigen::MatrixXd& samples) {
  SmoothedSamples found = model;
  found.values = samples;
  if (model.stiffness.size() == 0) return found;
  const BandedFactor factor(SecondDerivative(model.times).system(model.stiffness));
  found.values = factor.solve(samples);
  found.unknowns = factor.trace_of_inverse();
  const double left = static_cast<double>(samples.cols()) * (static_cast<double>(samples.rows()) - found.unknowns);
  found.noise = left > 0.0 ? std::sqrt((samples - found.values).squaredNorm() / left) : 0.0;
  return found;
}

SmoothedSamples smooth_samples(const std::vector<double>& times, const Eigen::MatrixXd& samples) {
  const Eigen::Index n = samples.rows();
  SmoothedSamples best{times, samples, {}, static_cast<double>(n), 0.0};
  if (n < kLeast) return best;
  const SmoothedSamples exact = best;
  const SecondDerivative derivative(times);
  const double duration = times.back() - times.front(), spacing = duration / static_cast<double>(n - 1);
  // Half of an oscillation of frequency f is followed at a stiffness of (2 pi f)^-4: from half a period in all of the
  // time to four times the highest frequency that samples show, where all is followed.
  const double low = 0.5 / duration, high = 2.0 / spacing;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(n - 2);
  for (int round = 0; round <= kWeighted; ++round) {
    double least = std::numeric_limits<double>::infinity(), least_plain = least, plain_of_chosen = least;
    SmoothedSamples chosen = exact, closest = exact;
    for (int k = 0; k < kTried; ++k) {
      SmoothedSamples tried = exact;
      tried.stiffness = std::pow(2.0 * std::numbers::pi * low * std::pow(high / low, k / (kTried - 1.0)), -4) * weights;
      tried = smooth_alike(tried, samples);
      const double squares = (samples - tried.values).squaredNorm(), left = static_cast<double>(n) - tried.unknowns;
      const double counted = static_cast<double>(n) - kCounted * tried.unknowns;
      const double plain = squares / (left * left);
      if (plain < least_plain) {
        least_plain = plain;
        closest = tried;
      }
      if (counted > 0.0 && squares / (counted * counted) < least) {
        least = squares / (counted * counted);
        plain_of_chosen = plain;
        chosen = std::move(tried);
      }
    }
    best = plain_of_chosen > kClearly * least_plain ? std::move(closest) : std::move(chosen);
    if (!(best.noise > kNoNoise * samples.cwiseAbs().maxCoeff())) return exact;
    const auto reach = static_cast<Eigen::Index>(0.5 * static_cast<double>(n) / best.unknowns);
    weights = weights_of(mean_squares(derivative.of(best.values), reach));
  }
  return best;
}

}  // namespace snug::numerics
