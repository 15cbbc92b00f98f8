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

/// Makes each of `least`, of the log's first samples, as small as the square of how far its tool is from the run's.
void take_squares(const validation::SimulatedRun& run, const record::RobotLog& log,
                  const std::function<double(double)>& to_run, std::vector<double>& least) {
  validation::PoseCursor cursor(run.times, run.tool);
  for (std::size_t k = 0; k < least.size(); ++k) {
    const record::PoseSample X_WE = cursor.at(to_run(log.times[k]), kForever);
    if (record::is_tracked(X_WE)) least[k] = std::min(least[k], (X_WE.p - log.tool[k].p).squaredNorm());
  }
}

/// Of those that are finite; infinite where none is.
double root_mean(const std::vector<double>& squares) {
  double sum = 0.0, count = 0.0;
  for (const double square : squares) {
    if (!std::isfinite(square)) continue;
    sum += square;
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(sum / count) : kForever;
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
      std::vector<double> squares(count, kForever);
      take_squares(
          run, log, [start](double time) { return time - start; }, squares);
      const double distance = root_mean(squares);
      if (distance >= least) continue;
      least = distance;
      best = start;
    }
  }
  return best;
}

double find_path_distance(const validation::SimulatedRun& run, const record::ArchiveRecording& recording,
                          const std::function<double(double)>& to_run, double early_or_late) {
  constexpr double kTick = 8e-3;  // s
  std::vector<double> least(recording.robot.times.size(), kForever);
  const int steps = static_cast<int>(std::ceil(early_or_late / kTick));
  for (int i = -steps; i <= steps; ++i)
    take_squares(
        run, recording.robot, [&](double time) { return to_run(time) + i * kTick; }, least);
  return root_mean(least);
}

}  // namespace snug::identification::internal
