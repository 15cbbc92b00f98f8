// PlacementList: which box shall rest where in the container, in the order of packing, as a person or planner wrote it.
#include "snug/model/placements.hpp"

#include <cmath>
#include <set>

#include <yaml-cpp/yaml.h>

#include "snug/core/read_file.hpp"
#include "snug/model/internal/value.hpp"
#include "snug/model/yaml_limits.hpp"

namespace snug::model {
namespace {

using internal::Document;
using internal::MapReader;
using internal::Value;

// A quaternion written with four digits is this near to unit length.
constexpr double kUnitTolerance = 1e-3;

Matrix3 read_quaternion(const Value& quat) {
  Eigen::Vector4d wxyz;
  const std::vector<Value> numbers = quat.list_of(4, "w, x, y, z");
  for (std::size_t i = 0; i < 4; ++i) wxyz[static_cast<Eigen::Index>(i)] = numbers[i].number();
  if (std::abs(wxyz.norm() - 1.0) > kUnitTolerance) quat.fail("a unit quaternion w, x, y, z");
  return Quaternion(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized().toRotationMatrix();
}

Matrix3 read_orientation(const MapReader& map) {
  map.forbid_together("yaw_deg", "quat_wxyz");
  if (const auto yaw = map.find("yaw_deg")) return exp_rotation(Vector3(0.0, 0.0, yaw->radians_from_degrees()));
  const auto quat = map.find("quat_wxyz");
  return quat ? read_quaternion(*quat) : Matrix3::Identity();
}

/// Of a plan of `snug pack`, which also says in words what the quaternion says.
PlacementEntry read_planned(const MapReader& map) {
  return {"", {read_quaternion(map.require("quaternion_wxyz")), map.require("position").position()}};
}

std::vector<PlacementEntry> read_list(const Value& root, const Scenario& scenario) {
  const bool is_plan = root.is_map();
  const Value list =
      is_plan ? root.map("plan", {"sequence", "agent", "complete", "placements"}).require("placements") : root;
  const std::vector<std::string> keys =
      is_plan ? std::vector<std::string>{"box", "position", "quaternion_wxyz", "up", "up_sign", "yaw_quarter"}
              : std::vector<std::string>{"box", "position", "yaw_deg", "quat_wxyz"};
  std::vector<std::string> ids;
  for (const Parcel& parcel : scenario.parcels) ids.push_back(parcel.id);
  std::set<std::string> placed;
  std::vector<PlacementEntry> entries;
  for (const Value& item : list.list()) {
    const MapReader map = item.map("placement", keys);
    const Value box = map.require("box");
    PlacementEntry entry =
        is_plan ? read_planned(map) : PlacementEntry{"", {read_orientation(map), map.require("position").position()}};
    entry.parcel = box.name();
    if (find_parcel(scenario, entry.parcel) == nullptr) {
      box.fail("a parcel of the scenario" + internal::nearest_hint(entry.parcel, ids));
    }
    if (!placed.insert(entry.parcel).second) box.fail("each box at most once");
    const std::string where = box.where();
    entry.line = std::stoi(where.substr(where.rfind(':') + 1));
    entries.push_back(std::move(entry));
  }
  if (entries.empty()) list.fail("a list of placements, at least one");
  return entries;
}

}  // namespace

std::vector<PlacementEntry> load_placements(const std::filesystem::path& path, const Scenario& scenario) {
  return parse_placements(read_file(path, "a placements file (YAML)"), path.string(), scenario);
}

std::vector<PlacementEntry> parse_placements(std::string_view text, std::string_view name, const Scenario& scenario) {
  Document document{std::string(name), {}};
  check_yaml(text, name);
  try {
    return read_list(Value(YAML::Load(std::string(text)), "", document, 1), scenario);
  } catch (const YAML::Exception& error) {
    throw InputError(document.name + ":" + std::to_string(error.mark.line + 1), "", error.msg,
                     "YAML that can be parsed");
  }
}

}  // namespace snug::model
