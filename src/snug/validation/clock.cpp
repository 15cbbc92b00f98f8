// fit_clock: where the clock of one source is on that of another, from what both saw.
#include "snug/validation/clock.hpp"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "snug/core/check.hpp"
#include "snug/core/units.hpp"
#include "snug/validation/internal/averages.hpp"

namespace snug::validation {
namespace {

// Steps of docs/theory/validation.md, section 2; those of slips: docs/decisions/0077.
constexpr double kCoarse = 0.1;  // s, grid of the first search
constexpr double kFine = 0.01;   // s, grid of the second
constexpr double kBlock = 5.0;   // s: errors of the model last for seconds, and count as one
// Of the shorter one. Pieces of 60 s of which 30 % are in the reference are found, 20 of 20, and those of 20 % refused.
// With 0.5 none below 60 % is found, with 0.125 those of 15 % are. Of 10 % each takes another part for it (2026-11).
constexpr double kLeastOverlap = 0.25;
constexpr double kLeastLikeness = 0.5;
constexpr int kSteps = 40;  // of Gauss-Newton: it takes three to ten, more where contacts make steps

/// Mean of each bin of `width` seconds from `first`; NaN where a bin is empty.
std::vector<double> binned(const std::vector<double>& times, const std::vector<double>& values, double first,
                           double width, std::size_t count) {
  std::vector<double> sums(count, 0.0);
  std::vector<int> counts(count, 0);
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double bin = std::floor((times[i] - first) / width);
    if (!std::isfinite(values[i]) || bin < 0.0 || bin >= static_cast<double>(count)) continue;
    sums[static_cast<std::size_t>(bin)] += values[i];
    ++counts[static_cast<std::size_t>(bin)];
  }
  for (std::size_t k = 0; k < count; ++k) sums[k] = counts[k] > 0 ? sums[k] / counts[k] : kNaN;
  return sums;
}

double median_of_finite(const std::vector<double>& values) {
  std::vector<double> finite;
  for (const double value : values)
    if (std::isfinite(value)) finite.push_back(value);
  return internal::median(finite);
}

struct Coarse {
  double shift = 0.0;
  double likeness = -1.0;
};

/// Sums of products over what both have.
struct Products {
  double ab = 0.0, aa = 0.0, bb = 0.0;
  std::size_t count = 0;
  [[nodiscard]] double likeness() const { return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 0.0; }
};

Coarse search_grid(const Signals& reference, const Signals& measured, const ClockOptions& options) {
  const std::size_t channels = reference.channels.size();
  const auto bins = [](const Signals& s) {
    return static_cast<std::size_t>((s.times.back() - s.times.front()) / kCoarse) + 1;
  };
  const std::size_t na = bins(reference), nb = bins(measured);
  std::vector<std::vector<double>> a, b;
  for (std::size_t c = 0; c < channels; ++c) {
    a.push_back(binned(reference.times, reference.channels[c], reference.times.front(), kCoarse, na));
    b.push_back(binned(measured.times, measured.channels[c], measured.times.front(), kCoarse, nb));
    for (auto* side : {&a.back(), &b.back()}) {
      const double offset = options.removes_offsets ? median_of_finite(*side) : 0.0;
      for (double& value : *side) value = std::isfinite(value) ? value - offset : 0.0;
    }
  }
  // What is missing counts as nothing in the products, so that long losses make a shift less likely, not more.
  const double start = measured.times.front() - reference.times.front();
  const auto least = static_cast<long>(std::ceil((-options.longest_shift - start) / kCoarse));
  const auto most = static_cast<long>(std::floor((options.longest_shift - start) / kCoarse));
  const auto shortest = static_cast<long>(kLeastOverlap * static_cast<double>(std::min(na, nb)));
  Coarse best;
  for (long lag = least; lag <= most; ++lag) {  // a at bin i meets b at bin i + lag
    const long first = std::max(0L, -lag), last = std::min(static_cast<long>(na), static_cast<long>(nb) - lag);
    if (last - first < std::max(shortest, 10L)) continue;
    Products sum;
    for (std::size_t c = 0; c < channels; ++c) {
      for (long i = first; i < last; ++i) {
        const double x = a[c][static_cast<std::size_t>(i)], y = b[c][static_cast<std::size_t>(i + lag)];
        sum.ab += x * y;
        sum.aa += x * x;
        sum.bb += y * y;
      }
    }
    if (sum.likeness() > best.likeness) best = {start + kCoarse * static_cast<double>(lag), sum.likeness()};
  }
  return best;
}

/// A channel, read between samples.
class SampledCurve {
 public:
  SampledCurve(const std::vector<double>& times, const std::vector<double>& values) : times_(times), values_(values) {
    period_ = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  }
  /// Value at `time`, linear between samples; NaN outside, at losses and in gaps of more than 3 periods.
  [[nodiscard]] double at(double time) const {
    if (!(time >= times_.front()) || !(time <= times_.back())) return kNaN;
    // Samples are nearly even: guess, then walk.
    auto i = static_cast<std::size_t>(
        std::clamp((time - times_.front()) / period_, 0.0, static_cast<double>(times_.size() - 2)));
    while (i + 2 < times_.size() && times_[i + 1] < time) ++i;
    while (i > 0 && times_[i] > time) --i;
    const double gap = times_[i + 1] - times_[i];
    if (gap > 3.0 * period_) return kNaN;
    return values_[i] + (time - times_[i]) / gap * (values_[i + 1] - values_[i]);
  }

 private:
  const std::vector<double>& times_;
  const std::vector<double>& values_;
  double period_ = 1.0;
};

/// Sums over one block of time, for Gauss-Newton and its errors.
struct Block {
  Eigen::Matrix2d H = Eigen::Matrix2d::Zero();          ///< with the weights of this step
  Eigen::Matrix2d curvature = Eigen::Matrix2d::Zero();  ///< with the slope of the weighted residual: for the errors
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
};

/// Residuals of all channels at a shift and rate.
class Comparison {
 public:
  Comparison(const Signals& reference, const Signals& measured, const ClockOptions& options)
      : reference_(reference), options_(options) {
    for (const auto& channel : measured.channels) curves_.emplace_back(measured.times, channel);
    // Slopes are the reference's: noise in a slope would pull towards the start, and the reference has none.
    for (const auto& channel : reference.channels) {
      const std::vector<double>& t = reference.times;
      std::vector<double> slopes(t.size(), kNaN);
      for (std::size_t i = 1; i + 1 < t.size(); ++i)
        slopes[i] = (channel[i + 1] - channel[i - 1]) / (t[i + 1] - t[i - 1]);
      slopes_.push_back(std::move(slopes));
    }
    offsets_.assign(curves_.size(), 0.0);
    middle_ = 0.5 * (reference.times.front() + reference.times.back());
  }

  [[nodiscard]] double middle() const { return middle_; }

  [[nodiscard]] Products products(const ClockFit& clock) const {
    Products sum;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      for (std::size_t i = 0; i < reference_.times.size(); ++i) {
        const double a = reference_.channels[c][i] - offset_a_of(c), b = value(c, i, clock) - offset_b_of(c);
        if (!std::isfinite(a) || !std::isfinite(b)) continue;
        sum.ab += a * b;
        sum.aa += a * a;
        sum.bb += b * b;
        ++sum.count;
      }
    }
    return sum;
  }

  /// Constant differences of the channels, and the size of a usual residual.
  void centre(const ClockFit& clock) {
    std::vector<double> sizes;
    for (std::size_t c = 0; c < curves_.size(); ++c) {
      std::vector<double> differences, references;
      for (std::size_t i = 0; i < reference_.times.size(); i += 4) {
        const double difference = value(c, i, clock) - reference_.channels[c][i];
        if (!std::isfinite(difference)) continue;
        differences.push_back(difference);
        references.push_back(reference_.channels[c][i]);
      }
      if (options_.removes_offsets) {
        offsets_[c] = median_of_finite(differences);
        reference_offsets_.resize(curves_.size(), 0.0);
        reference_offsets_[c] = median_of_finite(references);
      }
      for (std::size_t i = 0; i < differences.size(); ++i) {
        // At rest both say the same to the noise: only what moves tells what a usual difference is.
        if (std::abs(references[i] - offset_a_of(c)) > 1e-3) sizes.push_back(std::abs(differences[i] - offsets_[c]));
      }
    }
    scale_ = std::max(2.0 * 1.4826 * internal::median(sizes), 1e-9);
  }

  /// Normal equations by block of time; weights of Cauchy's bound the influence of spikes.
  [[nodiscard]] std::vector<Block> blocks(const ClockFit& clock) const {
    const double first = reference_.times.front();
    std::vector<Block> blocks(static_cast<std::size_t>((reference_.times.back() - first) / kBlock) + 1);
    for (std::size_t i = 0; i < reference_.times.size(); ++i) {
      Block& block = blocks[static_cast<std::size_t>((reference_.times[i] - first) / kBlock)];
      const double lever = reference_.times[i] - middle_;
      for (std::size_t c = 0; c < curves_.size(); ++c) {
        const double at = clock.to_measured(reference_.times[i]);
        const double slope = slopes_[c][i];
        const double residual = curves_[c].at(at) - offsets_[c] - reference_.channels[c][i];
        if (!std::isfinite(slope) || !std::isfinite(residual) || slope == 0.0) continue;
        const double weight = 1.0 / (1.0 + (residual / scale_) * (residual / scale_));
        const Eigen::Vector2d J = slope * Eigen::Vector2d(1.0, lever);
        const double bend = 1.0 - (residual / scale_) * (residual / scale_);
        block.H += weight * J * J.transpose();
        block.curvature += weight * weight * bend * J * J.transpose();
        block.g += weight * J * residual;
      }
    }
    return blocks;
  }

  [[nodiscard]] double first() const { return reference_.times.front(); }

  /// Bounded squares of residuals from one time to another, s.
  [[nodiscard]] double cost(const ClockFit& clock, double from, double to) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < reference_.times.size(); ++i) {
      if (reference_.times[i] < from || reference_.times[i] > to) continue;
      for (std::size_t c = 0; c < curves_.size(); ++c) {
        const double residual = (value(c, i, clock) - offsets_[c] - reference_.channels[c][i]) / scale_;
        if (std::isfinite(residual)) sum += std::log(1.0 + residual * residual);
      }
    }
    return sum;
  }

 private:
  [[nodiscard]] double value(std::size_t c, std::size_t i, const ClockFit& clock) const {
    return curves_[c].at(clock.to_measured(reference_.times[i]));
  }
  [[nodiscard]] double offset_a_of(std::size_t c) const {
    return reference_offsets_.empty() ? 0.0 : reference_offsets_[c];
  }
  [[nodiscard]] double offset_b_of(std::size_t c) const { return offset_a_of(c) + offsets_[c]; }

  const Signals& reference_;
  ClockOptions options_;
  std::vector<SampledCurve> curves_;
  std::vector<double> offsets_, reference_offsets_;
  std::vector<std::vector<double>> slopes_;  ///< of the reference
  double middle_ = 0.0, scale_ = 1.0;
};

/// Least squares for the shift, and the rate when `with_rate`.
ClockFit refine(Comparison& comparison, double shift, bool with_rate) {
  ClockFit fit;
  fit.shift = shift;
  fit.middle = comparison.middle();
  std::vector<Block> blocks;
  Eigen::Matrix2d inverse = Eigen::Matrix2d::Zero();
  for (int step = 0; step < kSteps; ++step) {
    comparison.centre(fit);
    blocks = comparison.blocks(fit);
    Block sum;
    for (const Block& block : blocks) {
      sum.H += block.H;
      sum.g += block.g;
    }
    inverse.setZero();
    if (with_rate)
      inverse = sum.H.inverse();
    else
      inverse(0, 0) = 1.0 / sum.H(0, 0);
    if (!inverse.allFinite()) return fit;
    const Eigen::Vector2d change = -(inverse * sum.g);
    fit.shift += std::clamp(change[0], -0.05, 0.05);
    fit.rate += std::clamp(change[1], -1e-3, 1e-3);
    if (std::abs(change[0]) < 1e-7 && std::abs(change[1]) < 1e-10) break;
  }
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero(), curvature = Eigen::Matrix2d::Zero();
  const double most = std::max_element(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) {
                        return a.H(0, 0) < b.H(0, 0);
                      })->H(0, 0);
  for (const Block& block : blocks) {
    scatter += block.g * block.g.transpose();
    curvature += block.curvature;
    fit.blocks += block.H(0, 0) > 0.01 * most ? 1 : 0;
  }
  const int parameters = with_rate ? 2 : 1;
  const double few = fit.blocks > parameters ? static_cast<double>(fit.blocks) / (fit.blocks - parameters)
                                             : std::numeric_limits<double>::infinity();
  inverse.setZero();
  if (with_rate)
    inverse = curvature.inverse();
  else
    inverse(0, 0) = 1.0 / curvature(0, 0);
  const Eigen::Matrix2d covariance = inverse * scatter * inverse;
  fit.shift_error = std::sqrt(few * covariance(0, 0));
  fit.rate_error = with_rate ? std::sqrt(few * covariance(1, 1)) : 0.0;
  fit.correlation = comparison.products(fit).likeness();
  return fit;
}

/// The shift that one block of time asks for beyond the fit.
struct BlockShift {
  double time = 0.0;    ///< s, reference clock: its end
  double lever = 0.0;   ///< s, of its information from the middle
  double shift = 0.0;   ///< s
  double weight = 0.0;  ///< information, up to a common factor
};

std::vector<BlockShift> shifts_of(const Comparison& comparison, const ClockFit& fit) {
  const std::vector<Block> blocks = comparison.blocks(fit);
  double most = 0.0;
  for (const Block& block : blocks) most = std::max(most, block.H(0, 0));
  std::vector<BlockShift> shifts;
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const Block& block = blocks[k];
    if (!(block.H(0, 0) > 0.01 * most)) continue;
    shifts.push_back({comparison.first() + kBlock * static_cast<double>(k + 1), block.H(0, 1) / block.H(0, 0),
                      -block.g[0] / block.H(0, 0), block.H(0, 0)});
  }
  return shifts;
}

/// Variance of a block's shift times its weight, by what neighbours differ by: one slip among many changes nothing.
double scatter_of(const std::vector<BlockShift>& shifts) {
  std::vector<double> sizes;
  for (std::size_t k = 1; k < shifts.size(); ++k)
    sizes.push_back(std::abs(shifts[k].shift - shifts[k - 1].shift) /
                    std::sqrt(1.0 / shifts[k].weight + 1.0 / shifts[k - 1].weight));
  const double size = internal::median(sizes) / 0.6745;
  return size * size;
}

/// Shift, rate and the sizes of steps by least squares over blocks; what the rate is beyond `rate_before` is expected
/// to be small.
struct BlockFit {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
  double chi2 = 0.0;
};

BlockFit fit_blocks(const std::vector<BlockShift>& shifts, const std::vector<double>& steps, double scatter,
                    double rate_before, double usual_rate) {
  const auto n = static_cast<Eigen::Index>(2 + steps.size());
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
  const auto row_of = [&](const BlockShift& one) {
    Eigen::VectorXd row = Eigen::VectorXd::Zero(n);
    row[0] = 1.0;
    row[1] = one.lever;
    for (std::size_t k = 0; k < steps.size(); ++k)
      row[static_cast<Eigen::Index>(2 + k)] = one.time > steps[k] ? 1.0 : 0.0;
    return row;
  };
  constexpr double kLeast = 1e-5;  // s: no block knows better
  const auto variance = [&](const BlockShift& one) { return scatter / one.weight + kLeast * kLeast; };
  for (const BlockShift& one : shifts) {
    const Eigen::VectorXd row = row_of(one);
    H += row * row.transpose() / variance(one);
    b += row * (one.shift / variance(one));
  }
  const double prior = 1.0 / (usual_rate * usual_rate);
  H(1, 1) += prior;
  b[1] -= prior * rate_before;
  BlockFit fit;
  fit.covariance = H.inverse();
  fit.x = fit.covariance * b;
  fit.chi2 = prior * std::pow(rate_before + fit.x[1], 2);
  for (const BlockShift& one : shifts) fit.chi2 += std::pow(one.shift - row_of(one).dot(fit.x), 2) / variance(one);
  return fit;
}

/// Where the step is, within the blocks around it.
double place_step(const Comparison& comparison, ClockFit fit, std::size_t index) {
  constexpr double kGrid = 0.25;  // s
  const double about = fit.steps[index].time;
  double best = about, least = std::numeric_limits<double>::infinity();
  for (double time = about - kBlock; time <= about + kBlock; time += kGrid) {
    fit.steps[index].time = time;
    const double cost = comparison.cost(fit, about - 2.0 * kBlock, about + 2.0 * kBlock);
    if (cost >= least) continue;
    least = cost;
    best = time;
  }
  return best;
}

void apply(const BlockFit& change, ClockFit& fit) {
  fit.shift += change.x[0];
  fit.rate += change.x[1];
  for (std::size_t k = 0; k < fit.steps.size(); ++k) fit.steps[k].size += change.x[static_cast<Eigen::Index>(2 + k)];
}

/// Shift, rate and sizes of the steps anew, with their errors.
void refine(Comparison& comparison, const ClockOptions& options, ClockFit& fit) {
  std::ranges::sort(fit.steps, {}, &ClockStep::time);
  std::vector<double> times;
  for (const ClockStep& step : fit.steps) times.push_back(step.time);
  BlockFit last;
  double scatter = 0.0;
  for (int round = 0; round < 4; ++round) {
    comparison.centre(fit);
    const std::vector<BlockShift> shifts = shifts_of(comparison, fit);
    scatter = scatter_of(shifts);
    last = fit_blocks(shifts, times, scatter, fit.rate, options.usual_rate);
    apply(last, fit);
  }
  const auto blocks = static_cast<double>(shifts_of(comparison, fit).size());
  const double few = std::max(1.0, last.chi2 / std::max(1.0, blocks - static_cast<double>(last.x.size())));
  fit.shift_error = std::sqrt(few * last.covariance(0, 0));
  fit.rate_error = std::sqrt(few * last.covariance(1, 1));
  for (std::size_t k = 0; k < fit.steps.size(); ++k) {
    const auto at = static_cast<Eigen::Index>(2 + k);
    fit.steps[k].error = std::sqrt(few * last.covariance(at, at));
  }
  fit.correlation = comparison.products(fit).likeness();
}

constexpr double kLeastStep = 5e-4;  // s

/// Whether steps are none: too small, or cut out of a ramp that no clock has.
bool is_doubtful(const Comparison& comparison, const ClockOptions& options, const ClockFit& before,
                 const ClockFit& fit) {
  const auto too_small = [](const ClockStep& step) { return std::abs(step.size) < kLeastStep; };
  constexpr double kAnyRate = 1.0;
  const std::vector<BlockShift> plain = shifts_of(comparison, before), stepped = shifts_of(comparison, fit);
  const double scatter = scatter_of(stepped);
  const bool is_ramp = fit_blocks(plain, {}, scatter, before.rate, kAnyRate).chi2 <
                       fit_blocks(stepped, {}, scatter, fit.rate, options.usual_rate).chi2;
  return is_ramp || std::ranges::any_of(fit.steps, too_small) || std::abs(fit.rate) > options.highest_rate;
}

/// Slips, one after the other, as long as one explains far more than chance; with them shift and rate anew.
void find_steps(Comparison& comparison, const ClockOptions& options, ClockFit& fit) {
  constexpr std::size_t kMostSteps = 5, kFewestBlocks = 8;
  // Two numbers for each of some 50 places: a gain of 25 is chance in less than one of a thousand recordings.
  constexpr double kGain = 25.0;  // of chi-square
  if (shifts_of(comparison, fit).size() < kFewestBlocks) return;
  const ClockFit before = fit;
  for (bool goes_on = true; goes_on && fit.steps.size() < kMostSteps;) {
    goes_on = false;
    const std::vector<BlockShift> shifts = shifts_of(comparison, fit);
    const double scatter = scatter_of(shifts);
    std::vector<double> times;
    for (const ClockStep& step : fit.steps) times.push_back(step.time);
    const double now = fit_blocks(shifts, times, scatter, fit.rate, options.usual_rate).chi2;
    double gain = 0.0, size = 0.0, at = 0.0;
    times.push_back(0.0);
    for (std::size_t k = 1; k + 2 < shifts.size(); ++k) {
      times.back() = shifts[k].time;
      const BlockFit tried = fit_blocks(shifts, times, scatter, fit.rate, options.usual_rate);
      if (now - tried.chi2 <= gain) continue;
      gain = now - tried.chi2;
      size = tried.x[tried.x.size() - 1];
      at = shifts[k].time;
    }
    if (gain < kGain || std::abs(size) < kLeastStep) break;
    goes_on = true;
    fit.steps.push_back({at, 0.0, 0.0});
    for (int round = 0; round < 3; ++round) {
      comparison.centre(fit);
      const std::vector<BlockShift> anew = shifts_of(comparison, fit);
      times.back() = fit.steps.back().time;
      apply(fit_blocks(anew, times, scatter_of(anew), fit.rate, options.usual_rate), fit);
      fit.steps.back().time = place_step(comparison, fit, fit.steps.size() - 1);
    }
  }
  if (fit.steps.empty()) return;
  if (is_doubtful(comparison, options, before, fit))
    fit = before;
  else
    refine(comparison, options, fit);
}

/// Clocks are expected to run nearly alike; blocks that err together know less than so many that do not.
void temper(const Comparison& comparison, const ClockOptions& options, ClockFit& fit) {
  const std::vector<BlockShift> shifts = shifts_of(comparison, fit);
  double squares = 0.0, neighbours = 0.0;
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    squares += shifts[k].weight * shifts[k].shift * shifts[k].shift;
    if (k > 0) neighbours += std::sqrt(shifts[k].weight * shifts[k - 1].weight) * shifts[k].shift * shifts[k - 1].shift;
  }
  const double correlation = squares > 0.0 ? neighbours / squares : 0.0;
  constexpr double kMost = 0.9;
  if (correlation > 2.0 / std::sqrt(static_cast<double>(std::max<std::size_t>(4, shifts.size())))) {
    const double shared = std::min(correlation, kMost), more = std::sqrt((1.0 + shared) / (1.0 - shared));
    fit.shift_error *= more;
    fit.rate_error *= more;
  }
  if (!(fit.rate_error > 0.0)) return;
  const double prior = options.usual_rate * options.usual_rate, own = fit.rate_error * fit.rate_error;
  fit.rate *= prior / (prior + own);
  fit.rate_error *= std::sqrt(prior / (prior + own));
}

/// The signals with each channel bounded by twice what its moving values stay below 95 % of the time: a few spikes (a
/// body that is taken for another, a contact) must not decide what is alike.
Signals bounded(Signals signals, bool removes_offsets) {
  for (std::vector<double>& channel : signals.channels) {
    const double offset = removes_offsets ? median_of_finite(channel) : 0.0;
    double highest = 0.0;
    for (const double value : channel)
      if (std::isfinite(value)) highest = std::max(highest, std::abs(value - offset));
    std::vector<double> moving;
    for (const double value : channel)
      if (std::abs(value - offset) > 1e-3 * highest) moving.push_back(std::abs(value - offset));
    if (moving.empty()) continue;
    const auto at = moving.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(moving.size()));
    std::nth_element(moving.begin(), at, moving.end());
    const double limit = 2.0 * *at;
    for (double& value : channel)
      if (std::isfinite(value)) value = offset + std::clamp(value - offset, -limit, limit);
  }
  return signals;
}

bool moves(const Signals& signals) {
  for (const auto& channel : signals.channels) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double value : channel) {
      if (!std::isfinite(value)) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (high > low) return true;
  }
  return false;
}

}  // namespace

const char* describe(NoClock reason) {
  switch (reason) {
    case NoClock::NothingInCommon:
      return "the signals have too little in common";
    case NoClock::NothingMoves:
      return "nothing moves";
    case NoClock::TooUnlike:
      break;
  }
  return "no shift makes the two alike";
}

Expected<ClockFit, NoClock> fit_clock(const Signals& as_predicted, const Signals& as_measured,
                                      const ClockOptions& options) {
  SNUG_CHECK(as_predicted.channels.size() == as_measured.channels.size(), "both must have the same channels");
  if (as_predicted.times.size() < 10 || as_measured.times.size() < 10 || as_predicted.channels.empty())
    return Unexpected<NoClock>(NoClock::NothingInCommon);
  if (!moves(as_predicted) || !moves(as_measured)) return Unexpected<NoClock>(NoClock::NothingMoves);
  const Signals reference = bounded(as_predicted, options.removes_offsets);
  const Signals measured = bounded(as_measured, options.removes_offsets);
  const Coarse coarse = search_grid(reference, measured, options);
  if (coarse.likeness < 0.5 * kLeastLikeness) return Unexpected<NoClock>(NoClock::TooUnlike);
  Comparison comparison(reference, measured, options);
  ClockFit tried;
  tried.middle = comparison.middle();
  tried.shift = coarse.shift;
  comparison.centre(tried);
  double shift = coarse.shift, likeness = -1.0;
  for (double at = coarse.shift - 1.5 * kCoarse; at <= coarse.shift + 1.5 * kCoarse; at += kFine) {
    tried.shift = at;
    const double here = comparison.products(tried).likeness();
    if (here > likeness) {
      likeness = here;
      shift = at;
    }
  }
  ClockFit fit = refine(comparison, shift, true);
  const bool is_clock = std::abs(fit.rate) <= options.highest_rate && fit.rate_error <= options.highest_rate;
  const double plain_rate = std::abs(fit.rate);
  if (!is_clock) fit = refine(comparison, shift, false);
  constexpr double kMostLikeSteps = 1e-3;  // what is slower or faster than that did not slip a few times
  if (options.finds_steps && plain_rate < kMostLikeSteps) find_steps(comparison, options, fit);
  if (fit.steps.empty()) temper(comparison, options, fit);
  if (!(fit.correlation >= kLeastLikeness)) return Unexpected<NoClock>(NoClock::TooUnlike);
  return fit;
}

}  // namespace snug::validation
