// CommonError: what errors of all poses from one camera have in common.
#pragma once

#include "snug/spatial/pose.hpp"

namespace snug::camera {

/// How an error of a pose (p in W [m], rotation vector in W [rad], linear first) depends on what all poses of a sensor
/// have in common: seven standard normals that stay the same from observation to observation, such as where the sensor
/// really is (6) and its scale.
using CommonError = Eigen::Matrix<double, 6, 7>;

}  // namespace snug::camera
