// Program clock: where a robot's log stands in time beside a run of the program that the robot was sent.
#include "snug/identification/internal/program_clock.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "snug/identification/recorded_drive.hpp"

namespace snug::identification::internal {
namespace {

constexpr double kReach = 0.15;        // s, about the guess
constexpr double kBeforeVacuum = 0.2;  // s: the lip touches before the vacuum is switched on
constexpr double kLeastWay = 0.05;     // m
constexpr double kForever = std::numeric_limits<double>::infinity();

/// Mean square distance of the tools over the log's first `count` samples, those that the run has.
double mean_square(const validation::SimulatedRun& run, const record::RobotLog& log, std::size_t count, double start) {
  validation::PoseCursor cursor(run.times, run.tool);
  double sum = 0.0, compared = 0.0;
  for (std::size_t k = 0; k < count; ++k) {
    const record::PoseSample X_WE = cursor.at(log.times[k] - start, kForever);
    if (!record::is_tracked(X_WE)) continue;
    sum += (X_WE.p - log.tool[k].p).squaredNorm();
    compared += 1.0;
  }
  return compared > 0.0 ? sum / compared : kForever;
}

}  // namespace

std::optional<double> find_program_start(const validation::SimulatedRun& run, const record::ArchiveRecording& recording,
                                         double guess) {
  const record::RobotLog& log = recording.robot;
  const std::vector<std::uint8_t> vacuum = run_of_log(recording, {}).vacuum;
  const auto on = std::ranges::find(vacuum, std::uint8_t{1});
  if (on == vacuum.end()) return std::nullopt;
  const double until = log.times[static_cast<std::size_t>(on - vacuum.begin())] - kBeforeVacuum;
  const auto count = static_cast<std::size_t>(std::ranges::lower_bound(log.times, until) - log.times.begin());
  double way = 0.0;
  for (std::size_t k = 1; k < count; ++k) way += (log.tool[k].p - log.tool[k - 1].p).norm();
  if (way < kLeastWay) return std::nullopt;
  double best = guess;
  for (double step = 4e-3, reach = kReach; step > 1e-6; reach = step, step *= 0.1) {
    const double middle = best;
    double least = kForever;
    const int steps = static_cast<int>(std::round(reach / step));
    for (int i = -steps; i <= steps; ++i) {
      const double start = middle + i * step;
      const double square = mean_square(run, log, count, start);
      if (square >= least) continue;
      least = square;
      best = start;
    }
  }
  return best;
}

double find_path_distance(const validation::SimulatedRun& run, const record::ArchiveRecording& recording, double start,
                          double early_or_late) {
  constexpr double kTick = 8e-3;  // s
  const record::RobotLog& log = recording.robot;
  std::vector<double> least(log.times.size(), kForever);
  const int steps = static_cast<int>(std::ceil(early_or_late / kTick));
  for (int i = -steps; i <= steps; ++i) {
    validation::PoseCursor cursor(run.times, run.tool);
    for (std::size_t k = 0; k < log.times.size(); ++k) {
      const record::PoseSample X_WE = cursor.at(log.times[k] - start + i * kTick, kForever);
      if (record::is_tracked(X_WE)) least[k] = std::min(least[k], (X_WE.p - log.tool[k].p).squaredNorm());
    }
  }
  double sum = 0.0, compared = 0.0;
  for (const double square : least) {
    if (!std::isfinite(square)) continue;
    sum += square;
    compared += 1.0;
  }
  return compared > 0.0 ? std::sqrt(sum / compared) : kForever;
}

}  // namespace snug::identification::internal
