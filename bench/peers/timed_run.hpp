// What every measurement uses: steps of a given duration, their processor time, the largest value seen.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "peers/engine.hpp"

namespace snug::peers {

inline constexpr double kDt = 1e-3;       // s, of every scene but S5 and piles
inline constexpr double kGravity = 9.81;  // m/s^2

/// Largest value seen; once not a number, always not a number.
class Largest {
 public:
  void see(double value) {
    if (std::isnan(value) || value > value_) value_ = std::isnan(value_) ? value_ : value;
  }
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_ = 0.0;
};

/// Microseconds of CPU per step in the best whole second of simulated time, and in all of them.
class StepTimer {
 public:
  explicit StepTimer(const Engine& engine) : engine_(engine) {}
  template <class Work>
  void time(int steps, Work&& work) {
    const double begin = engine_.cpu_seconds();
    work();
    const double spent = engine_.cpu_seconds() - begin;
    second_ += spent;
    total_ += spent;
    steps_ += steps;
    if (steps_ % kStepsPerSecond != 0) return;
    best_ = std::min(best_, second_ / kStepsPerSecond);
    second_ = 0.0;
  }
  [[nodiscard]] double best_us() const { return 1e6 * best_; }
  [[nodiscard]] double mean_us() const { return 1e6 * total_ / steps_; }

 private:
  static constexpr int kStepsPerSecond = 1000;
  const Engine& engine_;
  double best_ = std::numeric_limits<double>::max(), second_ = 0.0, total_ = 0.0;
  int steps_ = 0;
};

inline void run(Engine& engine, double duration) {
  for (int i = 0; i < std::lround(duration / kDt); ++i) engine.step();
}

}  // namespace snug::peers
