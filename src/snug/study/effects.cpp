// Effects: one pass over the rows, then sums over levels.
#include "snug/study/effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace snug::study {
namespace {

constexpr std::size_t kMostOutputs = 40;
constexpr std::size_t kMostPairs = 10;

/// Numbers of one output, where rows have it.
struct Samples {
  std::vector<double> y;
  std::vector<std::uint32_t> at;  ///< index among the rows read
};

/// Which level every row has, of one factor.
struct Levels {
  std::vector<std::string> labels;
  std::vector<std::uint32_t> of_row;
};

bool as_number(const std::string& text, double& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size();
}

/// Values as they are when they are few; numbers otherwise cut into ranges with as many rows in each.
Levels find_levels(const std::vector<std::string>& values) {
  Levels levels;
  std::vector<std::string> distinct = values;
  std::ranges::sort(distinct);
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  std::vector<double> numbers(values.size());
  bool are_numbers = true;
  for (std::size_t i = 0; i < values.size(); ++i) are_numbers &= as_number(values[i], numbers[i]);
  if (distinct.size() <= kMostLevels || !are_numbers) {
    if (are_numbers) {
      std::ranges::sort(distinct, {}, [](const std::string& text) {
        double number = 0.0;
        (void)as_number(text, number);
        return number;
      });
    }
    for (const std::string& value : values) {
      const auto found = std::ranges::find(distinct, value);
      levels.of_row.push_back(static_cast<std::uint32_t>(found - distinct.begin()));
    }
    levels.labels = std::move(distinct);
    return levels;
  }
  std::vector<double> sorted = numbers;
  std::ranges::sort(sorted);
  std::vector<double> cuts;
  for (std::size_t k = 1; k < kMostLevels; ++k) cuts.push_back(sorted[k * sorted.size() / kMostLevels]);
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  for (std::size_t k = 0; k <= cuts.size(); ++k) {
    levels.labels.push_back(fmt::format("{:.3g} .. {:.3g}", k == 0 ? sorted.front() : cuts[k - 1],
                                        k == cuts.size() ? sorted.back() : cuts[k]));
  }
  for (const double number : numbers) {
    levels.of_row.push_back(static_cast<std::uint32_t>(std::ranges::upper_bound(cuts, number) - cuts.begin()));
  }
  return levels;
}

struct Groups {
  std::vector<double> sum, square;
  std::vector<std::uint64_t> count;
  explicit Groups(std::size_t size) : sum(size), square(size), count(size) {}
  void add(std::size_t group, double y) {
    sum[group] += y;
    square[group] += y * y;
    ++count[group];
  }
  /// Sum of squares between the groups, and how many groups there are.
  [[nodiscard]] std::pair<double, double> between(double mean) const {
    double total = 0.0, groups = 0.0;
    for (std::size_t i = 0; i < sum.size(); ++i) {
      if (count[i] == 0) continue;
      const double off = sum[i] / static_cast<double>(count[i]) - mean;
      total += static_cast<double>(count[i]) * off * off;
      groups += 1.0;
    }
    return {total, groups};
  }
};

class Analysis {
 public:
  Analysis(const Study& study, const Samples& samples, const std::vector<Levels>& levels)
      : study_(study), samples_(samples), levels_(levels) {
    const auto n = static_cast<double>(samples.y.size());
    mean_ = std::accumulate(samples.y.begin(), samples.y.end(), 0.0) / n;
    for (const double y : samples.y) total_ += (y - mean_) * (y - mean_);
  }

  void fill(OutputEffects& effects) {
    effects.count = samples_.y.size();
    effects.mean = mean_;
    effects.deviation = effects.count > 1 ? std::sqrt(total_ / static_cast<double>(effects.count - 1)) : 0.0;
    std::vector<double> sorted = samples_.y;
    std::ranges::sort(sorted);
    for (std::size_t i = 0; i < kQuantilePercents.size(); ++i) {
      const double at = 0.01 * kQuantilePercents[i] * static_cast<double>(sorted.size() - 1);
      const auto low = static_cast<std::size_t>(at);
      const std::size_t high = std::min(low + 1, sorted.size() - 1);
      effects.quantiles[i] = sorted[low] + (at - static_cast<double>(low)) * (sorted[high] - sorted[low]);
    }
    for (std::size_t f = 0; f < levels_.size(); ++f) effects.main.push_back(main_effect(f));
    for (std::size_t a = 0; a < levels_.size(); ++a) {
      for (std::size_t b = a + 1; b < levels_.size(); ++b) effects.interactions.push_back(interaction(a, b));
    }
    std::ranges::stable_sort(effects.interactions, std::ranges::greater{}, &Interaction::share);
    judge(effects);
    if (effects.interactions.size() > kMostPairs) effects.interactions.resize(kMostPairs);
  }

 private:
  /// Which effects are seen, and of them at most the whole.
  static void judge(OutputEffects& effects) {
    const double largest = std::max(std::abs(effects.quantiles.front()), std::abs(effects.quantiles.back()));
    effects.is_noise = !(effects.deviation > std::max(kAbsoluteNoise, kRelativeNoise * largest));
    double sum = 0.0;
    const auto look = [&](auto& effect) {
      effect.is_seen = effect.is_seen && effect.share > 0.0 && !effects.is_noise;
      if (effect.is_seen) sum += effect.share;
    };
    for (MainEffect& effect : effects.main) look(effect);
    for (Interaction& pair : effects.interactions) look(pair);
    if (sum <= 1.0) return;
    for (MainEffect& effect : effects.main) effect.share /= effect.is_seen ? sum : 1.0;
    for (Interaction& pair : effects.interactions) pair.share /= pair.is_seen ? sum : 1.0;
  }

  /// The ratio of both mean squares is 1 by chance, and varies by about sqrt(2 / freedom + 2 / left_freedom).
  [[nodiscard]] static bool stands_out(double between, double freedom, double left, double left_freedom) {
    if (freedom <= 0.0 || left_freedom <= 0.0) return false;
    return between / freedom > left / left_freedom * (1.0 + 2.0 * std::sqrt(2.0 / freedom + 2.0 / left_freedom));
  }

  /// Omega squared: what lies between, less what residual noise puts there on average.
  [[nodiscard]] double share(double between, double freedom, double left, double left_freedom) const {
    if (total_ <= 0.0 || freedom <= 0.0 || left_freedom <= 0.0) return 0.0;
    const double noise = left / left_freedom;
    return (between - freedom * noise) / (total_ + noise);
  }

  [[nodiscard]] MainEffect main_effect(std::size_t f) const {
    const Levels& levels = levels_[f];
    Groups groups(levels.labels.size());
    for (std::size_t i = 0; i < samples_.y.size(); ++i) groups.add(levels.of_row[samples_.at[i]], samples_.y[i]);
    MainEffect effect;
    effect.factor = study_.factors[f].name;
    for (std::size_t g = 0; g < levels.labels.size(); ++g) {
      if (groups.count[g] == 0) continue;
      const auto n = static_cast<double>(groups.count[g]);
      Level level{levels.labels[g], groups.sum[g] / n, 0.0, groups.count[g]};
      const double variance = n > 1.0 ? std::max(0.0, groups.square[g] - n * level.mean * level.mean) / (n - 1.0) : 0.0;
      level.error = std::sqrt(variance / n);
      effect.levels.push_back(std::move(level));
    }
    const auto [between, count] = groups.between(mean_);
    const double left = std::max(0.0, total_ - between), left_freedom = static_cast<double>(samples_.y.size()) - count;
    effect.share = share(between, count - 1.0, left, left_freedom);
    effect.is_seen = stands_out(between, count - 1.0, left, left_freedom);
    return effect;
  }

  [[nodiscard]] Interaction interaction(std::size_t a, std::size_t b) const {
    const Levels &first = levels_[a], &second = levels_[b];
    Groups one(first.labels.size()), other(second.labels.size()), both(first.labels.size() * second.labels.size());
    for (std::size_t i = 0; i < samples_.y.size(); ++i) {
      const std::size_t g = first.of_row[samples_.at[i]], h = second.of_row[samples_.at[i]];
      one.add(g, samples_.y[i]);
      other.add(h, samples_.y[i]);
      both.add(g * second.labels.size() + h, samples_.y[i]);
    }
    const auto [between_one, count_one] = one.between(mean_);
    const auto [between_other, count_other] = other.between(mean_);
    const auto [between_both, count_both] = both.between(mean_);
    const double freedom = count_both - count_one - count_other + 1.0;
    const double between = between_both - between_one - between_other, left = std::max(0.0, total_ - between_both);
    const double left_freedom = static_cast<double>(samples_.y.size()) - count_both;
    return {study_.factors[a].name, study_.factors[b].name, share(between, freedom, left, left_freedom),
            stands_out(between, freedom, left, left_freedom)};
  }

  const Study& study_;
  const Samples& samples_;
  const std::vector<Levels>& levels_;
  double mean_ = 0.0, total_ = 0.0;
};

}  // namespace

std::vector<OutputEffects> find_effects(const Study& study, const Folder& folder, std::size_t worst_rows) {
  std::vector<std::string> names;
  std::vector<Samples> samples;
  std::vector<std::uint64_t> rows;
  std::vector<std::vector<std::string>> values(study.factors.size());
  for_each_row(study, folder, [&](const RowResult& result) {
    const auto at = static_cast<std::uint32_t>(rows.size());
    rows.push_back(result.row);
    const Row row = row_of(study, result.row);
    for (std::size_t f = 0; f < values.size(); ++f) values[f].push_back(row.values[f]);
    std::vector<std::pair<std::string, Cell>> cells = result.values;
    cells.insert(cells.end(), result.clock.begin(), result.clock.end());
    for (const auto& [name, cell] : cells) {
      const auto* number = std::get_if<double>(&cell);
      if (number == nullptr || !std::isfinite(*number)) continue;
      auto index = static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
      if (index == names.size()) {
        if (names.size() >= kMostOutputs) continue;
        names.push_back(name);
        samples.emplace_back();
      }
      samples[index].y.push_back(*number);
      samples[index].at.push_back(at);
    }
  });
  std::vector<Levels> levels;
  for (const std::vector<std::string>& of_factor : values) levels.push_back(find_levels(of_factor));
  std::vector<OutputEffects> all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto [low, high] = std::ranges::minmax(samples[i].y);
    if (study.outputs.empty() && low == high) continue;
    OutputEffects effects;
    effects.output = names[i];
    Analysis(study, samples[i], levels).fill(effects);
    const auto asked = std::ranges::find(study.outputs, names[i], &Output::name);
    const bool is_low = asked == study.outputs.end() || asked->is_worst_low;
    std::vector<std::size_t> order(samples[i].y.size());
    std::iota(order.begin(), order.end(), 0U);
    const std::size_t count = std::min(worst_rows, order.size());
    std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(count), {}, [&](std::size_t k) {
      return std::pair(is_low ? samples[i].y[k] : -samples[i].y[k], samples[i].at[k]);
    });
    for (std::size_t k = 0; k < count; ++k) {
      effects.worst.push_back(rows[samples[i].at[order[k]]]);
      effects.worst_values.push_back(samples[i].y[order[k]]);
    }
    all.push_back(std::move(effects));
  }
  return all;
}

}  // namespace snug::study
