// RowCounts: where bodies stop being predictable, or stop following their recordings.
#include "snug/identification/internal/followed_rows.hpp"

#include <algorithm>
#include <cmath>

namespace snug::identification::internal {
namespace {

// Chosen on recorded programs (docs/decisions/0032 and 0051; docs/theory/scene-identification.md, b and s).
// What both steps have in common, squared, over what they have opposite: the first is what straight lines miss. Where
// steps are as small as standard errors, one unit is what chance may do.
constexpr double kBentShare = 0.2, kBentLeast = 100.0;
constexpr double kFar = 10.0;         // standard deviations
constexpr double kUnexplained = 4.0;  // the same, after a fit
constexpr double kRough = 25.0;       // of the covariance: slopes that jump say too much
constexpr double kFarFor = 0.3;       // s, of samples one after the other

/// Calls visit(body, first row, count of rows, index of the sample) for each sample, until it returns false for a body.
template <class Visit>
std::vector<Eigen::Index> walk(const SceneExperiment& experiment, std::size_t motion, const Visit& visit) {
  std::vector<Eigen::Index> rows;
  const std::vector<SceneExperiment::BodyRows> bodies = experiment.rows_of(motion);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const SceneExperiment::BodyRows& body = bodies[b];
    rows.push_back(body.count);
    for (std::size_t s = 0; s < body.samples->size(); ++s) {
      const auto at = static_cast<Eigen::Index>(s) * body.each;
      const Eigen::Index keep = visit(b, s == 0, body.first + at, body.each, (*body.samples)[s]);
      if (keep < 0) continue;
      rows.back() = std::max<Eigen::Index>(0, at - keep * body.each);
      break;
    }
  }
  return rows;
}

template <class Choose>
RowCounts combined(const RowCounts& a, const RowCounts& b, const Choose& choose) {
  RowCounts result = a;
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t k = 0; k < a[i].size(); ++k) result[i][k] = choose(a[i][k], b[i][k]);
  return result;
}

/// Samples of a body, one after the other, that are far off.
class FarSamples {
 public:
  /// The next sample of a body, the mean of `count`; how many of the latest to leave out once they are far for 0.3 s,
  /// else -1.
  Eigen::Index add(const RecordedMotion& motion, std::size_t sample, double count, bool is_first, bool is_far) {
    if (is_first || !is_far) samples_ = 0;
    if (!is_far) return -1;
    const double half = 0.5 * count * motion.period;
    if (samples_ == 0) since_ = motion.times[sample] - half;
    ++samples_;
    return motion.times[sample] + half - since_ >= kFarFor ? samples_ - 1 : -1;
  }

 private:
  Eigen::Index samples_ = 0;
  double since_ = 0.0;  // s
};

}  // namespace

RowCounts rows_until(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                     const std::vector<double>& until) {
  RowCounts result;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const std::vector<double>& times = experiment.motions()[motions[i]].times;
    result.push_back(
        walk(experiment, motions[i], [&](std::size_t, bool, Eigen::Index, int, std::size_t k) -> Eigen::Index {
          return times[k] > until[i] ? 0 : -1;
        }));
  }
  return result;
}

RowCounts fewer(const RowCounts& a, const RowCounts& b) {
  return combined(a, b, [](Eigen::Index one, Eigen::Index other) { return std::min(one, other); });
}

RowCounts more(const RowCounts& a, const RowCounts& b) {
  return combined(a, b, [](Eigen::Index one, Eigen::Index other) { return std::max(one, other); });
}

double total(const RowCounts& rows) {
  double sum = 0.0;
  for (const std::vector<Eigen::Index>& of_motion : rows)
    for (const Eigen::Index count : of_motion) sum += static_cast<double>(count);
  return sum;
}

RowWeights equal_weights(const SceneExperiment& experiment, const std::vector<std::size_t>& motions) {
  RowWeights weights;
  for (const std::size_t m : motions) weights.push_back(Eigen::VectorXd::Ones(experiment.samples_of(m)));
  return weights;
}

double total(const SceneExperiment& experiment, const std::vector<std::size_t>& motions, const RowCounts& rows,
             const RowWeights& weights) {
  double sum = 0.0;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const std::vector<SceneExperiment::BodyRows> bodies = experiment.rows_of(motions[i]);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      sum += weights[i].segment(bodies[b].first, rows[i][b]).squaredNorm();
  }
  return sum;
}

void weigh(const SceneExperiment& experiment, std::size_t motion, const std::vector<Eigen::Index>& rows,
           const Eigen::VectorXd& weights, Eigen::VectorXd& residuals) {
  if (residuals.size() == 0) return;
  residuals.head(weights.size()).array() *= weights.array();
  const std::vector<SceneExperiment::BodyRows> bodies = experiment.rows_of(motion);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    residuals.segment(bodies[b].first + rows[b], bodies[b].count - rows[b]).setZero();
}

RowCounts find_straight(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                        const Neighbourhood& at, const RowCounts& within, std::vector<bool>& is_bent,
                        RowWeights& weights) {
  RowCounts result = within;
  is_bent.assign(at.is_between.size(), false);
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const std::vector<SceneExperiment::BodyRows> bodies = experiment.rows_of(motions[i]);
    Eigen::VectorXd bent_before = Eigen::VectorXd::Zero(weights[i].size());  // by all parameters
    for (std::size_t j = 0; j < is_bent.size(); ++j) {
      const Eigen::VectorXd &up = at.up[j][i], &down = at.down[j][i], &middle = at.middle[i];
      if (!at.is_between[j] || up.size() == 0 || down.size() == 0) continue;
      for (std::size_t b = 0; b < bodies.size(); ++b) {
        double bent = 0.0, straight = 0.0;
        Eigen::Index fine = 0;
        for (Eigen::Index row = 0; row < within[i][b]; row += bodies[b].each) {
          const Eigen::Index first = bodies[b].first + row, each = bodies[b].each;
          bent += (0.5 * (up + down) - middle).segment(first, each).squaredNorm();
          straight += 0.25 * (up - down).segment(first, each).squaredNorm();
          bent_before.segment(first, each).array() += bent;
          if (bent <= kBentLeast + kBentShare * straight) fine = row + each;
        }
        is_bent[j] = is_bent[j] || fine < within[i][b];
        result[i][b] = std::min(result[i][b], fine);
      }
    }
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Eigen::Index first = bodies[b].first, count = within[i][b];
      weights[i].segment(first, count) = (1.0 + bent_before.segment(first, count).array()).rsqrt();
    }
  }
  return result;
}

RowCounts find_followed(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                        const Neighbourhood& at, const Eigen::MatrixXd& covariance) {
  const model::SceneTask& task = experiment.task();
  const double rotation_noise = task.position_noise / task.rotation_position_ratio;
  const double frame_square =
      3.0 * (std::pow(task.own.frame_position / task.position_noise, 2) +
             std::pow(task.own.bias / task.position_noise, 2) + std::pow(task.own.frame_rotation / rotation_noise, 2));
  RowCounts result;
  const Eigen::Index n = at.span.size();
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const RecordedMotion& motion = experiment.motions()[motions[i]];
    FarSamples far;
    Eigen::MatrixXd J;
    result.push_back(walk(experiment, motions[i],
                          [&](std::size_t b, bool is_first, Eigen::Index row, int each, std::size_t k) -> Eigen::Index {
                            J.resize(each, n);
                            for (Eigen::Index j = 0; j < n; ++j) {
                              const auto &up = at.up[static_cast<std::size_t>(j)][i],
                                         &down = at.down[static_cast<std::size_t>(j)][i];
                              if (up.size() == 0 || down.size() == 0)
                                J.col(j).setZero();
                              else
                                J.col(j) = (up.segment(row, each) - down.segment(row, each)) / at.span[j];
                            }
                            const double count = averaged_at(motion.tracked[b], k);
                            const double expected =
                                each + count * frame_square + kRough * (J * covariance).cwiseProduct(J).sum();
                            const bool is_far = at.middle[i].segment(row, each).squaredNorm() > kFar * kFar * expected;
                            return far.add(motion, k, count, is_first, is_far);
                          }));
  }
  return result;
}

RowCounts find_explained(const SceneExperiment& experiment, const std::vector<std::size_t>& motions,
                         const std::vector<Eigen::VectorXd>& residuals, double misfit) {
  RowCounts result;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    const RecordedMotion& motion = experiment.motions()[motions[i]];
    FarSamples far;
    result.push_back(walk(experiment, motions[i],
                          [&](std::size_t b, bool is_first, Eigen::Index row, int each, std::size_t k) -> Eigen::Index {
                            const double square = residuals[i].segment(row, each).squaredNorm();
                            const bool is_far = square > kUnexplained * kUnexplained * each * misfit;
                            return far.add(motion, k, averaged_at(motion.tracked[b], k), is_first, is_far);
                          }));
  }
  return result;
}

}  // namespace snug::identification::internal
