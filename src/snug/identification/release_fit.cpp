// identify_release: least squares over the logarithms of the numbers of cup.release, errors by leaving masses out.
#include "snug/identification/release_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/identification/internal/release_drop.hpp"
#include "snug/model/scenario.hpp"
#include "snug/numerics/least_squares.hpp"

namespace snug::identification {
namespace {

using internal::Drop;
using model::CupParams;

// Errors and starts were chosen on the 76 recordings of docs/decisions/0067, 0068 and 0118; the latter two have
// what priors of other widths did.
constexpr double kReleaseHeightError = 1e-3;    // m, of a sample of a recording's 50, which stray together
constexpr double kReleaseLengthError = 0.3e-3;  // m, of a cup's length at rest
constexpr double kReleaseOpeningError = 3e-3;   // s: the source smooths over 36 ms
constexpr double kReleasePriorWidth = 0.7;      // of a logarithm: a factor of two is one standard deviation
constexpr double kReleaseStep = 1e-3;           // of a logarithm, for differences to both sides
constexpr std::size_t kFewestReleaseMasses = 3;
constexpr int kReleaseStarts = 4;
constexpr double kFarStart = 0.5, kNearStart = 0.25;  // of a logarithm, how far starts are scattered
constexpr Eigen::Index kGrowthPlace = 0;              // among the release_numbers
constexpr double kUsualGrowth = 0.030;                // m, where its search starts: found there (0067: 29.6 mm)
constexpr double kSameTime = 1e-6;                    // s
constexpr double kKnown = 0.2;                        // of a number: a larger standard error says it is not known

struct ReleaseNumber {
  const char* name;
  const char* unit;
  double model::ReleaseParams::*of;
  const char* advice;
};

const std::vector<ReleaseNumber>& release_numbers() {
  using R = model::ReleaseParams;
  static const std::vector<ReleaseNumber> all = {
      {"growth", "m", &R::growth, "the lip's height"},
      {"shut_stiffness", "N/m", &R::shut_stiffness, "lighter and heavier boxes at rest"},
      {"open_stiffness", "N/m", &R::open_stiffness, "light boxes, and heavy ones between those recorded"},
      {"damping", "Ns/m", &R::damping, "boxes from light to heavy, which leave at different speeds"},
      {"pressure_gauge_start", "Pa", &R::pressure_gauge_start, "the pressure in the cup"},
      {"volume", "m^3", &R::volume, "the pressure in the cup"},
      {"valve_delay", "s", &R::valve_delay, "the first 40 ms at 300 Hz or more"},
      {"valve_time", "s", &R::valve_time, "the first 40 ms at 300 Hz or more"},
      {"blow_flow", "m^3/s", &R::blow_flow, "the pressure in the cup"},
      {"peel_impulse", "Ns", &R::peel_impulse, "the lip's height, so that the time of opening is seen"}};
  return all;
}

/// Recordings of one mass as one: their mean, where they were sampled at the same times.
struct MeanRelease {
  RecordedRelease mean;
  double count = 0.0, opening = -1.0, openings = 0.0;  // recordings; s, and of how many
  double box_length = 0.0, growth = 0.0;               // m, at rest: E to box; free cup less the one at rest
  double growths = 0.0;
};

struct ReleaseSetup {
  std::vector<MeanRelease> releases;
  model::CupParams start;
};

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

bool is_sampled_alike(const RecordedRelease& a, const RecordedRelease& b) {
  if (a.mass != b.mass || a.times.size() != b.times.size()) return false;
  for (std::size_t i = 0; i < a.times.size(); ++i)
    if (std::abs(a.times[i] - b.times[i]) > kSameTime) return false;
  return true;
}

void add_release(const RecordedRelease& release, MeanRelease& to) {
  const double share = 1.0 / ++to.count;
  for (std::size_t i = 0; i < release.times.size(); ++i) {
    to.mean.box[i] += share * (release.box[i] - release.box[0] - to.mean.box[i]);
    to.mean.gripper[i] += share * (release.gripper[i] - release.gripper[0] - to.mean.gripper[i]);
  }
  to.box_length += share * (release.gripper[0] - release.box[0] - to.box_length);
  const double opening = find_recorded_opening(release);
  if (opening < 0.0) return;
  to.opening = to.openings > 0.0 ? to.opening + (opening - to.opening) / (to.openings + 1.0) : opening;
  to.openings += 1.0;
}

/// How much longer the free cup is at the end than the one at rest; the median, as a tracker loses the lip now and
/// then.
void find_growth(const std::vector<RecordedRelease>& releases, MeanRelease& of) {
  std::vector<double> growths;
  for (const RecordedRelease& release : releases)
    if (is_sampled_alike(release, of.mean) && find_recorded_opening(release) >= 0.0)
      growths.push_back((release.gripper.back() - release.lip.back()) - (release.gripper[0] - release.lip[0]));
  if (growths.empty()) return;
  of.growth = median_of(growths);
  of.growths = static_cast<double>(growths.size());
}

ReleaseSetup make_release_setup(const std::vector<RecordedRelease>& releases, const CupParams& start) {
  ReleaseSetup setup{{}, start};
  setup.start.release = model::ReleaseParams{};
  setup.start.release.growth = kUsualGrowth;
  for (const RecordedRelease& release : releases) {
    const auto same = std::ranges::find_if(setup.releases,
                                           [&](const MeanRelease& one) { return is_sampled_alike(one.mean, release); });
    if (same != setup.releases.end()) {
      add_release(release, *same);
      continue;
    }
    setup.releases.emplace_back();
    MeanRelease& first = setup.releases.back();
    first.mean = release;
    std::ranges::fill(first.mean.box, 0.0);
    std::ranges::fill(first.mean.gripper, 0.0);
    add_release(release, first);
    find_growth(releases, first);
  }
  return setup;
}

CupParams released_cup(const ReleaseSetup& setup, const Eigen::VectorXd& x) {
  CupParams cup = setup.start;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    cup.release.*release_numbers()[static_cast<std::size_t>(i)].of *= std::exp(x[i]);
  return cup;
}

/// Heights of all samples, then lengths at rest and openings, each weighted by its recordings, then the growth.
Eigen::VectorXd release_residuals(const ReleaseSetup& setup, const CupParams& cup) {
  std::vector<double> all, stretch, weights, growths;
  double recordings = 0.0;
  std::vector<Drop> drops;
  for (const MeanRelease& one : setup.releases) {
    drops.push_back(internal::simulate_drop(cup, one.mean));
    const double weight = std::sqrt(one.count);
    for (std::size_t i = 1; i < one.mean.times.size(); ++i)
      all.push_back(weight * (drops.back().height[i] - one.mean.box[i]) / kReleaseHeightError);
    // Where the box's marker sits below the lip is not known, but is the same for all.
    stretch.push_back(one.box_length - drops.back().length);
    weights.push_back(weight);
  }
  const double below = median_of(stretch);
  for (std::size_t k = 0; k < setup.releases.size(); ++k) {
    const MeanRelease& one = setup.releases[k];
    all.push_back(weights[k] * (stretch[k] - below) / kReleaseLengthError);
    const double opens = drops[k].opening < 0.0 ? one.mean.times.back() : drops[k].opening;
    all.push_back(one.openings > 0.0 ? std::sqrt(one.openings) * (opens - one.opening) / kReleaseOpeningError : 0.0);
    if (one.growths > 0.0) growths.push_back(cup.hold_length + cup.release.growth - drops[k].length - one.growth);
    recordings += one.growths;
  }
  // The median: a tracker may lose the lips of one box.
  all.push_back(growths.empty() ? 0.0 : std::sqrt(recordings) * median_of(growths) / kReleaseLengthError);
  return Eigen::Map<const Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

numerics::LeastSquaresResult search_release_from(const ReleaseSetup& setup, const Eigen::VectorXd& from) {
  const Eigen::VectorXd at_start = release_residuals(setup, released_cup(setup, from));
  numerics::LeastSquaresTerm term;
  term.residuals = at_start.size();
  term.evaluate = [&setup](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    r = release_residuals(setup, released_cup(setup, x));
    if (J == nullptr) return;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      Eigen::VectorXd up = x, down = x;
      up[i] += kReleaseStep, down[i] -= kReleaseStep;
      J->col(i) =
          (release_residuals(setup, released_cup(setup, up)) - release_residuals(setup, released_cup(setup, down))) /
          (2.0 * kReleaseStep);
    }
  };
  numerics::LeastSquaresTerm prior;
  prior.residuals = from.size();
  prior.evaluate = [](const Eigen::VectorXd& x, const Eigen::VectorXd&, Eigen::VectorXd& r, Eigen::MatrixXd* J) {
    r = x / kReleasePriorWidth;
    if (J != nullptr) *J = Eigen::MatrixXd::Identity(x.size(), x.size()) / kReleasePriorWidth;
  };
  return numerics::solve_least_squares({term, prior}, from, {.tolerance = 1e-6, .max_iterations = 60});
}

/// The best of searches from `from` and from points scattered about it: valley after valley where folds open and lips
/// let go a sample earlier or later.
numerics::LeastSquaresResult search_release(const ReleaseSetup& setup, const Eigen::VectorXd& from, int starts,
                                            double scatter) {
  numerics::LeastSquaresResult best = search_release_from(setup, from);
  Rng rng = Rng(1).split("release fit");
  for (int k = 1; k < starts; ++k) {
    Eigen::VectorXd start = from;
    for (Eigen::Index i = 0; i < start.size(); ++i)
      if (i != kGrowthPlace) start[i] += rng.uniform(-scatter, scatter);  // a length is measured
    const numerics::LeastSquaresResult found = search_release_from(setup, start);
    if (found.cost < best.cost) best = found;
  }
  return best;
}

std::vector<double> release_masses_of(const std::vector<RecordedRelease>& releases) {
  std::set<double> masses;
  for (const RecordedRelease& release : releases) masses.insert(release.mass);
  return {masses.begin(), masses.end()};
}

/// Recordings of one mass, or of all others.
std::vector<RecordedRelease> select_mass(const std::vector<RecordedRelease>& releases, double mass, bool of_it) {
  std::vector<RecordedRelease> selected;
  for (const RecordedRelease& release : releases)
    if ((release.mass == mass) == of_it) selected.push_back(release);
  return selected;
}

double release_scatter(const std::vector<RecordedRelease>& releases) {
  const std::size_t samples =
      std::ranges::min(releases, {}, [](const RecordedRelease& one) { return one.times.size(); }).times.size();
  const double n = static_cast<double>(releases.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    double mean = 0.0;
    for (const RecordedRelease& release : releases) mean += (release.box[i] - release.box[0]) / n;
    for (const RecordedRelease& release : releases)
      squares += std::pow(release.box[i] - release.box[0] - mean, 2) / n / static_cast<double>(samples);
  }
  return std::sqrt(squares);
}

ReleaseMassError evaluate_release_mass(const std::vector<RecordedRelease>& releases, const CupParams& cup) {
  ReleaseMassError error{.mass = releases.front().mass, .recordings = static_cast<int>(releases.size())};
  error.scatter = release_scatter(releases);
  double squares = 0.0, samples = 0.0, seen = 0.0, recorded = 0.0;
  for (const RecordedRelease& release : releases) {
    const Drop drop = internal::simulate_drop(cup, release);
    for (std::size_t i = 0; i < release.times.size(); ++i)
      squares += std::pow(drop.height[i] - (release.box[i] - release.box[0]), 2), samples += 1.0;
    const double opening = find_recorded_opening(release);
    error.opening += (drop.opening < 0.0 ? release.times.back() : drop.opening) / static_cast<double>(releases.size());
    if (opening >= 0.0) recorded += opening, seen += 1.0;
  }
  error.rms = std::sqrt(squares / samples);
  if (seen > 0.0) error.recorded_opening = recorded / seen;
  return error;
}

ReleaseErrors summarize_masses(std::vector<ReleaseMassError> masses) {
  ReleaseErrors errors;
  double count = 0.0, opening = 0.0, seen = 0.0;
  for (const ReleaseMassError& mass : masses) {
    errors.rms += mass.rms * mass.rms * mass.recordings;
    count += mass.recordings;
    if (mass.recorded_opening < 0.0) continue;
    opening += std::pow(mass.opening - mass.recorded_opening, 2);
    seen += 1.0;
  }
  errors.rms = std::sqrt(errors.rms / count);
  if (seen > 0.0) errors.opening_error = std::sqrt(opening / seen);
  errors.masses = std::move(masses);
  return errors;
}

}  // namespace

ReleaseErrors evaluate_release(const std::vector<RecordedRelease>& releases, const CupParams& cup) {
  std::vector<ReleaseMassError> masses;
  for (const double mass : release_masses_of(releases))
    masses.push_back(evaluate_release_mass(select_mass(releases, mass, true), cup));
  return summarize_masses(std::move(masses));
}

CupReleaseFit identify_release(const std::vector<RecordedRelease>& releases, const CupParams& start) {
  const std::vector<double> masses = release_masses_of(releases);
  if (masses.size() < kFewestReleaseMasses)
    throw InputError(
        releases.empty() ? "" : releases.front().where, "mass_kg", std::to_string(masses.size()) + " different masses",
        std::to_string(kFewestReleaseMasses) + " or more: one mass hardly distinguishes springs from flows");
  const ReleaseSetup setup = make_release_setup(releases, start);
  const auto size = static_cast<Eigen::Index>(release_numbers().size());
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(size);
  const numerics::LeastSquaresResult found = search_release(setup, zero, kReleaseStarts, kFarStart);
  CupReleaseFit fit;
  fit.cup = released_cup(setup, found.x);
  fit.errors = evaluate_release(releases, fit.cup);
  std::vector<ReleaseMassError> held_back;
  Eigen::MatrixXd without(size, static_cast<Eigen::Index>(masses.size()));
  for (std::size_t k = 0; k < masses.size(); ++k) {
    const ReleaseSetup part = make_release_setup(select_mass(releases, masses[k], false), start);
    // From the fit of all masses, and from where it began: the better one of what the other masses say.
    numerics::LeastSquaresResult best = search_release(part, found.x, kReleaseStarts - 1, kNearStart);
    const numerics::LeastSquaresResult other = search_release(part, zero, kReleaseStarts - 2, kNearStart);
    if (other.cost < best.cost) best = other;
    const CupParams cup = released_cup(part, best.x);
    for (Eigen::Index i = 0; i < size; ++i)
      without(i, static_cast<Eigen::Index>(k)) = cup.release.*release_numbers()[static_cast<std::size_t>(i)].of;
    held_back.push_back(evaluate_release_mass(select_mass(releases, masses[k], true), cup));
  }
  fit.held_back = summarize_masses(std::move(held_back));
  const double n = static_cast<double>(masses.size());
  for (Eigen::Index i = 0; i < size; ++i) {
    const ReleaseNumber& number = release_numbers()[static_cast<std::size_t>(i)];
    const double value = fit.cup.release.*number.of;
    const double error = std::sqrt((n - 1.0) / n * (without.row(i).array() - without.row(i).mean()).square().sum());
    Verdict verdict = judge(error, std::abs(value));
    if (error > kKnown * std::abs(value)) verdict = Verdict::NotIdentifiable;
    fit.parameters.push_back(
        {number.name, value, error, number.unit, verdict, verdict == Verdict::Identified ? "" : number.advice});
  }
  return fit;
}

std::string format_release_block(const CupReleaseFit& fit, const std::string& note) {
  std::string text = "# " + note + "\ncup:\n  release:\n";
  for (const Parameter& parameter : fit.parameters)
    text += fmt::format("    {}: {:.4g}  # +- {:.2g} {}, {}\n", parameter.name, parameter.value,
                        parameter.standard_error, parameter.unit, name_of(parameter.verdict));
  (void)model::parse_scenario("materials: [{name: any}]\n" + text, "identified release");
  return text;
}

}  // namespace snug::identification
