// fit_clock: where the clock of one source is on that of another, from what both saw.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "snug/core/expected.hpp"

namespace snug::validation {

/// Quantities that two sources saw, each on its own clock. The k-th channel of one belongs to the k-th of the other;
/// all channels have the same unit. NaN where a value is missing.
struct Signals {
  std::vector<double> times;                  ///< s, strictly increasing
  std::vector<std::vector<double>> channels;  ///< each as long as `times`
};

/// The measuring clock, or what it measures, slipped: from here on it shows so much more.
struct ClockStep {
  double time = 0.0;   ///< s, on the reference clock
  double size = 0.0;   ///< s
  double error = 0.0;  ///< s, standard error of the size
};

/// time on the measuring clock = t + shift + rate (t - middle) + sizes of steps before t, t on the reference clock.
struct ClockFit {
  double shift = 0.0;        ///< s, at `middle`
  double shift_error = 0.0;  ///< s, standard error; 0 when set by hand
  double rate = 0.0;         ///< 1; 0 when it was not fitted
  double rate_error = 0.0;   ///< 1, standard error
  double middle = 0.0;       ///< s, on the reference clock
  double correlation = 0.0;  ///< of the two, all channels together, with this fit
  int blocks = 0;            ///< spans of 5 s with motion that the errors come from
  bool is_by_hand = false;
  std::vector<ClockStep> steps = {};  ///< in order of time

  [[nodiscard]] double slipped(double reference) const {
    double sum = 0.0;
    for (const ClockStep& step : steps) sum += reference > step.time ? step.size : 0.0;
    return sum;
  }
  [[nodiscard]] double to_measured(double reference) const {
    return reference + shift + rate * (reference - middle) + slipped(reference);
  }
  /// What a slip repeats or leaves out is at its time.
  [[nodiscard]] double to_reference(double measured) const {
    double sum = 0.0, reference = middle + (measured - middle - shift) / (1.0 + rate);
    for (const ClockStep& step : steps) {
      const double after = middle + (measured - middle - shift - sum - step.size) / (1.0 + rate);
      if (!(after > step.time)) return std::min(reference, step.time);
      sum += step.size;
      reference = after;
    }
    return reference;
  }
};

struct ClockOptions {
  double longest_shift = 60.0;   ///< s, looked for in both directions
  double highest_rate = 200e-6;  ///< a fitted rate beyond this is no clock's error: it is then left at 0
  double usual_rate = 50e-6;     ///< 1, expected of clocks (standard deviation): quartzes are good to 20 to 100 ppm
  bool finds_steps = true;       ///< slips of one of the two are told from drift
  bool removes_offsets = false;  ///< the two may differ by a constant in each channel (the bias of a sensor)
};

enum class NoClock { NothingInCommon, NothingMoves, TooUnlike };
/// For people.
[[nodiscard]] const char* describe(NoClock reason);

/// The clock at which `measured` is most like `reference`: first by the normalised cross-correlation of all channels
/// together at every shift on a grid of 0.1 s, then by least squares between the grid's points, with the influence of
/// single spikes bounded. Standard errors come from the scatter over blocks of 5 s, so errors of the model that last
/// for seconds count in them. A step is one where shifts of blocks of 5 s before and after differ by far more than
/// chance (a chi-square of 25) and half a millisecond, and a rate that clocks have does not explain them. Refused when
/// the best correlation is below 0.5.
[[nodiscard]] Expected<ClockFit, NoClock> fit_clock(const Signals& reference, const Signals& measured,
                                                    const ClockOptions& options = {});

}  // namespace snug::validation
