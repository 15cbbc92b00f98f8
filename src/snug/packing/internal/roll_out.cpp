// Roll-outs and the race between candidates.
#include "snug/packing/internal/roll_out.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "snug/core/parallel.hpp"

namespace snug::packing::internal {

namespace {

constexpr double kSteps = 1e12;     ///< of a m^3: volumes that differ by less are equal; the rounding of sums is less
constexpr int kChoiceFutures = 12;  ///< that policies meet before one is chosen, at most
constexpr double kChoiceEffort = 0.15;  ///< fraction of the effort that choosing may take

/// The rest of a roll-out that has placed `volume` m^3.
double go_on(const Layout& start, double volume, const Policy& policy, const Prospect& prospect,
             std::span<const int> future, int skips, RollOutWork& work) {
  work.layout = start;
  Layout& layout = *work.layout;
  CandidatePose pose;
  for (const int kind : future) {
    const Piece& piece = prospect.kinds[static_cast<std::size_t>(kind)];
    if (!choose(layout, policy, piece, work, pose)) {
      if (--skips < 0) break;
      continue;
    }
    layout.add(Layout::block_at(piece, pose));
    volume += piece.volume;
  }
  return volume;
}

/// Draws an index by weight; -1 when no weight is left.
int draw(const std::vector<double>& weights, Rng& rng) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  if (total <= 0.0) return -1;
  double at = rng.uniform() * total;
  int last = -1;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] <= 0.0) continue;
    last = static_cast<int>(i);
    at -= weights[i];
    if (at < 0.0) return last;
  }
  return last;
}

/// m^3, of the mean gain. What was met by a few futures alone is not known to be nothing.
double error_of_gain(const Standing& one) {
  if (one.entrant == 0 || one.roll_outs < 2) return 0.0;
  const double n = one.roll_outs;
  return std::sqrt(std::max(0.0, one.gain_squares / n - one.gain * one.gain) / (n - 1.0));
}

/// What is known of gains before a single entrant is looked at (empirical Bayes): that of the first heat.
struct Prior {
  double mean = 0.0;      ///< m^3
  double variance = 0.0;  ///< m^6, of true gains from entrant to entrant
  double noise = 0.0;     ///< m^6, variance of the gain of one entrant from future to future

  Prior() = default;
  explicit Prior(const std::vector<Standing>& field) {
    const double others = static_cast<double>(field.size()) - 1.0;
    if (others < 1.0) return;
    for (const Standing& one : field) mean += one.gain / others;
    for (const Standing& one : field) {
      if (one.entrant == 0) continue;
      const double n = one.roll_outs;
      variance += (one.gain - mean) * (one.gain - mean) / std::max(1.0, others - 1.0);
      noise += (one.gain_squares - n * one.gain * one.gain) / std::max(1.0, n - 1.0) / others;
    }
    noise = std::max(0.0, noise);
    variance = std::max(0.0, variance - noise / field.front().roll_outs);
  }

  /// m^3, of any future, after what was seen.
  [[nodiscard]] double expected_gain(const Standing& one) const {
    if (one.entrant == 0 || one.roll_outs == 0) return 0.0;
    const double error = noise / one.roll_outs;
    return error > 0.0 ? (one.gain * variance + mean * error) / (variance + error) : one.gain;
  }
};

/// One heat: every entrant that is left meets the same futures.
struct Heat {
  std::span<const Layout> entrants;
  const Policy& policy;
  const Prospect& prospect;
  int threads;
  int skips;
  std::vector<RollOutWork> work;
  std::vector<std::vector<RollOutTree>> trees;  ///< of each entrant, one for each part of the futures

  void run(std::vector<Standing>& field, const std::vector<Future>& futures) {
    const int per = static_cast<int>(futures.size()), entered = static_cast<int>(field.size());
    // Two jobs for each thread, or one for each entrant: the fewer the parts, the more futures share a tree.
    const int parts = std::clamp((2 * threads + entered - 1) / std::max(1, entered), 1, std::max(1, per));
    std::vector<double> volume(static_cast<std::size_t>(entered * per), 0.0);
    for (const Standing& one : field) {
      const auto entrant = static_cast<std::size_t>(one.entrant);
      trees[entrant].resize(std::max(trees[entrant].size(), static_cast<std::size_t>(parts)),
                            RollOutTree(entrants[entrant]));
    }
    parallel_for(entered * parts, threads, [&](int job, int thread) {
      const int place = job / parts, part = job % parts;
      const auto entrant = static_cast<std::size_t>(field[static_cast<std::size_t>(place)].entrant);
      for (int i = part * per / parts; i < (part + 1) * per / parts; ++i) {
        volume[static_cast<std::size_t>(place * per + i)] = trees[entrant][static_cast<std::size_t>(part)].roll_out(
            policy, prospect, futures[static_cast<std::size_t>(i)], skips, work[static_cast<std::size_t>(thread)]);
      }
    });
    const auto first = std::ranges::find(field, 0, &Standing::entrant) - field.begin();
    for (std::size_t i = 0; i < field.size(); ++i) {
      Standing& one = field[i];
      double sum = one.mean * one.roll_outs, gains = one.gain * one.roll_outs;
      for (int j = 0; j < per; ++j) {
        const double own = volume[i * static_cast<std::size_t>(per) + static_cast<std::size_t>(j)];
        const double more = own - volume[static_cast<std::size_t>(first * per + j)];
        sum += own;
        gains += more;
        one.gain_squares += more * more;
      }
      one.roll_outs += per;
      one.mean = sum / one.roll_outs;
      one.gain = gains / one.roll_outs;
    }
  }

  [[nodiscard]] std::int64_t effort() const {
    return std::accumulate(work.begin(), work.end(), std::int64_t{0},
                           [](std::int64_t sum, const RollOutWork& w) { return sum + w.looked_at; });
  }
};

}  // namespace

Future draw_future(const Prospect& prospect, double volume, Rng& rng) {
  Future future;
  std::vector<double> weights = prospect.weights;
  while (volume > 0.0 && future.size() < 1000) {
    const int kind = draw(weights, rng);
    if (kind < 0) break;
    if (prospect.comes_once) weights[static_cast<std::size_t>(kind)] = 0.0;
    future.push_back(kind);
    volume -= prospect.kinds[static_cast<std::size_t>(kind)].volume;
  }
  return future;
}

bool choose(const Layout& layout, const Policy& policy, const Piece& piece, RollOutWork& work, CandidatePose& best) {
  work.looked_at += layout.find_poses(piece, work.list);
  double lowest = 0.0;
  bool found = false;
  for (const CandidatePose& pose : work.list.poses) {
    const double c = cost(layout, policy, piece, pose);
    if (found && c >= lowest) continue;
    lowest = c;
    best = pose;
    found = true;
  }
  return found;
}

double roll_out(const Layout& layout, const Policy& policy, const Prospect& prospect, const Future& future, int skips,
                RollOutWork& work) {
  return go_on(layout, 0.0, policy, prospect, future, skips, work);
}

RollOutTree::RollOutTree(Layout start, std::size_t most_steps) : most_steps_(most_steps) {
  steps_.push_back({std::move(start), true, 0, {}});
}

std::size_t RollOutTree::add(std::size_t before, int kind, const Policy& policy, const Piece& piece,
                             RollOutWork& work) {
  const std::int64_t looked_at = work.looked_at;
  Step step{steps_[before].layout, false, 0, {}};
  CandidatePose pose;
  step.is_placed = choose(step.layout, policy, piece, work, pose);
  step.looked_at = work.looked_at - looked_at;
  if (step.is_placed) step.layout.add(Layout::block_at(piece, pose));
  steps_[before].next.emplace_back(kind, steps_.size());
  steps_.push_back(std::move(step));
  return steps_.size() - 1;
}

double RollOutTree::roll_out(const Policy& policy, const Prospect& prospect, const Future& future, int skips,
                             RollOutWork& work) {
  double volume = 0.0;
  std::size_t at = 0;
  bool may_add = steps_.size() < most_steps_;
  for (std::size_t i = 0; i < future.size(); ++i) {
    const Piece& piece = prospect.kinds[static_cast<std::size_t>(future[i])];
    const auto known = std::ranges::find(steps_[at].next, future[i], &std::pair<int, std::size_t>::first);
    if (known != steps_[at].next.end()) {
      at = known->second;
      work.looked_at += steps_[at].looked_at;
    } else if (std::exchange(may_add, false)) {
      at = add(at, future[i], policy, piece, work);
    } else {
      return go_on(steps_[at].layout, volume, policy, prospect, std::span(future).subspan(i), skips, work);
    }
    if (steps_[at].is_placed) volume += piece.volume;
    if (!steps_[at].is_placed && --skips < 0) break;
  }
  return volume;
}

std::vector<Standing> race(std::span<const Layout> entrants, const Policy& policy, const Prospect& prospect,
                           double free_volume, const RaceSettings& settings, std::int64_t* roll_outs,
                           const std::vector<double>& charges) {
  const auto charge = [&](const Standing& one) {
    return charges.empty() ? 0.0 : charges[static_cast<std::size_t>(one.entrant)];
  };
  const auto worth = [&](const Standing& one) { return std::round(kSteps * (one.mean - charge(one))); };
  // Of m gains that are nothing but chance the largest is about sqrt(2 ln m) standard errors: m met in the last heat.
  double doubt = 0.0;
  Prior prior;
  // More than the first entrant, costs taken off; of a gain what is beyond doubt, all of a loss. In a short race what
  // is expected of both.
  const auto sure_gain = [&](const Standing& one) {
    const double gain = settings.is_short ? prior.expected_gain(one) : one.gain;
    const double net = gain - charge(one) + (charges.empty() ? 0.0 : charges.front());
    if (settings.is_short || net <= 0.0) return std::round(kSteps * net);
    return std::round(kSteps * std::max(0.0, net - doubt * error_of_gain(one)));
  };
  // Of those that cannot be told apart the cheapest, then the one that the policy likes better.
  const auto comes_before = [&](const Standing& a, const Standing& b) {
    return std::tuple(-sure_gain(a), charge(a), a.entrant) < std::tuple(-sure_gain(b), charge(b), b.entrant);
  };
  std::vector<Standing> field(entrants.size());
  for (std::size_t i = 0; i < field.size(); ++i) field[i].entrant = static_cast<int>(i);
  const int threads = std::max(1, settings.threads);
  Heat heat{entrants,
            policy,
            prospect,
            threads,
            settings.skips,
            std::vector<RollOutWork>(static_cast<std::size_t>(threads)),
            std::vector<std::vector<RollOutTree>>(entrants.size())};
  Rng rng = Rng(settings.seed).split("futures");
  std::size_t left = field.size();
  int rounds = 1;
  for (std::size_t n = field.size(); n > 2; n = (n + 1) / 2) ++rounds;
  int futures = settings.first_futures;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Future> drawn;
    for (int i = 0; i < futures; ++i) drawn.push_back(draw_future(prospect, free_volume, rng));
    std::vector<Standing> running(field.begin(), field.begin() + static_cast<std::ptrdiff_t>(left));
    const std::int64_t before = heat.effort();
    heat.run(running, drawn);
    if (round == 0) prior = Prior(running);
    if (roll_outs != nullptr) *roll_outs += static_cast<std::int64_t>(running.size()) * futures;
    std::stable_sort(running.begin(), running.end(),
                     [&](const Standing& a, const Standing& b) { return worth(a) > worth(b); });
    std::copy(running.begin(), running.end(), field.begin());
    // What a roll-out costs now decides how many the next round affords.
    const double each = static_cast<double>(heat.effort() - before) / (static_cast<double>(running.size()) * futures);
    const double rest = static_cast<double>(settings.effort - heat.effort()) / (rounds - round - 1.0);
    left = std::max<std::size_t>(2, (left + 1) / 2);
    left = std::min(left, field.size());
    const bool is_last = round + 1 == rounds || rest <= 0.0;
    if (is_last) {
      doubt = settings.doubt * std::sqrt(2.0 * std::log(std::max(2.0, static_cast<double>(running.size()))));
      std::sort(field.begin(), field.begin() + static_cast<std::ptrdiff_t>(running.size()), comes_before);
      break;
    }
    const auto first = std::ranges::find(field, 0, &Standing::entrant);
    const auto last_kept = field.begin() + static_cast<std::ptrdiff_t>(left) - 1;
    if (first > last_kept) std::rotate(last_kept, first, first + 1);
    futures = std::clamp(static_cast<int>(rest / (std::max(1.0, each) * static_cast<double>(left))), 1, 5000);
  }
  for (Standing& one : field) one.sure = sure_gain(one) / kSteps;
  return field;
}

PolicyChoice choose_policy(const Layout& layout, const Piece& piece, const std::vector<Policy>& policies,
                           const Prospect& prospect, double free_volume, const RaceSettings& settings) {
  std::vector<double> sums(policies.size(), 0.0);
  PolicyChoice choice;
  RollOutWork work;
  Rng rng = Rng(settings.seed).split("policies");
  const double most = kChoiceEffort * static_cast<double>(settings.effort);
  for (int i = 0; i < kChoiceFutures; ++i) {
    const Future future = draw_future(prospect, free_volume, rng);
    for (std::size_t p = 0; p < policies.size(); ++p) {
      CandidatePose pose;
      if (!choose(layout, policies[p], piece, work, pose)) return choice;
      Layout next = layout;
      next.add(Layout::block_at(piece, pose));
      sums[p] += roll_out(next, policies[p], prospect, future, settings.skips, work);
      ++choice.roll_outs;
    }
    if (static_cast<double>(work.looked_at) * (i + 2.0) / (i + 1.0) > most) break;
  }
  choice.looked_at = work.looked_at;
  for (double& sum : sums) sum = std::round(kSteps * sum);
  choice.policy = static_cast<std::size_t>(std::max_element(sums.begin(), sums.end()) - sums.begin());
  return choice;
}

}  // namespace snug::packing::internal
