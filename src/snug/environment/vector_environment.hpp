// VectorEnvironment: many environments stepped at once on a few threads.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "snug/core/worker_pool.hpp"
#include "snug/environment/environment.hpp"

namespace snug::environment {

/// Where step() writes what happened, one entry for each environment.
struct BatchView {
  std::span<double> reward;
  std::span<std::uint8_t> terminated, truncated;
};

/// Each environment has its own scenario, parameters and seed, and shares nothing with the others: what it does depends
/// neither on how many there are nor on the number of threads. One that has ended begins anew in the next step, whose
/// action is not looked at and whose reward is 0 (Gymnasium's "next step" resets), with a seed from its own.
class VectorEnvironment {
 public:
  /// They must be alike: same rows, columns, boxes and candidates. Throws InputError otherwise.
  VectorEnvironment(std::vector<Environment> environments, int threads);

  /// `observe(i)` is called on the thread that has just worked on environment i.
  using Observe = std::function<void(int index, const Environment& environment)>;
  void reset(std::span<const std::uint64_t> seeds, const Observe& observe);
  /// Only those with a mask that is not 0 begin anew; all are observed.
  void reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds, const Observe& observe);
  /// `next_seeds`: of the episodes that begin in this step, one for each environment; empty: drawn from the seeds of
  /// the last reset.
  void step(std::span<const Action> actions, std::span<const std::uint64_t> next_seeds, const BatchView& results,
            const Observe& observe);
  void step(std::span<const Action> actions, const BatchView& results, const Observe& observe) {
    step(actions, {}, results, observe);
  }

  [[nodiscard]] int count() const { return static_cast<int>(environments_.size()); }
  [[nodiscard]] const Environment& environment(int index) const {
    return environments_[static_cast<std::size_t>(index)];
  }
  /// Why it ended, of the last step; empty while it goes on.
  [[nodiscard]] std::string_view reason(int index) const { return reasons_[static_cast<std::size_t>(index)]; }

 private:
  /// Throws what the job of the lowest index throws.
  void for_each(const std::function<void(int)>& job);

  std::vector<Environment> environments_;
  std::vector<std::uint64_t> seeds_;
  std::vector<std::uint64_t> episodes_;
  std::vector<std::string_view> reasons_;
  std::unique_ptr<WorkerPool> pool_;
};

}  // namespace snug::environment
