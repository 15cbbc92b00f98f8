// dimension_scales: which datasets share an axis, in the attributes by which xarray, netCDF and HDFView know it.
#pragma once

#include "snug/record/internal/h5.hpp"

namespace snug::record::internal {

/// Names of the parts of a row, as datasets of texts in the root group, one text for each column: the scales of second
/// and third axes.
inline constexpr const char* kPosePart = "/pose_part";
inline constexpr const char* kTwistPart = "/twist_part";
inline constexpr const char* kWrenchPart = "/wrench_part";
inline constexpr const char* kAxisPart = "/xyz";

/// Writes the parts and makes `/time`, `/events/time`, `/bodies/name`, `/joints/name` and the parts scales of every
/// dataset with such an axis (HDF5 Dimension Scales Specification 1.1). Once, when all datasets are there and nothing
/// was committed: readers of this module need none of it.
void write_dimension_scales(hid_t file, bool has_bodies, bool has_joints);

/// Is `unit` one of physics for every number of a dataset, and not the meaning of codes or of row numbers?
[[nodiscard]] bool is_physical_unit(const char* unit);

/// The attribute `unit`, and `units`, which readers of netCDF look for, where it is a physical one.
void write_units(hid_t dataset, const char* unit);

}  // namespace snug::record::internal
