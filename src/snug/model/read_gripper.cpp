// ScenarioReader: the gripper: its cup, or several of them with their zones and the supply that they share.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"

namespace snug::model::internal {
namespace {

constexpr double kFarthestCup = 2.0;      // m, from E
constexpr double kWidestPort = 0.1;       // m
constexpr const char* kOneZone = "main";  // of cups that name none

/// Two numbers or three, m, in E.
Vector3 read_place(const Value& value) {
  const std::vector<Value> numbers = value.list();
  if (numbers.size() != 2 && numbers.size() != 3)
    value.fail(std::to_string(numbers.size()) + " numbers", "two numbers, [x, y], or three, in metres");
  Vector3 p = Vector3::Zero();
  for (std::size_t i = 0; i < numbers.size(); ++i)
    p[static_cast<Eigen::Index>(i)] =
        numbers[i].number_within(-kFarthestCup, kFarthestCup, "a place of a cup in metres");
  return p;
}

/// One number for both directions, or two.
Eigen::Vector2d read_pitch(const Value& value) {
  const auto pitch = [](const Value& one) {
    return one.number_within(kSmallestSize, kFarthestCup, "a pitch in metres");
  };
  if (value.is_scalar()) return Eigen::Vector2d::Constant(pitch(value));
  const std::vector<Value> both = value.list_of(2, "pitches, along Ex and Ey");
  return {pitch(both[0]), pitch(both[1])};
}

std::size_t zone_of(const std::optional<Value>& value, GripperParams& gripper) {
  const std::string name = value ? value->name() : kOneZone;
  const auto known = std::find(gripper.zones.begin(), gripper.zones.end(), name);
  if (known != gripper.zones.end()) return static_cast<std::size_t>(known - gripper.zones.begin());
  if (gripper.zones.size() == 32) value->fail("a 33rd zone", "at most 32 zones");
  gripper.zones.push_back(name);
  return gripper.zones.size() - 1;
}

void check_line(const Value& at, const CupLine& line) {
  if (std::max(line.port_diameter, line.leak_diameter) > kWidestPort)
    at.fail("a bore of " + to_text(std::max(line.port_diameter, line.leak_diameter)) + " m",
            "bores in metres, at most 0.1");
}

void check_apart(const Value& at, const GripperParams& gripper) {
  for (std::size_t i = 0; i < gripper.cups.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const MountedCup &a = gripper.cups[i], &b = gripper.cups[j];
      if (a.name == b.name) at.fail("two cups '" + a.name + "'", "cups of different names");
      const double distance = (a.p_EC - b.p_EC).head<2>().norm();
      const double needed = 0.5 * (a.cup.effective_diameter + b.cup.effective_diameter);
      if (distance < needed - 1e-9)
        at.fail("cups '" + b.name + "' and '" + a.name + "' " + to_text(distance) + " m apart",
                "cups that do not overlap: at least " + to_text(needed) + " m for these effective diameters");
    }
  }
}

}  // namespace

void ScenarioReader::read_gripper(const Value& value) {
  const MapReader map = value.map("gripper", {"cups", "grid", "supply"});
  const std::string kind = map.require_one_of({"cups", "grid"});
  GripperParams gripper;
  if (kind == "cups") {
    const Value cups = map.require("cups");
    for (const Value& entry : cups.list()) read_mounted_cup(entry, gripper);
    if (gripper.cups.empty()) cups.fail("an empty list", "at least one cup");
  } else {
    read_cup_grid(map.require("grid"), gripper);
  }
  if (static_cast<int>(gripper.cups.size()) > kMostCups)
    value.fail(std::to_string(gripper.cups.size()) + " cups", "at most " + std::to_string(kMostCups));
  check_apart(value, gripper);
  if (const auto supply = map.find("supply")) {
    const MapReader keys = supply->map("supply", field_keys<SupplyParams>());
    gripper.supply = SupplyParams{0.0, scenario_.cup.vacuum.pressure_gauge_hold};
    (void)keys.require("flow");
    read_fields(keys, *gripper.supply);
    if (gripper.supply->flow > 1.0)
      keys.require("flow").fail("m^3/s of air, at most 1 (an ejector of 100 l/min has 1.7e-3)");
    for (const MountedCup& cup : gripper.cups) {
      const VacuumParams& vacuum = cup.cup.vacuum;
      const bool is_ordered = -vacuum.ambient_pressure_abs < gripper.supply->pressure_gauge &&
                              gripper.supply->pressure_gauge <= vacuum.pressure_gauge_collapse;
      if (!is_ordered)
        supply->fail("pressure_gauge " + to_text(gripper.supply->pressure_gauge),
                     "-ambient_pressure_abs < pressure_gauge <= pressure_gauge_collapse of every cup");
    }
  }
  scenario_.cup = equivalent_cup(gripper);
  scenario_.gripper = std::move(gripper);
}

void ScenarioReader::read_mounted_cup(const Value& value, GripperParams& gripper) const {
  const MapReader map = value.map("mounted_cup", keys_with<CupLine>({"name", "at", "zone", "cup"}));
  MountedCup cup;
  cup.name = std::to_string(gripper.cups.size() + 1);
  if (const auto name = map.find("name")) cup.name = name->name();
  cup.p_EC = read_place(map.require("at"));
  cup.zone = zone_of(map.find("zone"), gripper);
  read_fields(map, cup.line);
  check_line(value, cup.line);
  cup.cup = scenario_.cup;
  if (const auto own = map.find("cup")) read_cup(*own, cup.cup);
  gripper.cups.push_back(std::move(cup));
}

void ScenarioReader::read_cup_grid(const Value& value, GripperParams& gripper) const {
  const MapReader map = value.map("grid", keys_with<CupLine>({"columns", "rows", "pitch", "zone"}));
  const auto columns = map.require("columns").integer(1, kMostCups), rows = map.require("rows").integer(1, kMostCups);
  if (columns * rows > kMostCups)
    value.fail(std::to_string(columns * rows) + " cups", "at most " + std::to_string(kMostCups));
  const Eigen::Vector2d pitch = read_pitch(map.require("pitch"));
  MountedCup cup;
  cup.zone = zone_of(map.find("zone"), gripper);
  read_fields(map, cup.line);
  check_line(value, cup.line);
  cup.cup = scenario_.cup;
  for (std::int64_t row = 0; row < rows; ++row) {
    for (std::int64_t column = 0; column < columns; ++column) {
      cup.name = fmt::format("{}.{}", column + 1, row + 1);
      cup.p_EC = Vector3(pitch.x() * (static_cast<double>(column) - 0.5 * static_cast<double>(columns - 1)),
                         pitch.y() * (static_cast<double>(row) - 0.5 * static_cast<double>(rows - 1)), 0.0);
      gripper.cups.push_back(cup);
    }
  }
}

}  // namespace snug::model::internal
