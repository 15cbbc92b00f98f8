// Features: planes and edges of boxes as the points of a frame show them, each with its covariance.
#pragma once

#include "snug/box_estimation/internal/view.hpp"

namespace snug::box_estimation::internal {

/// One row of the fit: how far something is from where the box would have it, and how that depends on the box.
/// measured = J (translation; rotation) of the box, both in C, the rotation about its middle.
struct Rows {
  Eigen::Matrix<double, 3, 6> J = Eigen::Matrix<double, 3, 6>::Zero();
  Vector3 measured = Vector3::Zero();
  Matrix3 covariance = Matrix3::Identity();
  int count = 3;  ///< of the rows above that are used
};

/// A face: its offset along the normal [m] and its two tilts [rad].
struct FaceFeature {
  int box = 0, face = 0;
  int points = 0;
  Rows rows;
};

/// An edge of a face: its offset in the face's plane, outward [m], and its turn in the plane [rad].
struct EdgeFeature {
  int box = 0, axis = 0, side = 0;  ///< which side of the box it is on: the axis of P across it, 0: negative end
  bool is_coarse = false;           ///< found at the end of where it was sought: only tells the direction
  Rows rows;
};

/// How one step of a fit takes points and edges.
struct FitStep {
  double wide_gate = 0.0;  ///< m, in which the offset that most points of a face agree on is sought first; 0: not
  double gate = 0.006;     ///< m, points farther from a face (or from that offset) are not its own
  int reach = 14;          ///< px, on either side of where an edge should be
  /// Whether points of a face's plane count where another box should be seen: its face may be as high.
  bool ignores_neighbours = false;
  int first_box = 0;  ///< boxes before it are not measured
};

/// Faces with enough points. Points near the edges of what is seen of a face are left out.
[[nodiscard]] std::vector<FaceFeature> fit_faces(const FitContext& context, const Prediction& prediction,
                                                 const std::vector<TrackedBox>& boxes, const FitStep& step);
/// Edges of faces behind which something else is seen.
[[nodiscard]] std::vector<EdgeFeature> find_edges(const FitContext& context, const Prediction& prediction,
                                                  const std::vector<TrackedBox>& boxes, const FitStep& step);

}  // namespace snug::box_estimation::internal
