// Calibration: is what a session expects of its motions what happens, in bins of ten percent.
#include "snug/study/calibration.hpp"

#include <algorithm>

namespace snug::study {

void Calibration::add(const Trial& trial) {
  for (std::size_t i = 0; i < trial.items.size(); ++i) {
    const session::ItemReport& report = trial.session.items[i];
    if (report.samples == 0) continue;
    for (std::size_t k = 0; k < report.sends.size(); ++k) {
      const double predicted = std::clamp(report.sends[k].predicted_success, 0.0, 1.0);
      CalibrationBin& bin = bins[std::min(bins.size() - 1, static_cast<std::size_t>(10.0 * predicted))];
      ++bin.motions;
      bin.succeeded += trial.items[i].succeeded[k] ? 1 : 0;
      bin.predicted += predicted;
    }
  }
}

void Calibration::add(const Calibration& other) {
  for (std::size_t i = 0; i < bins.size(); ++i) {
    bins[i].motions += other.bins[i].motions;
    bins[i].succeeded += other.bins[i].succeeded;
    bins[i].predicted += other.bins[i].predicted;
  }
}

}  // namespace snug::study
