// estimate_boxes: where boxes of known size are, from one depth frame and what was believed before.
#pragma once

#include <string>
#include <vector>

#include "snug/box_estimation/settings.hpp"
#include "snug/camera/common_error.hpp"
#include "snug/camera/frame.hpp"
#include "snug/camera/scene.hpp"
#include "snug/geometry/column.hpp"

namespace snug::box_estimation {

/// A box that should be there. Frame P: its middle, axes along the edges.
struct ExpectedBox {
  std::string id;
  Vector3 size = Vector3::Constant(0.1);  ///< m, along Px, Py, Pz
  Pose X_WP;                              ///< where it is believed to be
  double position_spread = 0.010;         ///< m, standard deviation of that belief, each coordinate
  double rotation_spread = 0.05;          ///< rad, about each axis
};

struct EstimateInput {
  camera::Scene surroundings;  ///< what stands still and where it is: container, benches
  std::vector<ExpectedBox> boxes;
  Vector3 region_low = Vector3::Constant(-1e3);  ///< m, W: points outside are passed over
  Vector3 region_high = Vector3::Constant(1e3);
};

/// Surroundings and region of a container that a camera stands over; no boxes yet.
[[nodiscard]] EstimateInput make_input(const model::Scenario& scenario, const model::Container& container);

enum class Sight {
  Seen,     ///< measured
  Hidden,   ///< covered by something else: where it is is belief, not measurement
  Missing,  ///< its place is seen and empty, or another box is in it, and it was found nowhere else
};

/// What a session has to know beside the pose.
enum class Finding {
  Moved,    ///< not where it was believed to be: beyond three standard deviations of the belief, and 10 mm or 3 degrees
  Leaning,  ///< no axis within 4 degrees of the vertical
  OnRim,    ///< reaches over a wall of the container, lower than it stands high
  WrongSize,  ///< edges that were seen are farther apart or nearer than its size, beyond four standard deviations and 3
              ///< mm
};

struct BoxEstimate {
  std::string id;
  Sight sight = Sight::Hidden;
  Pose X_WP;  ///< hidden and missing boxes: as believed
  /// Of [translation; rotation vector], both in W, the rotation about the box's middle: m^2, m rad, rad^2. A depth
  /// frame does not tell the ends of a box apart: the pose is that of its four equal ones which is nearest to the
  /// belief.
  Matrix6 covariance = Matrix6::Zero();
  /// What part of the error comes from the camera's own place and scale, which all boxes of its frames share.
  camera::CommonError common = camera::CommonError::Zero();
  int points = 0;             ///< that lie on it
  double visible_part = 0.0;  ///< of the points that it would have alone in the frame, 0 .. 1
  double rms = 0.0;           ///< m, of its points from its faces
  std::vector<Finding> findings;
};

/// Something that is neither surroundings nor an expected box.
struct Obstacle {
  Vector3 low = Vector3::Zero();  ///< m, W: extent of its points
  Vector3 high = Vector3::Zero();
  int points = 0;                         ///< those at its rim left out
  std::vector<geometry::Column> columns;  ///< its height map
  double deviation = 0.0;                 ///< m, standard deviation of its tops and edges
};

/// Highest point seen over each cell of a level grid, over the region; NaN where nothing was seen.
struct HeightMap {
  double cell = geometry::kColumnSide;  ///< m
  Eigen::Vector2d origin = {0.0, 0.0};  ///< m, W: corner of cell (0, 0), whole cells from the origin of W
  camera::Grid2<float> height;          ///< m, W; rows along y, columns along x
};

enum class FrameFault {
  None,
  TooFewPoints,  ///< fewer than half of the points that should be there
  ViewBlocked,   ///< something stands between camera and region: the arm, say
};

struct Estimate {
  FrameFault fault = FrameFault::None;  ///< if there is one, all boxes are hidden
  double point_part = 0.0;              ///< of the pixels that look into the region, those with a point
  std::vector<BoxEstimate> boxes;       ///< in the order of the input
  std::vector<Obstacle> obstacles;      ///< largest first
  HeightMap heights;
};

/// Pure: same frame, input and settings, same result. docs/camera.md says how.
[[nodiscard]] Estimate estimate_boxes(const camera::Frame& frame, const EstimateInput& input,
                                      const EstimatorSettings& settings = {});

[[nodiscard]] const char* name_of(Sight sight);
[[nodiscard]] const char* name_of(Finding finding);
[[nodiscard]] const char* name_of(FrameFault fault);

/// Of the four rotations that leave a cuboid as it is, the one that brings R_WP nearest to R_WP_near.
[[nodiscard]] Matrix3 nearest_equal_rotation(const Matrix3& R_WP, const Matrix3& R_WP_near);

}  // namespace snug::box_estimation
