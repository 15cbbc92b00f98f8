// Film: stretch film around a load, as hoops under tension that carry shear between each other.
#include "snug/runs/internal/film.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/spatial/plane_hull.hpp"

namespace snug::runs::internal {
namespace {

constexpr double kBand = 0.1;    ///< m, height of a band
constexpr double kTouch = 0.03;  ///< m: a box that near to the hoop is one that the film lies on

/// m, in plan view.
double distance_to(const Vector3& a, const Vector3& b, const Vector3& p) {
  const Eigen::Vector2d along = (b - a).head<2>(), to = (p - a).head<2>();
  const double part = std::clamp(to.dot(along) / std::max(1e-12, along.squaredNorm()), 0.0, 1.0);
  return (to - part * along).norm();
}

/// Where a box is at one height: its four edges that stand, there. Nothing where it does not reach that height.
std::vector<Vector3> section(const Pose& X_TP, const Vector3& size, double height) {
  int up = 0;
  X_TP.R.row(2).cwiseAbs().maxCoeff(&up);
  const double along = (height - X_TP.p.z()) / X_TP.R(2, up);
  if (std::abs(along) > 0.5 * size[up]) return {};
  const int a = (up + 1) % 3, b = (up + 2) % 3;
  std::vector<Vector3> points;
  for (const double i : {-0.5, 0.5}) {
    for (const double j : {-0.5, 0.5}) {
      Vector3 p = along * Vector3::Unit(up);
      p[a] = i * size[a];
      p[b] = j * size[b];
      points.push_back(X_TP * p);
    }
  }
  return points;
}

/// m.
double middle_of(std::size_t band) { return (static_cast<double>(band) + 0.5) * kBand; }

}  // namespace

FilmParams film_of(int layers) {
  constexpr double kLayers = 4.0;  // of FilmParams as it is
  const FilmParams four;
  return {layers * (four.tension / kLayers), layers * (four.stretch_stiffness / kLayers),
          layers * (four.shear_stiffness / kLayers)};
}

double Film::length_of(const std::vector<Corner>& hull) {
  double length = 0.0;
  for (std::size_t i = 0; i < hull.size(); ++i) length += (hull[(i + 1) % hull.size()].p_TQ - hull[i].p_TQ).norm();
  return length;
}

Film::Film(std::vector<FilmBox> boxes, const FilmParams& params) : boxes_(std::move(boxes)), params_(params) {}

std::vector<Film::Corner> Film::hull_at(double height, std::span<const Pose> X_TP) const {
  std::vector<Corner> all;
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    for (const Vector3& p : section(X_TP[i], boxes_[i].size, height)) all.push_back({p, i});
  }
  std::vector<Eigen::Vector2d> seen;
  for (const Corner& corner : all) seen.push_back(corner.p_TQ.head<2>());
  std::vector<Corner> hull;
  for (const std::size_t i : plane_hull(seen)) hull.push_back(all[i]);
  return hull;
}

void Film::wrap(std::span<const Pose> X_TP) {
  rest_.assign(X_TP.begin(), X_TP.end());
  bands_.clear();
  for (;;) {
    const std::vector<Corner> hull = hull_at(middle_of(bands_.size()), X_TP);
    if (hull.size() < 3) return;
    Band band;
    Vector3 low = hull.front().p_TQ, high = low;
    band.length = length_of(hull);
    for (std::size_t i = 0; i < hull.size(); ++i) {
      low = low.cwiseMin(hull[i].p_TQ);
      high = high.cwiseMax(hull[i].p_TQ);
    }
    band.extent = high - low;
    for (std::size_t box = 0; box < boxes_.size(); ++box) {
      const double height = hull.front().p_TQ.z();
      bool touches = false;
      for (const Vector3& p : section(X_TP[box], boxes_[box].size, height)) {
        for (std::size_t i = 0; i < hull.size(); ++i) {
          touches |= distance_to(hull[i].p_TQ, hull[(i + 1) % hull.size()].p_TQ, p) <= kTouch;
        }
      }
      if (touches) band.outer.push_back(box);
    }
    bands_.push_back(std::move(band));
  }
}

void Film::leave_out(std::size_t box) {
  boxes_[box].size = Vector3::Constant(-1.0);  // reaches no height
  for (Band& band : bands_) std::erase(band.outer, box);
}

void Film::push(const Vector3& force, const Vector3& p_TQ, std::size_t box, std::span<const Pose> X_TP,
                std::span<Wrench> wrenches_T) const {
  wrenches_T[box].force += force;
  wrenches_T[box].torque += (p_TQ - X_TP[box] * boxes_[box].p_Pcm).cross(force);
}

void Film::pull_hoop(const std::vector<Corner>& hull, double tension, std::span<const Pose> X_TP,
                     std::span<Wrench> wrenches_T) const {
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vector3& p = hull[i].p_TQ;
    const Vector3 after = hull[(i + 1) % hull.size()].p_TQ - p;
    const Vector3 before = hull[(i + hull.size() - 1) % hull.size()].p_TQ - p;
    push(kBand * tension * (after.normalized() + before.normalized()), p, hull[i].box, X_TP, wrenches_T);
  }
}

void Film::wind(std::span<const Pose> X_TP, double part, std::span<Wrench> wrenches_T) const {
  for (std::size_t b = 0;; ++b) {
    const std::vector<Corner> hull = hull_at(middle_of(b), X_TP);
    if (hull.size() < 3) return;
    pull_hoop(hull, part * params_.tension, X_TP, wrenches_T);
  }
}

void Film::shear(std::span<const Pose> X_TP, std::span<Wrench> wrenches_T) const {
  const auto moved = [&](const Band& band) {
    Vector3 mean = Vector3::Zero();
    for (const std::size_t box : band.outer) mean += X_TP[box].p - rest_[box].p;
    return Vector3(mean / static_cast<double>(band.outer.size()));
  };
  const auto spread = [&](const Vector3& force, std::size_t b) {
    const std::vector<std::size_t>& outer = bands_[b].outer;
    for (const std::size_t box : outer) {
      Vector3 p_TQ = X_TP[box].p;
      p_TQ.z() = middle_of(b);
      push(force / static_cast<double>(outer.size()), p_TQ, box, X_TP, wrenches_T);
    }
  };
  Vector3 below = Vector3::Zero();  // the pallet does not move
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    if (bands_[b].outer.empty()) return;  // all that stood there fell off
    const Vector3 here = moved(bands_[b]);
    const Vector3 extent = b == 0 ? bands_[b].extent : bands_[b].extent.cwiseMin(bands_[b - 1].extent);
    Vector3 force = Vector3::Zero();
    for (int axis = 0; axis < 2; ++axis) {
      const double flow = params_.shear_stiffness * (here[axis] - below[axis]) / (b == 0 ? 0.5 * kBand : kBand);
      force[axis] = -2.0 * extent[axis] * std::clamp(flow, -params_.tension, params_.tension);
    }
    spread(force, b);
    if (b > 0) spread(-force, b - 1);
    below = here;
  }
}

void Film::pull(std::span<const Pose> X_TP, std::span<Wrench> wrenches_T) const {
  for (std::size_t b = 0; b < bands_.size(); ++b) {
    const std::vector<Corner> hull = hull_at(middle_of(b), X_TP);
    if (hull.size() < 3) continue;
    const double stretch = length_of(hull) / bands_[b].length - 1.0;
    pull_hoop(hull, std::max(0.0, params_.tension + params_.stretch_stiffness * stretch), X_TP, wrenches_T);
  }
  shear(X_TP, wrenches_T);
}

}  // namespace snug::runs::internal
