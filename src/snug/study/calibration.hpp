// Calibration: is what a session expects of its motions what happens, in bins of ten percent.
#pragma once

#include <array>

#include "snug/study/trial.hpp"

namespace snug::study {

struct CalibrationBin {
  int motions = 0;         ///< that were sent with a success predicted in this bin
  int succeeded = 0;       ///< of them: ended as planned and needed no remedy
  double predicted = 0.0;  ///< sum of the successes that were predicted, 0 .. 1 each
};

/// Bin i: predicted success in [i / 10, (i + 1) / 10), the last one with 1.
struct Calibration {
  std::array<CalibrationBin, 10> bins;

  /// Counts the motions of a trial. Those of items that were rehearsed in no sampled world have no prediction.
  void add(const Trial& trial);
  void add(const Calibration& other);
};

}  // namespace snug::study
