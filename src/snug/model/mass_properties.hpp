// Mass properties of shapes of uniform density.
#pragma once

#include <vector>

#include "snug/model/body.hpp"

namespace snug::model {

/// Volume [m^3], and mass, centre and inertia of a shape of unit density, in its carrier's frame.
[[nodiscard]] SpatialInertia unit_density_inertia(const PlacedShape& placed);
/// Sum of parts that share a frame: masses add, inertias by the parallel-axis theorem about the common centre.
[[nodiscard]] SpatialInertia sum_inertias(const std::vector<SpatialInertia>& parts);
/// The same thing with another mass.
[[nodiscard]] SpatialInertia scaled_to_mass(const SpatialInertia& inertia, double mass);
/// Shapes of uniform density and this total mass; what overlaps counts twice.
[[nodiscard]] SpatialInertia uniform_inertia(const std::vector<PlacedShape>& shapes, double mass);
/// Inertia of a cuboid about its centre.
[[nodiscard]] Matrix3 cuboid_inertia(const Vector3& size, double mass);

}  // namespace snug::model
