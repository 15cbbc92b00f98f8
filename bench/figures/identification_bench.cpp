// measure_identification: reference data, and virtual experiments with a known truth.
#include "bench/figures/internal/identification_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "bench/figures/internal/cpu_time.hpp"
#include "bench/figures/internal/planted_bench.hpp"
#include "snug/cup/law.hpp"
#include "snug/identification/damping.hpp"
#include "snug/identification/stiffness.hpp"
#include "snug/identification/virtual_experiments.hpp"
#include "snug/identification/virtual_lift.hpp"

namespace snug::bench::internal {
namespace {

using identification::StaticPoses;
using identification::StiffnessFit;
using identification::StiffnessMethod;
using identification::StiffnessOptions;

// What the reference sets were made with (README of the data).
constexpr model::CupElasticity kTruth{2300.0, 5500.0, 5.5, 2.8, -20.0};
constexpr std::array<double, 5> kTrueNumbers = {2300.0, 5500.0, 5.5, 2.8, -20.0};

Figure below(const std::string& name, double value, const char* unit, double limit) {
  return {"identification." + name, value, unit, fmt::format("<= {}", limit), value <= limit};
}

Figure between(const std::string& name, double value, const char* unit, double low, double high) {
  return {"identification." + name, value, unit, fmt::format("{} .. {}", low, high), value >= low && value <= high};
}

double percent_off(double value, double truth) { return 100.0 * std::abs(value / truth - 1.0); }

double worst_stiffness_percent(const StiffnessFit& fit) {
  double worst = 0.0;
  for (std::size_t i = 0; i < 4; ++i) worst = std::max(worst, percent_off(fit.parameters[i].value, kTrueNumbers[i]));
  return worst;
}

void measure_reference_poses(const std::filesystem::path& file, std::vector<Figure>& figures) {
  const StaticPoses poses = identification::load_static_poses(file);
  StaticPoses twice = poses;  // the times are for 1200 poses
  twice.poses.insert(twice.poses.end(), poses.poses.begin(), poses.poses.end());
  const struct {
    StiffnessMethod method;
    const char* name;
    double percent, coupling_percent, milliseconds;
  } methods[] = {{StiffnessMethod::Compliance, "compliance", 3.0, 10.0, 20.0},
                 {StiffnessMethod::ErrorsInVariables, "errors_in_variables", 2.0, 6.0, 1000.0}};
  for (const auto& method : methods) {
    StiffnessOptions options;
    options.method = method.method;
    const StiffnessFit fit = identification::identify_stiffness(poses, options);
    const std::string name = method.name;
    figures.push_back(below(name + ".worst_percent", worst_stiffness_percent(fit), "%", method.percent));
    figures.push_back(below(name + ".coupling_percent", percent_off(fit.parameters[4].value, kTrueNumbers[4]), "%",
                            method.coupling_percent));
    figures.push_back(between(name + ".chi2_per_dof", fit.chi2_per_dof, "1", 0.9, 1.1));
    double best = 1e9;
    for (int i = 0; i < 3; ++i) {
      const double start = cpu_seconds();
      (void)identification::identify_stiffness(twice, options);
      best = std::min(best, 1e3 * (cpu_seconds() - start));
    }
    figures.push_back(below(name + ".1200_poses_ms", best, "ms", method.milliseconds));
  }
}

void measure_exact_poses(std::vector<Figure>& figures) {
  Rng rng = Rng(1).split("identification bench exact");
  StiffnessOptions options;
  options.method = StiffnessMethod::Wrench;
  const StiffnessFit fit = identification::identify_stiffness(
      identification::make_static_poses(cup::as_matrix(kTruth), identification::frames_of({}), 300, rng), options);
  double worst = 0.0;
  for (std::size_t i = 0; i < 5; ++i)
    worst = std::max(worst, std::abs(fit.parameters[i].value / kTrueNumbers[i] - 1.0));
  figures.push_back(below("wrench.noise_free_relative", worst, "1", 1e-6));
}

/// Percent of 200 sets whose 95 % interval holds the truth: all five parameters, and the one with the fewest.
void measure_coverage(std::vector<Figure>& figures) {
  constexpr int kSets = 200, kPoses = 120;
  Rng rng = Rng(2).split("identification bench coverage");
  const StaticPoses exact =
      identification::make_static_poses(cup::as_matrix(kTruth), identification::frames_of({}), kPoses, rng);
  for (const StiffnessMethod method : {StiffnessMethod::Compliance, StiffnessMethod::ErrorsInVariables}) {
    StiffnessOptions options;
    options.method = method;
    std::array<int, 5> covered{};
    for (int set = 0; set < kSets; ++set) {
      StaticPoses noisy = exact;
      identification::add_noise(noisy, {}, rng);
      const StiffnessFit fit = identification::identify_stiffness(noisy, options);
      for (std::size_t i = 0; i < 5; ++i)
        if (std::abs(fit.parameters[i].value - kTrueNumbers[i]) <= 1.96 * fit.parameters[i].standard_error)
          ++covered[i];
    }
    int sum = 0;
    for (const int count : covered) sum += count;
    const std::string name =
        method == StiffnessMethod::Compliance ? "compliance.coverage" : "errors_in_variables.coverage";
    figures.push_back(between(name + "_percent", 100.0 * sum / (5 * kSets), "%", 90.0, 98.0));
    const double least = 100.0 * *std::min_element(covered.begin(), covered.end()) / kSets;
    figures.push_back({"identification." + name + "_least_percent", least, "%", ">= 90", least >= 90.0});
  }
}

void measure_reference_decays(const std::filesystem::path& file, std::vector<Figure>& figures) {
  const std::vector<identification::Release> releases = identification::load_releases(file);
  // The five decays have dampings of their own: the default's times these (README of the data).
  constexpr std::array<double, 5> kTimes = {0.5, 1.5, 2.0, 1.0, 1.0};
  const model::CupElasticity usual = model::CupParams{}.damping;
  std::array<double, 4> worst{};
  for (std::size_t k = 0; k < releases.size() && k < kTimes.size(); ++k) {
    const identification::DampingFit fit = identification::identify_damping({releases[k]});
    const std::array<double, 4> truth = {usual.lateral, usual.axial, usual.bend, usual.torsion};
    for (std::size_t i = 0; i < 4; ++i)
      worst[i] = std::max(worst[i], percent_off(fit.parameters[i].value, kTimes[k] * truth[i]));
  }
  figures.push_back(below("damping.d_lat_percent", worst[0], "%", 12.0));
  figures.push_back({"identification.damping.d_ax_percent", worst[1], "%", "", true});  // weak from swings
  figures.push_back(below("damping.d_bend_percent", worst[2], "%", 3.0));
  figures.push_back(below("damping.d_tors_percent", worst[3], "%", 12.0));
}

void measure_plucks(std::vector<Figure>& figures) {
  using identification::PluckDirection;
  identification::Pluck pluck;
  pluck.load_S = {0.55, Vector3(0.005, 0.0, 0.08), Vector3(0.0021, 0.0022, 0.0038).asDiagonal()};
  pluck.frames = identification::frames_of({});
  pluck.K = cup::as_matrix(model::CupParams{}.stiffness);
  pluck.D = cup::as_matrix(model::CupParams{}.damping);
  Rng rng = Rng(3).split("identification bench plucks");
  const auto make = [&](PluckDirection direction, double amplitude) {
    pluck.direction = direction;
    pluck.amplitude = amplitude;
    identification::Release release = identification::make_pluck(pluck);
    identification::add_noise(release, {}, rng);
    return release;
  };
  std::vector<identification::Release> swings, plucks;
  for (int i = 0; i < 3; ++i) {
    swings.push_back(make(PluckDirection::Bend, 0.1));
    plucks.push_back(make(PluckDirection::Axial, 0.005));
  }
  const auto d_ax_error = [&](const std::vector<identification::Release>& releases) {
    const identification::Parameter d_ax = identification::identify_damping(releases).parameters[1];
    return 100.0 * d_ax.standard_error / d_ax.value;
  };
  figures.push_back({"identification.damping.d_ax_error_of_3_swings_percent", d_ax_error(swings), "%", "", true});
  figures.push_back(below("damping.d_ax_error_of_3_plucks_percent", d_ax_error(plucks), "%", 5.0));
  std::vector<identification::Release> ten;
  for (int i = 0; i < 10; ++i) ten.push_back(make(static_cast<PluckDirection>(i % 4), i % 4 < 2 ? 0.004 : 0.1));
  const double start = cpu_seconds();
  (void)identification::identify_damping(ten);
  figures.push_back(below("damping.10_records_s", cpu_seconds() - start, "s", 5.0));
}

/// Lifts of 1.5 s with the noise and the tare of the demonstrator's sensor.
void measure_payload(std::vector<Figure>& figures) {
  identification::Lift lift;
  lift.frames = identification::frames_of({});
  lift.K = cup::as_matrix(model::CupParams{}.stiffness);
  lift.D = cup::as_matrix(model::CupParams{}.damping);
  identification::PayloadSettings settings;
  settings.K = lift.K;
  settings.frames = lift.frames;
  Rng rng = Rng(4).split("identification bench payload");
  double mass_percent = 0.0, com_mm = 0.0, seconds = 0.0;
  int covered = 0, count = 0;
  for (const double mass : {0.26, 0.55, 1.05}) {
    for (const double aside : {0.0, 0.02}) {
      lift.load_S = {mass, Vector3(aside, -0.7 * aside, 0.06),
                     Matrix3(mass * Vector3(0.0038, 0.004, 0.0069).asDiagonal())};
      const std::vector<identification::PayloadSample> exact = identification::make_lift(lift);
      for (int i = 0; i < 10; ++i) {
        std::vector<identification::PayloadSample> samples = exact;
        identification::add_noise(samples, settings.noise, settings.force_bias, settings.torque_bias, rng);
        const double start = cpu_seconds();
        identification::PayloadEstimator estimator(settings);
        for (const identification::PayloadSample& sample : samples) estimator.add(sample);
        const identification::PayloadEstimate found = estimator.estimate();
        seconds += cpu_seconds() - start;
        const Vector3 error = found.load_S.com - lift.load_S.com, deviation = found.com_deviation();
        mass_percent = std::max(mass_percent, percent_off(found.load_S.mass, mass));
        com_mm = std::max(com_mm, 1e3 * error.norm());
        covered += std::abs(found.load_S.mass - mass) <= 1.96 * found.mass_deviation() ? 1 : 0;
        for (int axis = 0; axis < 3; ++axis) covered += std::abs(error[axis]) <= 1.96 * deviation[axis] ? 1 : 0;
        count += 4;
      }
    }
  }
  figures.push_back(below("payload.worst_mass_percent", mass_percent, "%", 2.0));
  figures.push_back(below("payload.worst_com_mm", com_mm, "mm", 5.0));
  const double percent = 100.0 * covered / count;
  figures.push_back({"identification.payload.coverage_percent", percent, "%", ">= 90", percent >= 90.0});
  figures.push_back({"identification.payload.us_per_sample", 1e6 * seconds / (60.0 * 751.0), "us", "", true});
}

}  // namespace

void measure_identification(const BenchOptions& options, std::vector<Figure>& figures) {
  const std::filesystem::path poses = options.cup_data / "identification.json",
                              decays = options.cup_data / "decay.json";
  const auto is_wanted = [&](const std::string& name) {
    return ("identification." + name).starts_with(options.only) || options.only.starts_with("identification." + name);
  };
  if (is_wanted("compliance") || is_wanted("errors_in_variables")) {
    if (std::filesystem::exists(poses))
      measure_reference_poses(poses, figures);
    else
      figures.push_back({"identification.reference_poses", 0.0, "%", "", true, "no " + poses.string()});
    measure_coverage(figures);
  }
  if (is_wanted("wrench")) measure_exact_poses(figures);
  if (is_wanted("damping")) {
    if (std::filesystem::exists(decays))
      measure_reference_decays(decays, figures);
    else
      figures.push_back({"identification.reference_decays", 0.0, "%", "", true, "no " + decays.string()});
    measure_plucks(figures);
  }
  if (is_wanted("payload")) measure_payload(figures);
  if (is_wanted("planted")) measure_planted(options, figures);
}

}  // namespace snug::bench::internal
