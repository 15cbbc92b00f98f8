// estimate_boxes: track those that are where they were, look for the others, then say what is known of each.
#include "snug/box_estimation/estimate.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "snug/box_estimation/internal/findings.hpp"
#include "snug/box_estimation/internal/joint_fit.hpp"
#include "snug/box_estimation/internal/obstacles.hpp"
#include "snug/box_estimation/internal/relocate.hpp"

namespace snug::box_estimation {
namespace {

using internal::Agreement;
using internal::ErrorModel;
using internal::FitStart;
using internal::Lost;
using internal::Place;
using internal::Prediction;
using internal::TrackedBox;

TrackedBox make_tracked(const ExpectedBox& box, const Pose& X_CW) {
  TrackedBox tracked;
  tracked.half = 0.5 * box.size;
  tracked.X_CP = tracked.X_CP_prior = X_CW * box.X_WP;
  tracked.prior_information.topLeftCorner<3, 3>() = Matrix3::Identity() / std::pow(box.position_spread, 2);
  tracked.prior_information.bottomRightCorner<3, 3>() = Matrix3::Identity() / std::pow(box.rotation_spread, 2);
  return tracked;
}

class Estimator {
 public:
  Estimator(const camera::Frame& frame, const EstimateInput& input, const EstimatorSettings& settings)
      : frame_(frame),
        input_(input),
        settings_(settings),
        s_(settings.tracking),
        X_CW_(frame.camera.X_WC.inverse()),
        errors_(frame.camera),
        surroundings_C_(internal::in_camera(input.surroundings, frame.camera.X_WC)),
        range_(
            internal::pixel_range(frame.camera, input.region_low, input.region_high + Vector3(0.0, 0.0, s_.over_rim))),
        tolerance_(std::max(s_.least_tolerance, 4.0 * errors_.point_error(frame.camera.range.focus))) {}

  Estimate run() {
    Estimate result;
    for (const ExpectedBox& box : input_.boxes) {
      BoxEstimate& estimate = result.boxes.emplace_back();
      estimate.id = box.id;
      estimate.X_WP = box.X_WP;
      estimate.covariance = belief(box);
    }
    result.fault = judge_frame(result.point_part);
    if (result.fault != FrameFault::None) return result;
    track();
    track_uncovered();
    search_lost();
    drop_bad_fits();
    report(result);
    return result;
  }

 private:
  static Matrix6 belief(const ExpectedBox& box) {
    Matrix6 covariance = Matrix6::Zero();
    covariance.topLeftCorner<3, 3>() = Matrix3::Identity() * std::pow(box.position_spread, 2);
    covariance.bottomRightCorner<3, 3>() = Matrix3::Identity() * std::pow(box.rotation_spread, 2);
    return covariance;
  }

  FrameFault judge_frame(double& part) const {
    const internal::PixelRange range = internal::pixel_range(frame_.camera, input_.region_low, input_.region_high);
    int points = 0, above = 0, high_above = 0;
    for (int r = range.first_row; r < range.end_row; ++r)
      for (int c = range.first_col; c < range.end_col; ++c) {
        const double depth = frame_.depth(r, c);
        if (depth == 0.0) continue;
        ++points;
        const Vector3 p_C = depth * camera::pixel_ray(frame_.camera.intrinsics, c, r);
        const double z = frame_.camera.X_WC.R.row(2).dot(p_C) + frame_.camera.X_WC.p.z();
        above += z > input_.region_high.z() ? 1 : 0;
        high_above += z > input_.region_high.z() + s_.over_rim ? 1 : 0;
      }
    const int pixels = range.rows() * range.cols();
    part = pixels > 0 ? static_cast<double>(points) / pixels : 0.0;
    if (part < s_.least_frame_part) return FrameFault::TooFewPoints;
    const bool is_blocked = above > s_.most_above * pixels || high_above > s_.most_high_above * pixels;
    return is_blocked ? FrameFault::ViewBlocked : FrameFault::None;
  }

  [[nodiscard]] Prediction predict(const std::vector<TrackedBox>& boxes) const {
    return internal::predict(frame_, range_, surroundings_C_, boxes);
  }

  /// How far a face may be from where the belief has it, m.
  [[nodiscard]] double belief_tolerance(const ExpectedBox& box) const {
    const double spread = std::hypot(box.position_spread, 0.5 * box.rotation_spread * box.size.norm());
    return std::min(s_.most_tolerance, 2.5 * spread) + tolerance_;
  }

  [[nodiscard]] std::vector<Agreement> compare(const std::vector<TrackedBox>& boxes) const {
    return internal::compare(frame_, predict(boxes), std::vector<double>(boxes.size(), fit_tolerance()));
  }

  [[nodiscard]] bool agrees(const Agreement& a, double least_part_on) const {
    return a.on >= s_.least_points && a.part_on() >= least_part_on && a.on >= s_.least_of_pixels * a.pixels;
  }

  /// Boxes that the frame shows about where they are believed to be.
  void track() {
    std::vector<TrackedBox> all;
    std::vector<double> tolerances;
    for (const ExpectedBox& box : input_.boxes) {
      all.push_back(make_tracked(box, X_CW_));
      tolerances.push_back(belief_tolerance(box));
    }
    const std::vector<Agreement> agreement = internal::compare(frame_, predict(all), tolerances);
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Agreement& a = agreement[i];
      was_in_view_.push_back(a.pixels >= s_.least_points);
      if (agrees(a, s_.least_part_on)) {
        tracked_.push_back(all[i]);
        ids_.push_back(i);
      } else {
        others_.push_back(i);
      }
    }
    fit(FitStart::Belief, 6);
    keep_good();
  }

  /// Boxes that are seen where they are believed to be, now that what should have covered them is not tracked.
  void track_uncovered() {
    std::vector<std::size_t> uncovered;
    for (const std::size_t i : others_)
      if (agrees(perceive_belief(i), s_.least_part_on)) uncovered.push_back(i);
    if (uncovered.empty()) return;
    for (const std::size_t i : uncovered) add(i, make_tracked(input_.boxes[i], X_CW_));
    fit(FitStart::Belief, 6);
    if (drop_seen_through()) fit(FitStart::Belief, 6);
    keep_good();
  }

  /// What they cover is not covered. Whether there was any.
  bool drop_seen_through() {
    std::vector<bool> is_solid;
    for (const Agreement& a : compare(tracked_))
      is_solid.push_back(a.on + a.farther < s_.least_points || a.part_on() >= s_.least_part_on_after);
    keep(is_solid);
    return tracked_.size() < is_solid.size();
  }

  /// Those that agree with the frame; returns the others.
  std::vector<std::size_t> keep_good() {
    const std::size_t before = others_.size();
    drop_seen_through();
    std::vector<bool> is_good;
    for (const Agreement& a : compare(tracked_)) is_good.push_back(agrees(a, s_.least_part_on_after));
    keep(is_good);
    return {others_.begin() + static_cast<std::ptrdiff_t>(before), others_.end()};
  }

  /// m, from a face after the fit.
  [[nodiscard]] double fit_tolerance() const {
    return std::max(s_.least_fit_tolerance, 4.0 * errors_.point_error(frame_.camera.range.focus));
  }

  [[nodiscard]] internal::FitContext context() const { return {frame_, range_, surroundings_C_, errors_, settings_}; }

  void fit(internal::FitStart start, int steps) {
    fit_ = internal::fit_boxes(context(), tracked_, start, steps);
    tracked_ = fit_.boxes;
  }

  /// Boxes that are not kept are looked for, or were never seen.
  void keep(const std::vector<bool>& is_good) {
    std::vector<TrackedBox> boxes;
    std::vector<std::size_t> ids;
    for (std::size_t i = 0; i < tracked_.size(); ++i) {
      if (is_good[i]) {
        boxes.push_back(tracked_[i]);
        ids.push_back(ids_[i]);
      } else {
        others_.push_back(ids_[i]);
      }
    }
    tracked_ = boxes;
    ids_ = ids;
    fit_ = internal::kept_of(fit_, is_good);
  }

  /// What is seen of the place where box i is believed to be, among the tracked ones.
  [[nodiscard]] Agreement perceive_belief(std::size_t i) const {
    std::vector<TrackedBox> boxes = tracked_;
    boxes.push_back(make_tracked(input_.boxes[i], X_CW_));
    std::vector<double> tolerances(tracked_.size(), fit_tolerance());
    tolerances.push_back(belief_tolerance(input_.boxes[i]));
    return internal::compare(frame_, predict(boxes), tolerances).back();
  }

  /// Boxes that are not where they were believed to be, and those that may be taken for others.
  void search_lost() {
    std::vector<std::optional<TrackedBox>> tracked(input_.boxes.size());  // those that are doubted
    doubt(tracked);
    for (int round = 0; round < s_.most_rounds && !others_.empty(); ++round) {
      std::sort(others_.begin(), others_.end());
      std::vector<Lost> lost;
      std::vector<std::size_t> boxes;  // of the input
      for (const std::size_t i : others_) {
        const Agreement a = perceive_belief(i);
        const double gone = part_gone(i, a);
        // What was covered is where it was, as long as its place is not seen to be empty.
        if (!was_in_view_[i] && gone < 0.5) continue;
        lost.push_back(
            {{0.5 * input_.boxes[i].size, X_CW_ * input_.boxes[i].X_WP}, gone, a.on >= s_.least_points, tracked[i]});
        boxes.push_back(i);
      }
      const internal::Known known{context(), input_, tracked_, fit_tolerance()};
      const std::vector<Place> found = internal::relocate(known, lost);
      if (found.empty()) break;
      doubt_overlapped(found, tracked);
      for (const Place& place : found) add(boxes[place.lost], place.box);
      fit(FitStart::Near, 4);
      for (const std::size_t i : keep_good()) tracked[i].reset();
    }
    if (!tracked_.empty()) fit(FitStart::Near, 3);
  }

  /// How surely a box is not where it was believed to be, 0 .. 1: its place is seen through, or a tracked box is in it.
  /// `a`: what is seen of its place.
  [[nodiscard]] double part_gone(std::size_t i, const Agreement& a) const {
    if (is_taken(i)) return 1.0;
    const double least = s_.part_that_tells * pixels_alone(make_tracked(input_.boxes[i], X_CW_));
    return a.farther / std::max({least, s_.least_points * 1.0, a.on + a.nearer + a.farther * 1.0});
  }

  /// Whether a tracked box is where box i was believed to be.
  [[nodiscard]] bool is_taken(std::size_t i) const {
    const TrackedBox box = make_tracked(input_.boxes[i], X_CW_);
    return std::any_of(tracked_.begin(), tracked_.end(), [&](const TrackedBox& other) {
      return internal::overlap(box, other) > s_.taken_overlap + 2.5 * input_.boxes[i].position_spread;
    });
  }

  /// Tracked boxes that may be others are lost again; where they were tracked is one of the places that they can have.
  void doubt(std::vector<std::optional<TrackedBox>>& tracked) {
    const std::vector<Agreement> agreement = compare(tracked_);
    std::vector<bool> is_sure;
    for (std::size_t i = 0; i < tracked_.size(); ++i) {
      const ExpectedBox& box = input_.boxes[ids_[i]];
      const Vector3& misfit = fit_.size_misfit[i];
      const Pose X_WP = frame_.camera.X_WC * tracked_[i].X_CP;
      const bool has_its_size =
          !(misfit.array().isFinite().select(misfit.array().abs(), 0.0).maxCoeff() > s_.doubtful_misfit);
      is_sure.push_back(agreement[i].part_on() >= s_.doubtful_part_on && has_its_size && !fit_.is_larger[i] &&
                        (X_WP.p - box.X_WP.p).norm() < s_.doubtful_deviations * box.position_spread);
      if (!is_sure.back()) tracked[ids_[i]] = tracked_[i];
    }
    keep(is_sure);
  }

  /// So are those that would be in a box that was found.
  void doubt_overlapped(const std::vector<Place>& found, std::vector<std::optional<TrackedBox>>& tracked) {
    std::vector<bool> is_free;
    for (std::size_t i = 0; i < tracked_.size(); ++i) {
      is_free.push_back(std::none_of(found.begin(), found.end(), [&](const Place& place) {
        return internal::overlap(tracked_[i], place.box) > s_.doubtful_overlap;
      }));
      if (!is_free.back()) tracked[ids_[i]] = tracked_[i];
    }
    keep(is_free);
  }

  void add(std::size_t box, const TrackedBox& tracked) {
    tracked_.push_back(tracked);
    ids_.push_back(box);
    std::erase(others_, box);
  }

  /// Until all that are left agree with the frame.
  void drop_bad_fits() {
    for (int round = 0; round < 3; ++round) {
      const std::size_t before = tracked_.size();
      keep_good();
      if (tracked_.size() == before) return;
      fit(FitStart::Near, 3);
    }
  }

  void report(Estimate& result) const {
    const Prediction prediction = predict(tracked_);
    const std::vector<Agreement> agreement =
        internal::compare(frame_, prediction, std::vector<double>(tracked_.size(), fit_tolerance()));
    for (std::size_t i = 0; i < tracked_.size(); ++i) report_seen(i, agreement[i], result.boxes[ids_[i]]);
    report_others(result);
    const auto mask = internal::unexplained(frame_, prediction, fit_tolerance() + settings_.obstacles.unexplained);
    result.obstacles = internal::find_obstacles(context(), input_, mask);
    for (Obstacle& obstacle : result.obstacles) obstacle.deviation = deviation_at(0.5 * (obstacle.low + obstacle.high));
    result.heights = internal::make_height_map(context(), input_);
  }

  /// m, standard deviation of a point in W with all that the camera states.
  [[nodiscard]] double deviation_at(const Vector3& p_W) const {
    const Vector3 p_C = X_CW_ * p_W;
    const double common = errors_.common_error(p_C).topRows<3>().rowwise().norm().maxCoeff();
    return std::hypot(errors_.point_error(p_C.z()), common);
  }

  void report_seen(std::size_t i, const Agreement& a, BoxEstimate& estimate) const {
    const ExpectedBox& box = input_.boxes[ids_[i]];
    const int alone = pixels_alone(tracked_[i]);
    estimate.points = a.on;
    estimate.visible_part = alone > 0 ? std::min(1.0, static_cast<double>(a.on) / alone) : 0.0;
    const double spread = std::sqrt(fit_.covariance[i].topLeftCorner<3, 3>().diagonal().maxCoeff());
    if (a.on < s_.least_points || estimate.visible_part < s_.least_visible ||
        spread > std::max(s_.most_spread, 1.1 * box.position_spread))
      return;  // stays hidden, at its belief
    estimate.sight = Sight::Seen;
    estimate.rms = a.on > 0 ? std::sqrt(a.squares / a.on) : 0.0;
    const Pose X_WP = frame_.camera.X_WC * tracked_[i].X_CP;
    estimate.X_WP = {nearest_equal_rotation(X_WP.R, box.X_WP.R), X_WP.p};
    Matrix6 turn = Matrix6::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = frame_.camera.X_WC.R;
    estimate.common = turn * errors_.common_error(tracked_[i].X_CP.p);
    estimate.covariance = turn * fit_.covariance[i] * turn.transpose() + estimate.common * estimate.common.transpose();
    estimate.findings =
        internal::findings_of(estimate, box, input_, {fit_.size_misfit[i], fit_.size_error[i]}, settings_.findings);
  }

  [[nodiscard]] int pixels_alone(const TrackedBox& box) const {
    const Prediction alone = internal::predict(frame_, range_, camera::Scene{}, {box});
    int pixels = 0;
    for (const std::int32_t s : alone.cast.surface.values()) pixels += s >= 0 ? 1 : 0;
    return pixels;
  }

  /// Of those that were not found: is the place where each should be seen, and empty?
  void report_others(Estimate& result) const {
    for (const std::size_t i : others_) {
      if (part_gone(i, perceive_belief(i)) > s_.least_gone) result.boxes[i].sight = Sight::Missing;
    }
  }

  const camera::Frame& frame_;
  const EstimateInput& input_;
  const EstimatorSettings& settings_;
  const TrackingSettings& s_;
  Pose X_CW_;
  ErrorModel errors_;
  camera::Scene surroundings_C_;
  internal::PixelRange range_;
  double tolerance_;
  std::vector<TrackedBox> tracked_;
  std::vector<std::size_t> ids_;     ///< of the input, for each tracked box
  std::vector<std::size_t> others_;  ///< not tracked
  std::vector<bool> was_in_view_;    ///< of each box of the input: should be seen, if all are as believed
  internal::FitResult fit_;
};

}  // namespace

EstimateInput make_input(const model::Scenario& scenario, const model::Container& container) {
  EstimateInput input;
  input.surroundings = camera::make_surroundings(scenario);
  const Vector3 half = 0.5 * (container.X_WT.R.cwiseAbs() * container.inner_size);
  const Vector3 middle = container.X_WT * Vector3(0.0, 0.0, 0.5 * container.inner_size.z());
  input.region_low = middle - half;
  input.region_high = middle + half;
  return input;
}

Estimate estimate_boxes(const camera::Frame& frame, const EstimateInput& input, const EstimatorSettings& settings) {
  return Estimator(frame, input, settings).run();
}

Matrix3 nearest_equal_rotation(const Matrix3& R_WP, const Matrix3& R_WP_near) {
  Matrix3 best = R_WP;
  double least = 1e9;
  for (const Vector3& signs : {Vector3(1, 1, 1), Vector3(1, -1, -1), Vector3(-1, 1, -1), Vector3(-1, -1, 1)}) {
    const Matrix3 R = R_WP * signs.asDiagonal();
    const double angle = angle_between(R, R_WP_near);
    if (angle >= least - 1e-12) continue;
    least = angle;
    best = R;
  }
  return best;
}

}  // namespace snug::box_estimation
