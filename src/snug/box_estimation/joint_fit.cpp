// fit_boxes: Gauss-Newton on planes and edges, with overlaps pushed apart.
#include "snug/box_estimation/internal/joint_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "snug/box_estimation/internal/features.hpp"
#include "snug/geometry/bounds.hpp"
#include "snug/geometry/manifold.hpp"

namespace snug::box_estimation::internal {
namespace {

/// m: how far solids may overlap, a standard deviation: soft boxes give way by about that.
constexpr double kOverlap = 1.0e-3;

class System {
 public:
  explicit System(std::size_t boxes)
      : H_(Eigen::MatrixXd::Zero(size(boxes), size(boxes))), g_(Eigen::VectorXd::Zero(size(boxes))) {}

  void add(int box, const Rows& rows) {
    const Eigen::Index at = 6 * box;
    const Eigen::MatrixXd J = rows.J.topRows(rows.count);
    const Eigen::MatrixXd W = rows.covariance.topLeftCorner(rows.count, rows.count).inverse();
    H_.block<6, 6>(at, at) += J.transpose() * W * J;
    g_.segment<6>(at) += J.transpose() * W * rows.measured.head(rows.count);
  }
  void add_prior(int box, const TrackedBox& tracked) {
    Vector6 off;
    off << tracked.X_CP_prior.p - tracked.X_CP.p, log_rotation(tracked.X_CP_prior.R * tracked.X_CP.R.transpose());
    H_.block<6, 6>(6 * box, 6 * box) += tracked.prior_information;
    g_.segment<6>(6 * box) += tracked.prior_information * off;
  }
  /// `gap` m along n (from a to b) at point p, that should not be negative. b < 0: something fixed.
  void add_overlap(int a, int b, const std::vector<TrackedBox>& boxes, const Vector3& n, const Vector3& p, double gap) {
    const auto jacobian = [&](int box, double sign) {
      Vector6 J;
      J << sign * n, sign * (p - boxes[static_cast<std::size_t>(box)].X_CP.p).cross(n);
      return J;
    };
    const double weight = 1.0 / (kOverlap * kOverlap);
    const Vector6 Ja = jacobian(a, -1.0);
    H_.block<6, 6>(6 * a, 6 * a) += weight * Ja * Ja.transpose();
    g_.segment<6>(6 * a) -= weight * gap * Ja;
    if (b < 0) return;
    const Vector6 Jb = jacobian(b, 1.0);
    H_.block<6, 6>(6 * b, 6 * b) += weight * Jb * Jb.transpose();
    H_.block<6, 6>(6 * a, 6 * b) += weight * Ja * Jb.transpose();
    H_.block<6, 6>(6 * b, 6 * a) += weight * Jb * Ja.transpose();
    g_.segment<6>(6 * b) -= weight * gap * Jb;
  }

  [[nodiscard]] Eigen::VectorXd solve() const { return H_.ldlt().solve(g_); }
  [[nodiscard]] Eigen::MatrixXd covariance() const {
    return H_.ldlt().solve(Eigen::MatrixXd::Identity(H_.rows(), H_.cols()));
  }

 private:
  static Eigen::Index size(std::size_t boxes) { return 6 * static_cast<Eigen::Index>(boxes); }
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
};

void add_overlaps(const std::vector<TrackedBox>& boxes, const camera::Scene& surroundings_C, System& system) {
  const auto add = [&](int a, int b, const geometry::Shape& A, const Pose& X_CA, const geometry::Shape& B,
                       const Pose& X_CB) {
    if ((X_CA.p - X_CB.p).norm() > geometry::bounding_radius(A) + geometry::bounding_radius(B)) return;
    geometry::PairCache cache;
    geometry::Manifold manifold;
    geometry::collide(A, X_CA, B, X_CB, 0.0, cache, manifold);
    for (int i = 0; i < manifold.count; ++i) {
      const geometry::ManifoldPoint& point = manifold.points[static_cast<std::size_t>(i)];
      // Deeper than what a fit can be off by: another box is thought to be where this one is. Pushing would move both.
      if (point.phi < 0.0 && point.phi > -0.03)
        system.add_overlap(a, b, boxes, manifold.n_AB_W, 0.5 * (point.p_WA + point.p_WB), point.phi);
    }
  };
  for (std::size_t a = 0; a < boxes.size(); ++a) {
    const geometry::Shape box_a = geometry::Box{boxes[a].half};
    for (std::size_t b = a + 1; b < boxes.size(); ++b)
      add(static_cast<int>(a), static_cast<int>(b), box_a, boxes[a].X_CP, geometry::Box{boxes[b].half}, boxes[b].X_CP);
    for (const camera::SceneShape& fixed : surroundings_C.shapes)
      add(static_cast<int>(a), -1, box_a, boxes[a].X_CP, fixed.shape, fixed.X_WG);
  }
}

/// Opposite edges that were both seen tell the size: how far that is from what is known.
void note_size(const std::vector<EdgeFeature>& edges, const std::vector<TrackedBox>& boxes, FitResult& result) {
  result.size_error.assign(boxes.size(), 0.0);
  result.size_misfit.assign(boxes.size(), Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (const EdgeFeature& low : edges)
    for (const EdgeFeature& high : edges) {
      if (low.box != high.box || low.axis != high.axis || low.side != 0 || high.side != 1) continue;
      if (low.is_coarse || high.is_coarse) continue;
      const double misfit = low.rows.measured(0) + high.rows.measured(0);
      const double sigma = std::sqrt(low.rows.covariance(0, 0) + high.rows.covariance(0, 0));
      const auto k = static_cast<std::size_t>(low.box);
      result.size_misfit[k](low.axis) = misfit;
      result.size_error[k] = std::max(result.size_error[k], std::abs(misfit) / sigma);
    }
}

}  // namespace

FitResult fit_boxes(const camera::Frame& frame, const PixelRange& range, const camera::Scene& surroundings_C,
                    std::vector<TrackedBox> boxes, const ErrorModel& errors, FitStart start, int steps) {
  FitResult result;
  const double noise = errors.point_error(frame.camera.range.focus);
  for (int step = 0; step < steps && !boxes.empty(); ++step) {
    const bool is_last = step + 1 == steps;
    FeatureSettings settings;
    // From a belief that is off by centimetres to the camera's noise: first the planes alone, since edges are looked
    // for in them. From rough poses on, edges at once: without them boxes would go back to the belief.
    const int left = steps - 1 - step;
    const bool planes_only = start == FitStart::Belief && step == 0;
    settings.wide_gate = planes_only ? 0.025 : step <= 1 ? 0.008 : 0.0;
    settings.gate = std::max(planes_only ? 0.006 : step <= 1 ? 0.004 : 0.0015, 4.0 * noise);
    settings.reach = left >= 2 ? 16 : left == 1 ? 9 : 7;
    settings.ignores_neighbours = left < 2;
    const Prediction prediction = predict(frame, range, surroundings_C, boxes);
    System system(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) system.add_prior(static_cast<int>(i), boxes[i]);
    for (const FaceFeature& face : fit_faces(frame, prediction, boxes, errors, settings))
      system.add(face.box, face.rows);
    std::vector<EdgeFeature> edges;
    if (!planes_only) edges = find_edges(frame, prediction, boxes, errors, settings);
    for (const EdgeFeature& edge : edges)
      if (!edge.is_coarse || left >= 2) system.add(edge.box, edge.rows);
    add_overlaps(boxes, surroundings_C, system);
    const Eigen::VectorXd change = system.solve();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vector6 own = change.segment<6>(6 * static_cast<Eigen::Index>(i));
      boxes[i].X_CP.p += own.head<3>();
      boxes[i].X_CP.R = orthonormalized(exp_rotation(own.tail<3>()) * boxes[i].X_CP.R);
    }
    if (!is_last) continue;
    const Eigen::MatrixXd covariance = system.covariance();
    for (std::size_t i = 0; i < boxes.size(); ++i)
      result.covariance.push_back(
          covariance.block<6, 6>(6 * static_cast<Eigen::Index>(i), 6 * static_cast<Eigen::Index>(i)));
    note_size(edges, boxes, result);
  }
  result.boxes = std::move(boxes);
  return result;
}

std::optional<Pose> turned_to_sizes(const TrackedBox& box, const Vector3& size_misfit, const Matrix3& R_PC_believed) {
  constexpr double kBetter = 1.0e-3;  // m: less than that is noise
  // The axis whose face looks most toward the camera; its length is not seen.
  int depth_axis = 0;
  (box.X_CP.R.transpose() * box.X_CP.p.normalized()).cwiseAbs().maxCoeff(&depth_axis);
  const auto misfit_of = [&](const std::array<int, 3>& order) {  // box axis order[k] lies where axis k lay
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double seen = 2.0 * box.half(k) + size_misfit(k);
      if (k != depth_axis && std::isfinite(seen))
        sum += std::abs(seen - 2.0 * box.half(order[static_cast<std::size_t>(k)]));
    }
    return sum;
  };
  std::array<int, 3> order = {0, 1, 2}, best = order;
  const double now = misfit_of(order);
  double least = now - kBetter;
  while (std::next_permutation(order.begin(), order.end())) {
    if (misfit_of(order) >= least) continue;
    least = misfit_of(order);
    best = order;
  }
  if (best == std::array<int, 3>{0, 1, 2}) return std::nullopt;
  Matrix3 R_CP;
  for (int k = 0; k < 3; ++k) R_CP.col(best[static_cast<std::size_t>(k)]) = box.X_CP.R.col(k);
  if (R_CP.determinant() < 0.0) R_CP.col(0) = -R_CP.col(0);
  const Vector3 into = box.X_CP.R.col(depth_axis) * (box.X_CP.R.col(depth_axis).dot(box.X_CP.p) > 0.0 ? 1.0 : -1.0);
  const double deeper = box.half(best[static_cast<std::size_t>(depth_axis)]) - box.half(depth_axis);
  return Pose{nearest_equal_rotation(R_CP, R_PC_believed.transpose()), box.X_CP.p + deeper * into};
}

}  // namespace snug::box_estimation::internal
