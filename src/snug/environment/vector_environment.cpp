// VectorEnvironment: environments in blocks, a few blocks for each thread.
#include "snug/environment/vector_environment.hpp"

#include <algorithm>
#include <exception>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"

namespace snug::environment {
namespace {

constexpr int kBlocksAThread = 8;  ///< environments differ in what they have to do

void expect_one_each(const char* what, std::size_t got, std::size_t expected) {
  if (got != expected) throw InputError("environments", what, std::to_string(got), std::to_string(expected));
}

}  // namespace

VectorEnvironment::VectorEnvironment(std::vector<Environment> environments, int threads)
    : environments_(std::move(environments)),
      seeds_(environments_.size()),
      episodes_(environments_.size()),
      reasons_(environments_.size()) {
  if (environments_.empty()) throw InputError("environments", "", "none", "one or more");
  if (threads < 1 || threads > 256) throw InputError("environments", "threads", std::to_string(threads), "1 .. 256");
  const Environment& first = environments_.front();
  for (const Environment& one : environments_) {
    if (one.rows() == first.rows() && one.columns() == first.columns() && one.most_boxes() == first.most_boxes() &&
        one.settings().max_candidates == first.settings().max_candidates)
      continue;
    throw InputError("environments", "scenarios", "containers or numbers of boxes that differ",
                     "observations of one shape");
  }
  pool_ = std::make_unique<WorkerPool>(threads);
}

void VectorEnvironment::for_each(const std::function<void(int)>& job) {
  const int blocks = pool_->size() == 1 ? 1 : std::min(count(), pool_->size() * kBlocksAThread);
  std::vector<std::exception_ptr> errors(static_cast<std::size_t>(blocks));
  pool_->run(blocks, [&](int block, int) {
    const int end = static_cast<int>(static_cast<std::int64_t>(block + 1) * count() / blocks);
    try {
      for (int i = static_cast<int>(static_cast<std::int64_t>(block) * count() / blocks); i < end; ++i) job(i);
    } catch (...) {
      errors[static_cast<std::size_t>(block)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
}

void VectorEnvironment::reset(std::span<const std::uint64_t> seeds, const Observe& observe) {
  reset(std::vector<std::uint8_t>(environments_.size(), 1), seeds, observe);
}

void VectorEnvironment::reset(std::span<const std::uint8_t> mask, std::span<const std::uint64_t> seeds,
                              const Observe& observe) {
  expect_one_each("seeds", seeds.size(), environments_.size());
  expect_one_each("mask", mask.size(), environments_.size());
  for_each([&](int i) {
    const auto k = static_cast<std::size_t>(i);
    if (mask[k] != 0) {
      seeds_[k] = seeds[k];
      episodes_[k] = 0;
      environments_[k].reset(seeds_[k]);
      reasons_[k] = {};
    }
    observe(i, environments_[k]);
  });
}

void VectorEnvironment::step(std::span<const Action> actions, std::span<const std::uint64_t> next_seeds,
                             const BatchView& results, const Observe& observe) {
  expect_one_each("actions", actions.size(), environments_.size());
  if (!next_seeds.empty()) expect_one_each("next_seeds", next_seeds.size(), environments_.size());
  for_each([&](int i) {
    const auto k = static_cast<std::size_t>(i);
    Environment& environment = environments_[k];
    Step result;
    if (environment.has_ended()) {
      ++episodes_[k];
      environment.reset(next_seeds.empty() ? Rng(seeds_[k]).split("episode " + std::to_string(episodes_[k])).next()
                                           : next_seeds[k]);
    } else {
      result = environment.step(actions[k]);
    }
    results.reward[k] = result.reward;
    results.terminated[k] = result.terminated ? 1 : 0;
    results.truncated[k] = result.truncated ? 1 : 0;
    reasons_[k] = result.reason;
    observe(i, environment);
  });
}

}  // namespace snug::environment
