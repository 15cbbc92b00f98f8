// Pile bench: how large islands and random drops are solved, and what a second thread gains.
#include "bench/figures/internal/pile_bench.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <string_view>

#include "bench/figures/drawn_scenes.hpp"
#include "bench/figures/internal/cpu_time.hpp"
#include "bench/figures/internal/scene_bench.hpp"
#include "snug/cell/scene.hpp"
#include "snug/core/parallel.hpp"
#include "snug/core/units.hpp"
#include "snug/runs/run.hpp"

namespace snug::bench::internal {
namespace {

using cell::Scene;
using physics::StepStatus;

constexpr Pile kPiles[] = {
    {100, 5, 1}, {300, 7, 2}, {1000, 11, 3}, {3000, 40, 4}};  // the last: small heaps side by side
constexpr int kPileSteps = 700;                               ///< 1.4 s: they fall, land and settle
/// In one heap each, until they lie.
constexpr Pile kHeaps[] = {{300, 7, 2}, {1000, 11, 3}, {3000, 15, 4}, {10000, 22, 5}};
constexpr double kWindow = 0.2;  ///< s
constexpr int kWindowSteps = 100, kHeapWindows = 20;

bool is_wanted(const BenchOptions& options, const std::string& name) {
  return name.starts_with(options.only) || options.only.starts_with(name);
}

/// What the reports of many steps come to.
struct Quality {
  int steps = 0, unconverged = 0;
  double residual = 0.0, depth = 0.0;  ///< m/s, m

  void add(const physics::StepReport& report) {
    ++steps;
    if (report.status != StepStatus::Converged) ++unconverged;
    residual = std::max(residual, report.residual);
    depth = std::max(depth, report.worst_penetration);
  }
  void add(const Quality& other) {
    steps += other.steps;
    unconverged += other.unconverged;
    residual = std::max(residual, other.residual);
    depth = std::max(depth, other.depth);
  }
};

void add_quality(const std::string& name, const Quality& quality, std::vector<Figure>& figures) {
  const double converged = 100.0 * (quality.steps - quality.unconverged) / quality.steps;
  figures.push_back({name + "converged_percent", converged, "%", ">= 99.9", converged >= 99.9});
  figures.push_back({name + "residual_m_s", quality.residual, "m/s", "", true});
  figures.push_back({name + "rigid_depth_mm", kMm * quality.depth, "mm", "", true});
}

/// What the process has in memory now, without what it reads from files, such as its own code.
double anonymous_bytes() {
  std::ifstream file("/proc/self/statm");
  double all = 0.0, resident = 0.0, of_files = 0.0;
  file >> all >> resident >> of_files;
  return (resident - of_files) * static_cast<double>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

void measure_piles(const BenchOptions& options, std::vector<Figure>& figures) {
  constexpr double kTargets[] = {6.0, 9.0, 12.0, 10.0};
  double costs[4] = {};
  for (std::size_t i = 0; i < 4; ++i) {
    const Pile& pile = kPiles[i];
    const std::string name = fmt::format("piles.{}.", pile.count);
    if (!is_wanted(options, name) && !is_wanted(options, "piles.growth")) continue;
    Scene scene(drawn_pile(pile));
    Quality quality;
    const double start = cpu_seconds();
    for (int step = 0; step < kPileSteps; ++step) quality.add(scene.advance());
    costs[i] = 1e6 * (cpu_seconds() - start) / (static_cast<double>(kPileSteps) * pile.count);
    figures.push_back(at_most(name + "us_per_body_and_step", costs[i], "us", kTargets[i]));
    add_quality(name, quality, figures);
  }
  if (costs[0] > 0.0 && costs[3] > 0.0) figures.push_back(at_most("piles.growth", costs[3] / costs[0], "1", 2.0));
}

void measure_heaps(const BenchOptions& options, std::vector<Figure>& figures) {
  constexpr double kTargets[] = {8.0, 12.0, 14.0, 16.0};
  for (std::size_t i = 0; i < std::size(kHeaps); ++i) {
    const Pile& pile = kHeaps[i];
    const std::string name = fmt::format("heaps.{}", pile.count);
    // Those of 3000 and 10 000 take many minutes: only where they are asked for by their names.
    const bool is_asked = options.only == name || options.only.starts_with(name + ".");
    if (!is_asked && (pile.count > 1000 || !std::string_view("heaps").starts_with(options.only))) continue;
    const model::Scenario scenario = drawn_pile(pile);
    const double memory = anonymous_bytes();  // of the world alone: text takes more while it is read
    Scene scene(scenario);
    figures.push_back(
        {name + ".kB_per_body_at_start", 1e-3 * (anonymous_bytes() - memory) / pile.count, "kB", "", true});
    Quality quality;
    double worst = 0.0, worst_end = 0.0;
    for (int window = 1; window <= kHeapWindows; ++window) {
      const double start = cpu_seconds();
      for (int step = 0; step < kWindowSteps; ++step) quality.add(scene.advance());
      const double cost = 1e6 * (cpu_seconds() - start) / (static_cast<double>(kWindowSteps) * pile.count);
      const double end = kWindow * window;
      figures.push_back({fmt::format("{}.{:.1f}s.us_per_body_and_step", name, end), cost, "us", "", true});
      if (cost > worst) worst = cost, worst_end = end;
    }
    figures.push_back(at_most(name + ".worst.us_per_body_and_step", worst, "us", kTargets[i]));
    figures.push_back({name + ".worst.window_end_s", worst_end, "s", "", true});
    add_quality(name + ".", quality, figures);
    const double memory_used = 1e-3 * (anonymous_bytes() - memory) / pile.count;
    figures.push_back(at_most(name + ".kB_per_body", memory_used, "kB", 20.0));
  }
}

namespace {

/// Two worlds of one scenario. The same steps are done several times in turn, and the least times count, since what
/// else the machine does comes and goes.
class OneAndTwoThreads {
 public:
  explicit OneAndTwoThreads(const model::Scenario& scenario) : one_(scenario), two_(scenario, 2) {}

  /// How many times as fast the one with two threads was over `steps` steps, by the clock.
  double advance(int steps, int times = 3) {
    const cell::SceneState start = one_.snapshot();
    double least_one = 0.0, least_two = 0.0;
    for (int i = 0; i < times; ++i) {
      one_.restore(start), two_.restore(start);
      const double one = advance(one_, steps), two = advance(two_, steps);
      least_one = i == 0 ? one : std::min(least_one, one);
      least_two = i == 0 ? two : std::min(least_two, two);
      is_same_ = is_same_ && one_.state() == two_.state();
    }
    return least_one / least_two;
  }
  [[nodiscard]] bool is_same() const { return is_same_; }

 private:
  static double advance(Scene& scene, int count) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    for (int i = 0; i < count; ++i) (void)scene.advance();
    return std::chrono::duration<double>(Clock::now() - start).count();
  }

  Scene one_, two_;
  bool is_same_ = true;
};

void add_speedup(const std::string& name, double ratio, double target, std::vector<Figure>& figures) {
  const char* why_not = core_count() >= 2 ? "" : "one core";
  figures.push_back({name, ratio, "1", fmt::format(">= {:.1f}", target), ratio >= target, why_not});
}

void add_same_bytes(const std::string& name, bool is_same, std::vector<Figure>& figures) {
  figures.push_back({name + "same_bytes", is_same ? 1.0 : 0.0, "1", "= 1", is_same});
}

}  // namespace

void measure_threads(const BenchOptions& options, std::vector<Figure>& figures) {
  constexpr int kBefore = 250, kSteps = 100;
  for (const Pile& pile : {kPiles[2], kPiles[3]}) {
    const std::string name = fmt::format("threads.{}.", pile.count);
    if (!is_wanted(options, name)) continue;
    OneAndTwoThreads worlds(drawn_pile(pile));
    (void)worlds.advance(kBefore, 1);
    add_speedup(name + "speedup_of_two", worlds.advance(kSteps), 1.6, figures);
    add_same_bytes(name, worlds.is_same(), figures);
  }
  // One heap of 1000 until it lies: minutes, so only where it is asked for by its name.
  if (!options.only.starts_with("threads.heap")) return;
  OneAndTwoThreads worlds(drawn_pile(kHeaps[1]));
  for (int window = 1; window <= kHeapWindows; ++window)
    add_speedup(fmt::format("threads.heap.{:.1f}s.speedup_of_two", kWindow * window), worlds.advance(kWindowSteps), 1.5,
                figures);
  add_same_bytes("threads.heap.", worlds.is_same(), figures);
}

void measure_random_drops(const BenchOptions& options, std::vector<Figure>& figures) {
  constexpr double kSteps[] = {0.0005, 0.001, 0.002, 0.005}, kRatios[] = {100.0, 1000.0};
  constexpr double kDuration = 2.0;  // s
  std::vector<Quality> found(static_cast<std::size_t>(options.drop_scenes));
  const int threads = core_count();
  parallel_for(options.drop_scenes, threads, [&](int i, int) {
    Scene scene(drawn_drop({kSteps[i % 4], kRatios[i / 4 % 2], static_cast<std::uint64_t>(i + 1)}));
    Quality& quality = found[static_cast<std::size_t>(i)];
    for (int step = static_cast<int>(std::lround(kDuration / kSteps[i % 4])); step > 0; --step) {
      const physics::StepReport report = scene.advance();
      quality.add(report);
      if (report.status == StepStatus::NotFinite || report.status == StepStatus::TooManyPairs) break;
    }
  });
  Quality all, by_step[4], even[4];  // even: mass ratios to 100
  for (std::size_t i = 0; i < found.size(); ++i) {
    all.add(found[i]);
    by_step[i % 4].add(found[i]);
    if (i / 4 % 2 == 0) even[i % 4].add(found[i]);
  }
  const char* const names[] = {"drops.0.5ms.", "drops.1ms.", "drops.2ms.", "drops.5ms."};
  for (std::size_t k = 0; k < 4; ++k) {
    const std::string name = names[k];
    const double percent = by_step[k].steps > 0 ? 100.0 * by_step[k].unconverged / by_step[k].steps : 0.0;
    figures.push_back(at_most(name + "unconverged_percent", percent, "%", k < 3 ? 0.0 : 0.1));
    const double depth = kMm * even[k].depth;
    if (k == 1 || k == 3) {
      figures.push_back(at_most(name + "rigid_depth_mm", depth, "mm", k == 1 ? 1.0 : 3.0));
    } else {
      figures.push_back({name + "rigid_depth_mm", depth, "mm", "", true});
    }
    figures.push_back({name + "rigid_depth_mm_ratio_1000", kMm * by_step[k].depth, "mm", "", true});
  }
  figures.push_back({"drops.residual_m_s", all.residual, "m/s", "", true});
  figures.push_back({"drops.scenes", static_cast<double>(options.drop_scenes), "1", "", true});
  figures.push_back({"drops.steps", static_cast<double>(all.steps), "1", "", true});
}

void measure_hard_scenes(const BenchOptions& options, std::vector<Figure>& figures) {
  std::vector<std::filesystem::path> files;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(options.hard_scenes, error)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  if (files.empty()) {
    figures.push_back({"scenes.unconverged_steps", 0.0, "steps", "", true, "no folder of scenes"});
    return;
  }
  int unsaid = 0;
  for (const std::filesystem::path& file : files) {
    const std::string name = fmt::format("scenes.{}.unconverged_steps", file.stem().string());
    if (!is_wanted(options, name) && !is_wanted(options, "scenes.unsaid_limits")) continue;
    const model::Scenario scenario = model::load_scenario(file);
    const runs::RunResult result = runs::run(scenario, {});
    const bool has_failed = static_cast<bool>(result.failure);
    const auto count = static_cast<double>(result.solver.not_converged);
    figures.push_back({name, count, "steps", "0 or failed", count == 0.0 || has_failed});
    const model::ContactLimits& limits = scenario.solver.contact_limits;
    const bool is_too_deep = result.solver.worst_penetration > limits.rigid_depth ||
                             result.solver.worst_compliant_depth > limits.compliant_depth;
    if (is_too_deep && !has_failed) ++unsaid;
  }
  figures.push_back(at_most("scenes.unsaid_limits", unsaid, "scenes", 0.0));
}

}  // namespace snug::bench::internal
