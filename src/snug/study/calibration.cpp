// Calibration: is what a session expects of its motions what happens, in bins of ten percent.
#include "snug/study/calibration.hpp"

#include <algorithm>

namespace snug::study {

void Calibration::add(const Trial& trial) {
  for (const session::ItemReport& report : trial.session.items) {  // those left out when planned have no truth
    const auto truth = std::ranges::find(trial.items, report.id, &TrueItem::id);
    if (truth == trial.items.end() || report.samples == 0) continue;
    for (std::size_t k = 0; k < std::min(report.sends.size(), truth->succeeded.size()); ++k) {
      const double predicted = std::clamp(report.sends[k].predicted_success, 0.0, 1.0);
      CalibrationBin& bin = bins[std::min(bins.size() - 1, static_cast<std::size_t>(10.0 * predicted))];
      ++bin.motions;
      bin.succeeded += truth->succeeded[k] ? 1 : 0;
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
