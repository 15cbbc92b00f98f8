// relocate: each proposed pose is fitted by itself; which boxes have which poses is chosen for all at once.
#include "snug/box_estimation/internal/relocate.hpp"

#include <algorithm>
#include <cmath>

#include "snug/box_estimation/internal/joint_fit.hpp"

namespace snug::box_estimation::internal {
namespace {

constexpr double kSpread = 0.012, kTurn = 0.05;  // m, rad: how far a box may be from where a pose was proposed
constexpr int kFitSteps = 4, kFitStepsFromBelief = 6;
constexpr int kMargin = 20;              // px, around a box that is fitted by itself
constexpr int kLeastPoints = 150;        // on it
constexpr double kLeastPartThere = 0.8;  // of the points that tell whether it is there
constexpr double kMostOverlap = 0.02;    // m, of boxes that are fitted one by one
constexpr int kMostTries = 100'000;      // combinations of places

constexpr double kSeenThrough = 1.0;  // px, more than for others, for each point behind the box
constexpr double kLeastGain = 300.0;  // px: less explains nothing
// What a pose that explains the frame says for and against the box, as the logarithm of a likelihood; one unit weighs
// as much as kEvidence pixels.
constexpr double kEvidence = 800.0;
constexpr double kApartError = 0.8e-3;   // m, standard deviation of how far apart opposite edges are seen
constexpr double kMostMisfit = 6.0;      // standard deviations: farther off is not less likely
constexpr double kUnseen = 1.0;          // a side of which not both ends are seen
constexpr double kInTheAir = -0.5;       // it touches nothing
constexpr double kOverlapError = 4e-3;   // m, standard deviation of how deep a box is in another
constexpr double kMostOverlapped = 2.0;  // standard deviations
constexpr double kNear = 0.3;            // at its old place, and turned as it was
constexpr double kCovered = 1.5;         // its old place is not seen to be empty
constexpr double kElsewhere = 0.03;      // m, from its old place
constexpr double kInPlace = 1.0;         // fitted from its old place, or where it was tracked

Matrix6 proposal_information() {
  Matrix6 information = Matrix6::Zero();
  information.topLeftCorner<3, 3>() = Matrix3::Identity() / (kSpread * kSpread);
  information.bottomRightCorner<3, 3>() = Matrix3::Identity() / (kTurn * kTurn);
  return information;
}

/// Of the two sides of the face that looks most toward the camera: do they have the length that they should?
double size_evidence(const TrackedBox& box, const Vector3& size_misfit) {
  int depth_axis = 0;
  (box.X_CP.R.transpose() * box.X_CP.p.normalized()).cwiseAbs().maxCoeff(&depth_axis);
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (k == depth_axis) continue;
    const double misfit = std::abs(size_misfit(k)) / kApartError;
    sum -= std::isfinite(misfit) ? 0.5 * std::pow(std::min(misfit, kMostMisfit), 2) : kUnseen;
  }
  return sum;
}

/// Boxes stand on something, in nothing. What they are in may itself be a little elsewhere.
double place_evidence(double gap) {
  if (gap >= kTouch) return kInTheAir;
  return -0.5 * std::pow(std::min(std::max(0.0, -gap) / kOverlapError, kMostOverlapped), 2);
}

class Trials {
 public:
  Trials(const Known& known, const Prediction& without)
      : known_(known), without_(without), solids_C_(known.surroundings_C.shapes) {
    for (const TrackedBox& box : known.boxes) solids_C_.push_back({geometry::Box{box.half}, box.X_CP, 0});
  }
  [[nodiscard]] const std::vector<camera::SceneShape>& solids_C() const { return solids_C_; }

  /// The box fitted from where it stands on, and what speaks for it; none when the frame does not show it there.
  [[nodiscard]] std::optional<Place> fit(std::size_t index, const Lost& lost, const TrackedBox& from, FitStart start,
                                         double evidence) const {
    std::vector<TrackedBox> boxes = known_.boxes;
    boxes.push_back(from);
    const PixelRange range = pixels_around(known_.frame, known_.range, boxes.back(), kMargin);
    const int held = static_cast<int>(known_.boxes.size());
    const FitResult fitted = fit_boxes(known_.frame, range, known_.surroundings_C, std::move(boxes), known_.errors,
                                       start, start == FitStart::Near ? kFitSteps : kFitStepsFromBelief, held);
    const TrackedBox& box = fitted.boxes.back();
    const Prediction with = predict(known_.frame, range, known_.surroundings_C, fitted.boxes);
    const Agreement agreement =
        compare(known_.frame, with, std::vector<double>(fitted.boxes.size(), known_.tolerance)).back();
    if (agreement.on < kLeastPoints || agreement.part_on() < kLeastPartThere) return std::nullopt;
    Place place{index, box, 0.0};
    evidence += place_evidence(least_gap(box.half, box.X_CP, solids_C_)) +
                size_evidence(box, fitted.size_misfit.back()) + nearness(lost, box.X_CP);
    place.gain = -kSeenThrough * agreement.farther + disagreeing(known_.frame, without_, range, known_.tolerance) -
                 disagreeing(known_.frame, with, range, known_.tolerance) + kEvidence * evidence;
    return place;
  }

 private:
  static double nearness(const Lost& lost, const Pose& X_CP) {
    const Pose& before = lost.box.X_CP_prior;
    const double angle = angle_between(nearest_equal_rotation(X_CP.R, before.R), before.R);
    return kNear * (std::exp(-(X_CP.p - before.p).norm() / 0.1) + std::exp(-angle / 0.5));
  }

  const Known& known_;
  const Prediction& without_;
  std::vector<camera::SceneShape> solids_C_;
};

bool exclude_each_other(const Place& a, const Place& b) {
  return a.lost == b.lost || overlap(a.box, b.box) > kMostOverlap;
}

/// Depth first over the boxes; a branch ends where even the best places of the boxes left would not make it the best.
class Choice {
 public:
  Choice(const std::vector<Place>& places, std::size_t lost)
      : places_(places),
        of_box_(lost),
        left_(lost + 1, 0.0),
        excludes_(places.size(), std::vector<bool>(places.size())) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i].gain > 0.0) of_box_[places[i].lost].push_back(i);
      for (std::size_t k = 0; k < i; ++k) excludes_[i][k] = excludes_[k][i] = exclude_each_other(places[i], places[k]);
    }
    for (auto& own : of_box_)
      std::stable_sort(own.begin(), own.end(),
                       [&](std::size_t a, std::size_t b) { return places[a].gain > places[b].gain; });
    for (std::size_t box = lost; box-- > 0;)
      left_[box] = left_[box + 1] + (of_box_[box].empty() ? 0.0 : places[of_box_[box].front()].gain);
  }

  std::vector<std::size_t> run() {
    visit(0, 0.0);
    return best_;
  }

 private:
  void visit(std::size_t box, double sum) {
    if (sum > most_) {
      most_ = sum;
      best_ = chosen_;
    }
    if (box == of_box_.size() || sum + left_[box] <= most_ || ++tries_ > kMostTries) return;
    for (const std::size_t i : of_box_[box]) {
      if (std::any_of(chosen_.begin(), chosen_.end(), [&](std::size_t k) { return excludes_[i][k]; })) continue;
      chosen_.push_back(i);
      visit(box + 1, sum + places_[i].gain);
      chosen_.pop_back();
    }
    visit(box + 1, sum);
  }

  const std::vector<Place>& places_;
  std::vector<std::vector<std::size_t>> of_box_;
  std::vector<double> left_;  // the most that boxes from this one on can add
  std::vector<std::vector<bool>> excludes_;
  std::vector<std::size_t> chosen_, best_;
  double most_ = 0.0;
  int tries_ = 0;
};

}  // namespace

std::vector<Place> best_together(const std::vector<Place>& places, std::size_t lost) {
  std::vector<Place> best;
  for (const std::size_t i : Choice(places, lost).run()) best.push_back(places[i]);
  return best;
}

std::vector<Place> relocate(const Known& known, const std::vector<Lost>& lost) {
  const Prediction without = predict(known.frame, known.range, known.surroundings_C, known.boxes);
  const Trials trials(known, without);
  std::vector<Wanted> wanted;
  for (const Lost& one : lost) wanted.push_back(one.box);
  const auto poses = propose_poses(known, without, wanted, trials.solids_C());
  std::vector<Place> places;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (lost[i].tracked) {
      const TrackedBox& tracked = *lost[i].tracked;
      const auto place = trials.fit(i, lost[i], tracked, FitStart::Near, kInPlace);
      // As long as nothing says more it stays, unless it is not seen there and another box is.
      if (place && place->gain > 1.0)
        places.push_back(*place);
      else if (place || least_gap(tracked.half, tracked.X_CP, trials.solids_C()) > -kMostOverlap)
        places.push_back({i, tracked, 1.0});
    }
    const auto add = [&](const Pose& X_CP, FitStart start, double evidence) {
      const TrackedBox box{lost[i].box.half, X_CP, X_CP, proposal_information()};
      auto place = trials.fit(i, lost[i], box, start, evidence);
      if (!place || !(place->gain > kLeastGain)) return;
      place->box.X_CP_prior = place->box.X_CP;
      places.push_back(*place);
    };
    if (!lost[i].tracked && lost[i].is_seen_in_place) add(lost[i].box.X_CP_prior, FitStart::Belief, kInPlace);
    for (const Pose& X_CP : poses[i]) {
      const bool is_elsewhere = (X_CP.p - lost[i].box.X_CP_prior.p).norm() > kElsewhere;
      add(X_CP, FitStart::Near, is_elsewhere ? -kCovered * (1.0 - lost[i].gone) : 0.0);
    }
  }
  return best_together(places, lost.size());
}

}  // namespace snug::box_estimation::internal
