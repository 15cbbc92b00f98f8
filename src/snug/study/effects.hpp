// Effects: what the factors of a study do to its outputs: levels, main effects, interactions, quantiles, worst rows.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "snug/study/merge.hpp"

namespace snug::study {

/// A value of a factor, or a range of values.
struct Level {
  std::string label;
  double mean = 0.0;
  double error = 0.0;  ///< standard error of the mean
  std::uint64_t count = 0;
};

struct MainEffect {
  std::string factor;
  std::vector<Level> levels;
  /// Part of the output's variance between the levels, less what chance alone would put there (omega squared): 0 or
  /// below: none seen.
  double share = 0.0;
  bool is_seen = false;  ///< it stands out from chance by two standard deviations, and from rounding
};

struct Interaction {
  std::string first, second;
  /// The same of what the pair explains beyond both main effects; an estimate that needs many rows in each cell.
  double share = 0.0;
  bool is_seen = false;
};

struct OutputEffects {
  std::string output;
  std::uint64_t count = 0;  ///< rows that have it
  double mean = 0.0, deviation = 0.0;
  bool is_noise = false;              ///< rows differ by no more than the computation itself errs: no effect is seen
  std::array<double, 7> quantiles{};  ///< 0, 5, 25, 50, 75, 95, 100 percent
  std::vector<MainEffect> main;       ///< in the order of the factors
  std::vector<Interaction> interactions;  ///< largest share first
  std::vector<std::uint64_t> worst;       ///< rows
  std::vector<double> worst_values;
};

inline constexpr std::array<int, 7> kQuantilePercents = {0, 5, 25, 50, 75, 95, 100};
/// Deviations that are noise of the computation: of the largest value, and in the value's own unit. Solvers stop when
/// they are near enough, so that even runs without anything random differ by that where a factor has no influence.
inline constexpr double kRelativeNoise = 1e-6, kAbsoluteNoise = 1e-7;
/// Ranges into which the values of a factor are cut where it has more.
inline constexpr std::size_t kMostLevels = 6;

/// Of each numeric output: of those that the study names, else of all that vary. Rows that failed count where they have
/// the number. The shares that are seen add up to at most 1: where designs are not balanced, factors overlap and each
/// gets less by the same ratio.
[[nodiscard]] std::vector<OutputEffects> find_effects(const Study& study, const Folder& folder,
                                                      std::size_t worst_rows = 10);

/// The page: one HTML file without scripts, with the commands that repeat the worst rows.
[[nodiscard]] std::string make_page(const Study& study, const Status& status,
                                    const std::vector<OutputEffects>& effects);

}  // namespace snug::study
