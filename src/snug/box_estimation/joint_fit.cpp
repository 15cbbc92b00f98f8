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

/// Normal equations of the boxes that are not held.
class System {
 public:
  System(std::size_t boxes, int held, const FitSettings& settings) : settings_(settings), held_(held) {
    const Eigen::Index size = 6 * (static_cast<Eigen::Index>(boxes) - held);
    H_ = Eigen::MatrixXd::Zero(size, size);
    g_ = Eigen::VectorXd::Zero(size);
  }
  /// Of box `box` of the list; negative when it is held, or nothing that could move.
  [[nodiscard]] Eigen::Index row_of(int box) const { return 6 * static_cast<Eigen::Index>(box - held_); }

  void add(int box, const Rows& rows) {
    const Eigen::Index at = row_of(box);
    const Eigen::MatrixXd J = rows.J.topRows(rows.count);
    const Eigen::MatrixXd W = rows.covariance.topLeftCorner(rows.count, rows.count).inverse();
    H_.block<6, 6>(at, at) += J.transpose() * W * J;
    g_.segment<6>(at) += J.transpose() * W * rows.measured.head(rows.count);
  }
  void add_prior(int box, const TrackedBox& tracked) {
    Vector6 off;
    off << tracked.X_CP_prior.p - tracked.X_CP.p, log_rotation(tracked.X_CP_prior.R * tracked.X_CP.R.transpose());
    H_.block<6, 6>(row_of(box), row_of(box)) += tracked.prior_information;
    g_.segment<6>(row_of(box)) += tracked.prior_information * off;
  }
  /// `gap` m along n (from a to b) at point p, that should not be negative. b < 0: surroundings.
  void add_overlap(int a, int b, const std::vector<TrackedBox>& boxes, const Vector3& n, const Vector3& p, double gap) {
    const auto jacobian = [&](int box, double sign) {
      Vector6 J = Vector6::Zero();
      if (row_of(box) >= 0) J << sign * n, sign * (p - boxes[static_cast<std::size_t>(box)].X_CP.p).cross(n);
      return J;
    };
    const double weight = 1.0 / (settings_.overlap * settings_.overlap);
    const std::array<std::pair<Eigen::Index, Vector6>, 2> both = {
        {{row_of(a), jacobian(a, -1.0)}, {row_of(b), jacobian(b, 1.0)}}};
    for (const auto& [row, J] : both) {
      if (row < 0) continue;
      g_.segment<6>(row) -= weight * gap * J;
      for (const auto& [col, K] : both)
        if (col >= 0) H_.block<6, 6>(row, col) += weight * J * K.transpose();
    }
  }

  [[nodiscard]] Eigen::VectorXd solve() const { return H_.ldlt().solve(g_); }
  [[nodiscard]] Eigen::MatrixXd covariance() const {
    return H_.ldlt().solve(Eigen::MatrixXd::Identity(H_.rows(), H_.cols()));
  }

 private:
  const FitSettings& settings_;
  int held_;
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
};

void add_overlaps(const FitContext& context, const std::vector<TrackedBox>& boxes, int held, System& system) {
  const auto add = [&](int a, int b, const geometry::Shape& A, const Pose& X_CA, const geometry::Shape& B,
                       const Pose& X_CB) {
    if ((X_CA.p - X_CB.p).norm() > geometry::bounding_radius(A) + geometry::bounding_radius(B)) return;
    geometry::PairCache cache;
    geometry::Manifold manifold;
    geometry::collide(A, X_CA, B, X_CB, 0.0, cache, manifold);
    for (int i = 0; i < manifold.count; ++i) {
      const geometry::ManifoldPoint& point = manifold.points[static_cast<std::size_t>(i)];
      // Deeper than what a fit can be off by: another box is thought to be where this one is. Pushing would move both.
      if (point.phi < 0.0 && point.phi > -context.settings.fit.deepest_overlap)
        system.add_overlap(a, b, boxes, manifold.n_AB_W, 0.5 * (point.p_WA + point.p_WB), point.phi);
    }
  };
  for (std::size_t b = static_cast<std::size_t>(held); b < boxes.size(); ++b) {
    const geometry::Shape box_b = geometry::Box{boxes[b].half};
    for (std::size_t a = static_cast<std::size_t>(held); a < b; ++a)
      add(static_cast<int>(a), static_cast<int>(b), geometry::Box{boxes[a].half}, boxes[a].X_CP, box_b, boxes[b].X_CP);
    for (const camera::SceneShape& fixed : context.surroundings_C.shapes)
      add(static_cast<int>(b), -1, box_b, boxes[b].X_CP, fixed.shape, fixed.X_WG);
  }
}

/// Opposite edges that were both seen tell the size: how far that is from what is known.
void note_size(const std::vector<EdgeFeature>& edges, const std::vector<TrackedBox>& boxes, FitResult& result) {
  result.size_error.assign(boxes.size(), 0.0);
  result.size_misfit.assign(boxes.size(), Vector3::Constant(std::numeric_limits<double>::quiet_NaN()));
  result.is_larger.assign(boxes.size(), false);
  for (const EdgeFeature& edge : edges)
    if (edge.is_coarse && edge.rows.measured(0) > 0.0) result.is_larger[static_cast<std::size_t>(edge.box)] = true;
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

/// From a belief that is off by centimetres to the camera's noise: first the planes alone, since edges are sought in
/// them. From rough poses on, edges at once: without them boxes would go back to the belief.
FitStep step_of(const FitSettings& settings, bool planes_only, int step, int left, double noise) {
  FitStep how;
  how.wide_gate = planes_only ? settings.wide_gate_from_belief : step <= 1 ? settings.wide_gate : 0.0;
  how.gate = std::max(planes_only ? settings.gate_from_belief
                      : step <= 1 ? settings.gate_rough
                                  : settings.gate,
                      4.0 * noise);
  how.reach = left >= 2 ? settings.reach_rough : left == 1 ? settings.reach_near : settings.reach;
  how.ignores_neighbours = left < 2;
  return how;
}

}  // namespace

FitResult kept_of(const FitResult& fit, const std::vector<bool>& is_kept) {
  FitResult kept;
  for (std::size_t i = 0; i < fit.boxes.size(); ++i) {
    if (!is_kept[i]) continue;
    kept.boxes.push_back(fit.boxes[i]);
    kept.covariance.push_back(fit.covariance[i]);
    kept.size_misfit.push_back(fit.size_misfit[i]);
    kept.is_larger.push_back(fit.is_larger[i]);
    kept.size_error.push_back(fit.size_error[i]);
  }
  return kept;
}

FitResult fit_boxes(const FitContext& context, std::vector<TrackedBox> boxes, FitStart start, int steps, int held) {
  FitResult result;
  const auto first = static_cast<std::size_t>(held);
  const double noise = context.errors.point_error(context.frame.camera.range.focus);
  for (int step = 0; step < steps && !boxes.empty(); ++step) {
    const bool is_last = step + 1 == steps;
    const int left = steps - 1 - step;
    const bool planes_only = start == FitStart::Belief && step == 0;
    FitStep how = step_of(context.settings.fit, planes_only, step, left, noise);
    how.first_box = held;
    const Prediction prediction = predict(context.frame, context.range, context.surroundings_C, boxes);
    System system(boxes.size(), held, context.settings.fit);
    for (std::size_t i = first; i < boxes.size(); ++i) system.add_prior(static_cast<int>(i), boxes[i]);
    for (const FaceFeature& face : fit_faces(context, prediction, boxes, how)) system.add(face.box, face.rows);
    std::vector<EdgeFeature> edges;
    if (!planes_only) edges = find_edges(context, prediction, boxes, how);
    for (const EdgeFeature& edge : edges)
      if (!edge.is_coarse || left >= 2) system.add(edge.box, edge.rows);
    add_overlaps(context, boxes, held, system);
    const Eigen::VectorXd change = system.solve();
    for (std::size_t i = first; i < boxes.size(); ++i) {
      const Vector6 own = change.segment<6>(system.row_of(static_cast<int>(i)));
      boxes[i].X_CP.p += own.head<3>();
      boxes[i].X_CP.R = orthonormalized(exp_rotation(own.tail<3>()) * boxes[i].X_CP.R);
    }
    if (!is_last) continue;
    const Eigen::MatrixXd covariance = system.covariance();
    result.covariance.assign(boxes.size(), Matrix6::Zero());
    for (std::size_t i = first; i < boxes.size(); ++i) {
      const Eigen::Index row = system.row_of(static_cast<int>(i));
      result.covariance[i] = covariance.block<6, 6>(row, row);
    }
    note_size(edges, boxes, result);
  }
  result.boxes = std::move(boxes);
  return result;
}

}  // namespace snug::box_estimation::internal
