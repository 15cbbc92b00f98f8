// How a cup lets go, from recorded releases: its numbers with errors, and how well it predicts masses left out.
#pragma once

#include <string>
#include <vector>

#include "snug/identification/parameter.hpp"
#include "snug/identification/recorded_releases.hpp"
#include "snug/model/cup_params.hpp"

namespace snug::identification {

/// Of all recordings of one mass.
struct ReleaseMassError {
  double mass = 0.0;  ///< kg
  int recordings = 0;
  double rms = 0.0;                ///< m, of all heights of the box, from where it hung
  double scatter = 0.0;            ///< m, rms of the recordings about their mean: no model of the mass goes below it
  double opening = 0.0;            ///< s, mean of the model
  double recorded_opening = -1.0;  ///< s, mean; negative: not seen
};

struct ReleaseErrors {
  double rms = 0.0;             ///< m, heights of the box over all recordings, from where it hung
  double opening_error = -1.0;  ///< s, root mean square over masses; negative: not seen
  std::vector<ReleaseMassError> masses;
};
/// What this cup predicts, beside what was recorded.
[[nodiscard]] ReleaseErrors evaluate_release(const std::vector<RecordedRelease>& releases, const model::CupParams& cup);

struct CupReleaseFit {
  std::vector<Parameter> parameters;  ///< standard errors: jackknife over masses; above 20 % not identifiable
  model::CupParams cup;               ///< the one that the search began with, with the numbers found
  ReleaseErrors errors;               ///< on what was fitted
  ReleaseErrors held_back;            ///< each mass predicted by a fit of the others
};

/// Least squares over cup.release, from the mean over the recordings of each mass; one of recordings that were taken at
/// other times stands for itself. A number is expected within a factor of two (one deviation) of the defaults of
/// model::ReleaseParams. What no height of a hanging box tells stays as in `start`: the area on which pressure acts,
/// and all but `release`. Where the lip was tracked, lengths and time of opening count too. Throws InputError for fewer
/// than three masses.
[[nodiscard]] CupReleaseFit identify_release(const std::vector<RecordedRelease>& releases,
                                             const model::CupParams& start);

/// A `cup: release:` block of a scenario. Numbers that are not identified are said to be so.
[[nodiscard]] std::string format_release_block(const CupReleaseFit& fit, const std::string& note);

}  // namespace snug::identification
