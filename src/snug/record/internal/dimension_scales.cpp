// dimension_scales: the attributes of the HDF5 Dimension Scales Specification, without a second shared library
// (libhdf5_hl) for every program that writes a recording.
#include "snug/record/internal/dimension_scales.hpp"

#include <algorithm>
#include <cstring>
#include <map>
#include <string_view>

#include "snug/core/check.hpp"
#include "snug/record/internal/layout.hpp"

namespace snug::record::internal {
namespace {

using ScalePaths = std::vector<const char*>;

/// Text that ends with a zero byte: H5DSis_scale() takes no other.
void write_word(hid_t object, const char* name, std::string_view word) {
  const Handle type(H5Tcopy(H5T_C_S1), name);
  check(H5Tset_size(type.get(), word.size() + 1), name);
  write_attribute(object, name, type.get(), std::string(word).c_str());
}

/// A reference and the axis, without gaps.
struct AxisUse {
  hobj_ref_t dataset = 0;
  std::int32_t axis = 0;
};

/// Handed to HDF5 in one piece: 12 bytes each, as in the file.
Handle axis_use_type() {
  Handle type(H5Tcreate(H5T_COMPOUND, sizeof(hobj_ref_t) + sizeof(std::int32_t)), "REFERENCE_LIST");
  check(H5Tinsert(type.get(), "dataset", 0, H5T_STD_REF_OBJ), "REFERENCE_LIST");
  check(H5Tinsert(type.get(), "dimension", sizeof(hobj_ref_t), H5T_STD_I32LE), "REFERENCE_LIST");
  return type;
}

class Scales {
 public:
  explicit Scales(hid_t file) : file_(file) {}

  void attach(const char* path, const ScalePaths& scales) {
    const Handle dataset(H5Dopen2(file_, path, H5P_DEFAULT), path);
    SNUG_CHECK(dims_of(dataset.get()).size() == scales.size(), "a scale for each axis");
    const hobj_ref_t own = reference_to(path);
    std::vector<hobj_ref_t> references;
    for (const char* scale : scales) references.push_back(reference_to(scale));
    std::vector<hvl_t> lists;
    for (std::size_t axis = 0; axis < scales.size(); ++axis) {
      lists.push_back({1, &references[axis]});
      uses_[scales[axis]].push_back({own, static_cast<std::int32_t>(axis)});
    }
    const Handle type(H5Tvlen_create(H5T_STD_REF_OBJ), path);
    write_list(dataset.get(), "DIMENSION_LIST", type.get(), lists.size(), lists.data());
  }

  /// What makes scales of those that were attached.
  void write() const {
    const Handle type = axis_use_type();
    for (const auto& [path, uses] : uses_) {
      const Handle scale(H5Dopen2(file_, path.c_str(), H5P_DEFAULT), path.c_str());
      write_word(scale.get(), "CLASS", "DIMENSION_SCALE");
      write_word(scale.get(), "NAME", std::string_view(path).substr(path.rfind('/') + 1));
      std::vector<unsigned char> packed;
      for (const AxisUse& use : uses) {
        const std::size_t at = packed.size();
        packed.resize(at + sizeof(use.dataset) + sizeof(use.axis));
        std::memcpy(packed.data() + at, &use.dataset, sizeof(use.dataset));
        std::memcpy(packed.data() + at + sizeof(use.dataset), &use.axis, sizeof(use.axis));
      }
      write_list(scale.get(), "REFERENCE_LIST", type.get(), uses.size(), packed.data());
    }
  }

 private:
  [[nodiscard]] hobj_ref_t reference_to(const char* path) const {
    hobj_ref_t reference = 0;
    check(H5Rcreate(&reference, file_, path, H5R_OBJECT, -1), path);
    return reference;
  }

  static void write_list(hid_t object, const char* name, hid_t type, hsize_t count, const void* values) {
    const Handle space(H5Screate_simple(1, &count, nullptr), name);
    const Handle attribute(H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), name);
    check(H5Awrite(attribute.get(), type, values), name);
  }

  hid_t file_;
  std::map<std::string, std::vector<AxisUse>> uses_;  ///< by path of the scale
};

constexpr const char* kTimeScale = "/time";
constexpr const char* kBodyScale = "/bodies/name";

ScalePaths scales_of(const ColumnSpec& spec) {
  if (spec.width == 1) return {kTimeScale};
  if (spec.width == 7) return {kTimeScale, kPosePart};
  return {kTimeScale, *spec.columns == 'v' ? kTwistPart : kWrenchPart};
}

}  // namespace

void write_dimension_scales(hid_t file, bool has_bodies, bool has_joints) {
  write_texts(file, kPosePart, {"x", "y", "z", "qw", "qx", "qy", "qz"});
  write_texts(file, kTwistPart, {"vx", "vy", "vz", "wx", "wy", "wz"});
  write_texts(file, kWrenchPart, {"fx", "fy", "fz", "tx", "ty", "tz"});
  write_texts(file, kAxisPart, {"x", "y", "z"});
  Scales scales(file);
  for (std::size_t i = 0; i < kFrameColumnCount; ++i) {
    const ColumnSpec& spec = frame_column(static_cast<FrameColumn>(i));
    if (std::string_view(spec.path) != kTimeScale) scales.attach(spec.path, scales_of(spec));
  }
  for (const char* path : {kEventKind, kEventBody, kEventText, kEventNumberFirst, kEventNumberCount})
    scales.attach(path, {kEventTime});
  if (has_bodies) {
    scales.attach("/bodies/present", {kTimeScale, kBodyScale});
    scales.attach("/bodies/pose", {kTimeScale, kBodyScale, kPosePart});
    scales.attach("/bodies/twist", {kTimeScale, kBodyScale, kTwistPart});
    for (const char* path : {"/bodies/type", "/bodies/kind", "/bodies/mass"}) scales.attach(path, {kBodyScale});
    scales.attach("/bodies/com", {kBodyScale, kAxisPart});
  }
  for (std::size_t i = 0; has_joints && i < kJointColumnCount; ++i)
    scales.attach(joint_column(i, 1).path, {kTimeScale, kJointName});
  scales.write();
}

bool is_physical_unit(const char* unit) {
  static constexpr std::string_view kPhysical[] = {
      "s", "m", "rad", "kg", "Pa", "N", "m, -", "m/s, rad/s", "N, Nm", "rad or m", "rad/s or m/s", "Nm or N"};
  return std::ranges::find(kPhysical, std::string_view(unit)) != std::end(kPhysical);
}

void write_units(hid_t dataset, const char* unit) {
  if (*unit == '\0') return;
  write_attribute(dataset, "unit", unit);
  if (is_physical_unit(unit)) write_attribute(dataset, "units", unit);
}

}  // namespace snug::record::internal
