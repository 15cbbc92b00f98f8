// ScenarioReader: turns the parsed text into a Scenario, part by part, then checks the parts against each other.
#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "snug/model/internal/value.hpp"
#include "snug/model/scenario.hpp"

namespace snug::model::internal {

class ScenarioReader {
 public:
  ScenarioReader(const Value& root, Scenario& scenario) : root_(root), scenario_(scenario) {}
  /// Everything; order matters because later parts name earlier ones.
  void read();
  /// Only more parcel types, parcels and sequences, for a scenario that is complete without them.
  void read_items();

 private:
  // read_scene.cpp
  void read_settings(const MapReader& map);
  void read_materials(const MapReader& map);
  void read_contacts(const Value& value);
  void read_frames(const Value& value);
  void read_containers(const MapReader& map);
  void read_body(const Value& value);
  void read_body_inertia(const MapReader& map, const Parcel* parcel, Body& body) const;
  [[nodiscard]] PosePath read_path(const Value& value) const;
  void read_motion(const MapReader& map, Body& body) const;
  void read_initial_state(const Value& value);
  void read_spring(const Value& value);
  void read_wrench(const Value& value);
  [[nodiscard]] const Body& find_dynamic_body(const Value& value) const;
  void read_drops(const Value& value);
  // read_cell.cpp
  void read_parcel_type(const Value& value);
  void read_parcel(const Value& value);
  [[nodiscard]] SpatialInertia read_parcel_inertia(const MapReader& map, const ParcelType& type,
                                                   const Vector3& size) const;
  void read_aligner(const Value& value);
  void read_uncertainty(const Value& value);
  // read_session_settings.cpp
  void read_session_settings(const MapReader& map);
  void read_tool(const Value& value);
  void read_cup(const Value& value, CupParams& cup) const;
  void read_controller(const Value& value);
  void read_sequence(const Value& value);
  void read_reported(const MapReader& map, Sequence& sequence) const;
  [[nodiscard]] Item read_item(const Value& value) const;
  // read_gripper.cpp
  void read_gripper(const Value& value);
  void read_mounted_cup(const Value& value, GripperParams& gripper) const;
  void read_cup_grid(const Value& value, GripperParams& gripper) const;
  // read_robot.cpp
  void read_robot(const Value& value);
  // read_camera.cpp
  void read_camera(const Value& value);
  // checks.cpp
  void check_parcel_fits(const Value& value, const Parcel& parcel) const;
  void check_drops_fit(const Value& value, const Drops& drops) const;
  void check_materials_meet(const Value& at) const;
  void check_overlaps() const;
  void check_spins() const;

  // read_shapes.cpp
  [[nodiscard]] Pose read_frame_name(const Value& value) const;
  [[nodiscard]] Pose read_world_pose(const std::optional<Value>& value) const;
  [[nodiscard]] MaterialId read_material(const Value& value) const;

  /// A solid of the scene at time 0, with where it was described.
  struct Placed;
  [[nodiscard]] std::vector<Placed> placed_solids() const;
  [[nodiscard]] double compliant_depth(const Placed& a, const Placed& b) const;

  Value root_;
  Scenario& scenario_;
  std::vector<Value> parcel_values_;
  std::vector<Value> container_values_;
  std::vector<Value> body_values_;
  std::optional<Value> aligner_value_;
  std::optional<Value> drops_value_;
};

/// A pose in the frame of the thing that carries it: keys position and one of the ways to write a rotation.
[[nodiscard]] Pose read_local_pose(const std::optional<Value>& value);
/// Rotation from whichever of yaw_deg, rpy_deg, quat_wxyz, rotation_vector is there; identity without.
[[nodiscard]] Matrix3 read_rotation(const MapReader& map);
[[nodiscard]] std::vector<std::string> pose_keys();
/// At least one; a mesh gives one for each of its parts.
[[nodiscard]] std::vector<PlacedShape> read_shapes(const Value& value);
/// Three principal moments, or six numbers xx, yy, zz, xy, xz, yz; positive definite, triangle inequality kept.
[[nodiscard]] Matrix3 read_inertia(const Value& value);
/// Names what to say when a name is not among those known.
[[noreturn]] void fail_unknown_name(const Value& value, const std::string& what, const std::vector<std::string>& names);
void check_new_name(const Value& value, const std::string& what, bool is_taken);

template <class Things, class NameOf>
[[nodiscard]] std::vector<std::string> names_of(const Things& things, NameOf name_of) {
  std::vector<std::string> names;
  for (const auto& thing : things) names.push_back(name_of(thing));
  return names;
}

}  // namespace snug::model::internal
