// relocate: each proposed pose is fitted by itself; which boxes have which poses is chosen for all at once.
#include "snug/box_estimation/internal/relocate.hpp"

#include <algorithm>
#include <cmath>

#include "snug/box_estimation/internal/joint_fit.hpp"

namespace snug::box_estimation::internal {
namespace {

Matrix6 proposal_information(const RelocationSettings& settings) {
  Matrix6 information = Matrix6::Zero();
  information.topLeftCorner<3, 3>() = Matrix3::Identity() / (settings.spread * settings.spread);
  information.bottomRightCorner<3, 3>() = Matrix3::Identity() / (settings.turn * settings.turn);
  return information;
}

/// Of the two sides of the face that looks most toward the camera: do they have the length that they should?
double size_evidence(const TrackedBox& box, const Vector3& size_misfit, const RelocationSettings& settings) {
  int depth_axis = 0;
  (box.X_CP.R.transpose() * box.X_CP.p.normalized()).cwiseAbs().maxCoeff(&depth_axis);
  double sum = 0.0;
  for (int k = 0; k < 3; ++k) {
    if (k == depth_axis) continue;
    const double misfit = std::abs(size_misfit(k)) / settings.apart_error;
    sum -= std::isfinite(misfit) ? 0.5 * std::pow(std::min(misfit, settings.most_misfit), 2) : settings.unseen;
  }
  return sum;
}

/// Boxes stand on something, in nothing. What they are in may itself be a little elsewhere.
double place_evidence(double gap, const EstimatorSettings& all) {
  const RelocationSettings& settings = all.relocation;
  if (gap >= all.search.touch) return settings.in_the_air;
  return -0.5 * std::pow(std::min(std::max(0.0, -gap) / settings.overlap_error, settings.most_overlapped), 2);
}

class Trials {
 public:
  Trials(const Known& known, const Prediction& without)
      : known_(known),
        settings_(known.context.settings),
        s_(known.context.settings.relocation),
        without_(without),
        solids_C_(known.context.surroundings_C.shapes) {
    for (const TrackedBox& box : known.boxes) solids_C_.push_back({geometry::Box{box.half}, box.X_CP, 0});
  }
  /// m, as least_gap() of internal/search.hpp, to everything that is known.
  [[nodiscard]] double gap_of(const TrackedBox& box) const {
    return least_gap(box.half, box.X_CP, solids_C_, settings_.search.touch);
  }
  [[nodiscard]] const std::vector<camera::SceneShape>& solids_C() const { return solids_C_; }

  /// The box fitted from where it stands on, and what speaks for it; none when the frame does not show it there.
  [[nodiscard]] std::optional<Place> fit(std::size_t index, const Lost& lost, const TrackedBox& from, FitStart start,
                                         double evidence) const {
    std::vector<TrackedBox> boxes = known_.boxes;
    boxes.push_back(from);
    const camera::Frame& frame = known_.context.frame;
    const PixelRange range = pixels_around(frame, known_.context.range, boxes.back(), s_.margin);
    const FitContext context{frame, range, known_.context.surroundings_C, known_.context.errors, settings_};
    const int held = static_cast<int>(known_.boxes.size());
    const FitResult fitted = fit_boxes(context, std::move(boxes), start,
                                       start == FitStart::Near ? s_.fit_steps : s_.fit_steps_from_belief, held);
    const TrackedBox& box = fitted.boxes.back();
    const Prediction with = predict(frame, range, context.surroundings_C, fitted.boxes);
    const Agreement agreement = compare(frame, with, std::vector<double>(fitted.boxes.size(), known_.tolerance)).back();
    if (agreement.on < s_.least_points || agreement.part_on() < s_.least_part_there) return std::nullopt;
    Place place{index, box, 0.0};
    evidence += place_evidence(gap_of(box), settings_) + size_evidence(box, fitted.size_misfit.back(), s_) +
                nearness(lost, box.X_CP);
    place.gain = -s_.seen_through * agreement.farther + disagreeing(frame, without_, range, known_.tolerance) -
                 disagreeing(frame, with, range, known_.tolerance) + s_.evidence * evidence;
    return place;
  }

 private:
  [[nodiscard]] double nearness(const Lost& lost, const Pose& X_CP) const {
    const Pose& before = lost.box.X_CP_prior;
    const double angle = angle_between(nearest_equal_rotation(X_CP.R, before.R), before.R);
    return s_.near * (std::exp(-(X_CP.p - before.p).norm() / 0.1) + std::exp(-angle / 0.5));
  }

  const Known& known_;
  const EstimatorSettings& settings_;
  const RelocationSettings& s_;
  const Prediction& without_;
  std::vector<camera::SceneShape> solids_C_;
};

bool exclude_each_other(const Place& a, const Place& b, const RelocationSettings& settings) {
  return a.lost == b.lost || overlap(a.box, b.box) > settings.most_overlap;
}

/// Depth first over the boxes; a branch ends where even the best places of the boxes left would not make it the best.
class Choice {
 public:
  Choice(const std::vector<Place>& places, std::size_t lost, const RelocationSettings& settings)
      : places_(places),
        most_tries_(settings.most_tries),
        of_box_(lost),
        left_(lost + 1, 0.0),
        excludes_(places.size(), std::vector<bool>(places.size())) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (places[i].gain > 0.0) of_box_[places[i].lost].push_back(i);
      for (std::size_t k = 0; k < i; ++k)
        excludes_[i][k] = excludes_[k][i] = exclude_each_other(places[i], places[k], settings);
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
    if (box == of_box_.size() || sum + left_[box] <= most_ || ++tries_ > most_tries_) return;
    for (const std::size_t i : of_box_[box]) {
      if (std::any_of(chosen_.begin(), chosen_.end(), [&](std::size_t k) { return excludes_[i][k]; })) continue;
      chosen_.push_back(i);
      visit(box + 1, sum + places_[i].gain);
      chosen_.pop_back();
    }
    visit(box + 1, sum);
  }

  const std::vector<Place>& places_;
  int most_tries_;
  std::vector<std::vector<std::size_t>> of_box_;
  std::vector<double> left_;  // the most that boxes from this one on can add
  std::vector<std::vector<bool>> excludes_;
  std::vector<std::size_t> chosen_, best_;
  double most_ = 0.0;
  int tries_ = 0;
};

}  // namespace

std::vector<Place> best_together(const std::vector<Place>& places, std::size_t lost,
                                 const RelocationSettings& settings) {
  std::vector<Place> best;
  for (const std::size_t i : Choice(places, lost, settings).run()) best.push_back(places[i]);
  return best;
}

std::vector<Place> relocate(const Known& known, const std::vector<Lost>& lost) {
  const FitContext& context = known.context;
  const RelocationSettings& settings = context.settings.relocation;
  const Prediction without = predict(context.frame, context.range, context.surroundings_C, known.boxes);
  const Trials trials(known, without);
  std::vector<Wanted> wanted;
  for (const Lost& one : lost) wanted.push_back(one.box);
  const auto poses = propose_poses(known, without, wanted, trials.solids_C());
  std::vector<Place> places;
  for (std::size_t i = 0; i < lost.size(); ++i) {
    if (lost[i].tracked) {
      const TrackedBox& tracked = *lost[i].tracked;
      const auto place = trials.fit(i, lost[i], tracked, FitStart::Near, settings.in_place);
      // As long as nothing says more it stays, unless it is not seen there and another box is.
      if (place && place->gain > 1.0)
        places.push_back(*place);
      else if (place || trials.gap_of(tracked) > -settings.most_overlap)
        places.push_back({i, tracked, 1.0});
    }
    const auto add = [&](const Pose& X_CP, FitStart start, double evidence) {
      const TrackedBox box{lost[i].box.half, X_CP, X_CP, proposal_information(settings)};
      auto place = trials.fit(i, lost[i], box, start, evidence);
      if (!place || !(place->gain > settings.least_gain)) return;
      place->box.X_CP_prior = place->box.X_CP;
      places.push_back(*place);
    };
    if (!lost[i].tracked && lost[i].is_seen_in_place) add(lost[i].box.X_CP_prior, FitStart::Belief, settings.in_place);
    for (const Pose& X_CP : poses[i]) {
      const bool is_elsewhere = (X_CP.p - lost[i].box.X_CP_prior.p).norm() > settings.elsewhere;
      add(X_CP, FitStart::Near, is_elsewhere ? -settings.covered * (1.0 - lost[i].gone) : 0.0);
    }
  }
  return best_together(places, lost.size(), settings);
}

}  // namespace snug::box_estimation::internal
