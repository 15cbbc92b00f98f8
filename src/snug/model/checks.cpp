// Checks of a scenario's parts against each other: what overlaps, what does not fit, which materials can meet.
#include <algorithm>
#include <cmath>
#include <map>

#include "snug/geometry/bounds.hpp"
#include "snug/geometry/manifold.hpp"
#include "snug/model/internal/overlap.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/spin.hpp"

namespace snug::model::internal {
namespace {

/// Static things may touch; more than this is an overlap (poses written with six decimals stay below), m.
constexpr double kStaticOverlap = 1e-6;
/// Bodies that move may start this deep in something, m; the contact solver pushes them out.
constexpr double kStartOverlap = 1e-3;
/// A cell has some hundred; so many take a second.
constexpr std::size_t kMostNearPairs = 100'000;

std::array<double, 3> sorted(const Vector3& size) {
  std::array<double, 3> edges{size.x(), size.y(), size.z()};
  std::sort(edges.begin(), edges.end());
  return edges;
}

std::string to_millimetres(const Vector3& size) {
  return to_text(1e3 * size.x()) + " x " + to_text(1e3 * size.y()) + " x " + to_text(1e3 * size.z()) + " mm";
}

}  // namespace

double overlap_of(const PlacedShape& a, const Pose& X_WA, const PlacedShape& b, const Pose& X_WB) {
  const Pose X_WG = X_WA * a.X_BG;
  const Pose X_WH = X_WB * b.X_BG;
  if (!geometry::bounds(a.shape, X_WG).overlaps(geometry::bounds(b.shape, X_WH))) return 0.0;
  geometry::PairCache cache;
  geometry::Manifold manifold;
  geometry::collide(a.shape, X_WG, b.shape, X_WH, 0.0, cache, manifold);
  double depth = 0.0;
  for (int i = 0; i < manifold.count; ++i) depth = std::max(depth, -manifold.points[static_cast<std::size_t>(i)].phi);
  return depth;
}

struct ScenarioReader::Placed {
  std::string name;
  Value value;
  std::vector<PlacedShape> shapes;
  Pose X_WB;
  BodyKind kind;
  bool is_there_at_start;
  MaterialId material;
};

std::vector<ScenarioReader::Placed> ScenarioReader::placed_solids() const {
  std::vector<Placed> solids;
  for (std::size_t i = 0; i < scenario_.containers.size(); ++i) {
    const Container& container = scenario_.containers[i];
    solids.push_back({container.name, container_values_[i], make_walls(container), container.X_WT, BodyKind::Static,
                      true, container.material});
  }
  for (std::size_t i = 0; i < scenario_.bodies.size(); ++i) {
    const Body& body = scenario_.bodies[i];
    solids.push_back(
        {body.name, body_values_[i], body.shapes, body.X_WB, body.kind, body.appears_at == 0.0, body.material});
  }
  if (scenario_.aligner && !scenario_.aligner->plates.empty())
    solids.push_back({"aligner", *aligner_value_, scenario_.aligner->plates, scenario_.aligner->X_WA, BodyKind::Static,
                      true, scenario_.aligner->material});
  return solids;
}

/// How deep the weight of all that moves presses the contact of two solids, m; 0 when it is rigid.
double ScenarioReader::compliant_depth(const Placed& a, const Placed& b) const {
  const auto contact = find_contact(scenario_, a.material, b.material);
  if (!contact || !contact->stiffness) return 0.0;
  double mass = 0.0;
  for (const Body& body : scenario_.bodies)
    if (body.kind == BodyKind::Dynamic) mass += body.inertia.mass;
  constexpr double kRounded = 1.01;  // depths are written with a few digits
  return kRounded * mass * scenario_.gravity.norm() / *contact->stiffness;
}

void ScenarioReader::check_overlaps() const {
  const std::vector<Placed> solids = placed_solids();
  // Thousands of bodies have millions of pairs: only those whose boxes around them overlap are looked at.
  std::vector<std::vector<geometry::Aabb>> boxes;
  for (const Placed& solid : solids) {
    boxes.emplace_back();
    for (const PlacedShape& shape : solid.shapes)
      boxes.back().push_back(geometry::bounds(shape.shape, solid.X_WB * shape.X_BG));
  }
  std::size_t near_pairs = 0;
  for (std::size_t j = 1; j < solids.size(); ++j) {
    for (std::size_t i = 0; i < j; ++i) {
      const Placed& a = solids[i];
      const Placed& b = solids[j];
      const bool are_static = a.kind == BodyKind::Static && b.kind == BodyKind::Static;
      const bool is_one_dynamic = a.kind == BodyKind::Dynamic || b.kind == BodyKind::Dynamic;
      if (!(are_static || is_one_dynamic) || !a.is_there_at_start || !b.is_there_at_start) continue;
      double depth = 0.0;
      for (std::size_t m = 0; m < a.shapes.size(); ++m) {
        for (std::size_t n = 0; n < b.shapes.size(); ++n) {
          if (!boxes[i][m].overlaps(boxes[j][n])) continue;
          if (++near_pairs > kMostNearPairs)
            b.value.fail("more than " + std::to_string(kMostNearPairs) + " pairs of shapes close to each other",
                         "fewer");
          depth = std::max(depth, overlap_of(a.shapes[m], a.X_WB, b.shapes[n], b.X_WB));
        }
      }
      const double weight_depth = are_static ? 0.0 : compliant_depth(a, b);
      if (depth <= (are_static ? kStaticOverlap : std::max(kStartOverlap, weight_depth))) continue;
      const std::string got =
          quote(b.name) + " overlaps " + quote(a.name) + " by " + to_text(std::round(depth * 1e7) / 1e4) + " mm";
      std::string expected = "bodies that start no deeper than 1 mm in another";
      if (weight_depth > kStartOverlap)
        expected = "bodies that start no deeper than all weight presses a compliant contact, " +
                   to_text(std::round(weight_depth * 1e7) / 1e4) + " mm";
      b.value.fail(got, are_static ? "static bodies that touch at most" : expected);
    }
  }
}

void ScenarioReader::check_parcel_fits(const Value& value, const Parcel& parcel) const {
  const Container* target = find_container(scenario_, scenario_.target);
  if (target == nullptr || !target->holds_all) return;
  const auto box = sorted(collision_size(scenario_, parcel));
  const auto room = sorted(target->inner_size);
  for (std::size_t i = 0; i < 3; ++i)
    if (box[i] > room[i])
      value.fail("parcel " + quote(parcel.id) + " of " + to_millimetres(parcel.size),
                 "a box that fits into container " + quote(target->name) + " of " + to_millimetres(target->inner_size) +
                     " in some orientation");
}

void ScenarioReader::check_drops_fit(const Value& value, const Drops& drops) const {
  const Vector3& room = find_container(scenario_, drops.container)->inner_size;
  for (const std::string& name : drops.types) {
    const Vector3& size = find_parcel_type(scenario_, name)->size;
    const bool fits = (size.x() <= room.x() && size.y() <= room.y()) || (size.y() <= room.x() && size.x() <= room.y());
    if (!fits)
      value.fail("parcel type " + quote(name) + " of " + to_millimetres(size),
                 "types whose upright footprint fits into the container of " + to_millimetres(room));
  }
}

void ScenarioReader::check_materials_meet(const Value& at) const {
  // How many things of each material can move, and which materials the others have.
  std::map<int, int> moving;
  std::set<int> fixed;
  if (!scenario_.sequences.empty())
    for (const Parcel& parcel : scenario_.parcels) ++moving[parcel.material.index];
  if (scenario_.drops) moving[scenario_.drops->material.index] += scenario_.drops->count;
  for (const Body& body : scenario_.bodies) {
    if (body.kind == BodyKind::Dynamic)
      ++moving[body.material.index];
    else
      fixed.insert(body.material.index);
  }
  for (const Container& container : scenario_.containers) fixed.insert(container.material.index);
  if (scenario_.aligner && !scenario_.aligner->plates.empty()) fixed.insert(scenario_.aligner->material.index);
  if (scenario_.tool && !scenario_.tool->rod_shapes.empty()) fixed.insert(scenario_.tool->rod_material.index);
  if (scenario_.tool && !scenario_.tool->cup_shapes.empty()) fixed.insert(scenario_.tool->cup_material.index);

  const auto require_pair = [&](int a, int b) {
    if (find_contact(scenario_, {a}, {b})) return;
    at.fail("nothing for " + quote(scenario_.materials[static_cast<std::size_t>(a)].name) + " on " +
                quote(scenario_.materials[static_cast<std::size_t>(b)].name) + ", which can meet",
            "a pair between them, or a default");
  };
  for (const auto& [a, count] : moving) {
    for (const int b : fixed) require_pair(a, b);
    for (const auto& [b, other_count] : moving)
      if (a != b || count > 1) require_pair(a, b);
  }
}

void ScenarioReader::check_spins() const {
  const Body* const fast = find_too_fast_spin(scenario_);
  if (fast == nullptr) return;
  body_values_[static_cast<std::size_t>(fast - scenario_.bodies.data())].fail(
      "a spin of " + to_text(fast->V_WB.angular.norm()) + " rad/s",
      "less than half a turn in a time step of " + to_text(scenario_.time_step) + " s");
}

void ScenarioReader::read() {
  const MapReader map =
      root_.map("scenario", {"name",          "gravity",     "time_step",  "duration",   "seed",
                             "solver",        "materials",   "contacts",   "frames",     "parcel_clearance",
                             "parcel_types",  "parcels",     "containers", "target",     "bodies",
                             "aligner",       "tool",        "cup",        "controller", "sequences",
                             "springs",       "drops",       "robot",      "wrenches",   "record_period",
                             "initial_state", "uncertainty", "cameras",    "skills",     "packing",
                             "place_limits",  "rehearsal",   "belief",     "recovery",   "motion_guards",
                             "gripper"});
  const auto each = [&map](const char* key, auto&& read_one) {
    if (const auto values = map.find(key))
      for (const Value& value : values->list()) read_one(value);
  };
  read_settings(map);
  read_materials(map);
  if (const auto contacts = map.find("contacts")) read_contacts(*contacts);
  if (const auto frames = map.find("frames")) read_frames(*frames);
  each("parcel_types", [this](const Value& value) { read_parcel_type(value); });
  each("parcels", [this](const Value& value) { read_parcel(value); });
  read_containers(map);
  each("bodies", [this](const Value& value) { read_body(value); });
  if (const auto aligner = map.find("aligner")) read_aligner(*aligner);
  if (const auto tool = map.find("tool")) read_tool(*tool);
  if (const auto cup = map.find("cup")) read_cup(*cup, scenario_.cup);
  if (const auto gripper = map.find("gripper")) read_gripper(*gripper);
  each("cameras", [this](const Value& value) { read_camera(value); });
  if (const auto controller = map.find("controller")) read_controller(*controller);
  if (const auto robot = map.find("robot")) read_robot(*robot);
  each("sequences", [this](const Value& value) { read_sequence(value); });
  if (const auto uncertainty = map.find("uncertainty")) read_uncertainty(*uncertainty);
  read_session_settings(map);
  each("springs", [this](const Value& value) { read_spring(value); });
  each("wrenches", [this](const Value& value) { read_wrench(value); });
  if (const auto drops = map.find("drops")) read_drops(*drops);

  for (std::size_t i = 0; i < scenario_.parcels.size(); ++i) check_parcel_fits(parcel_values_[i], scenario_.parcels[i]);
  if (scenario_.drops) check_drops_fit(*drops_value_, *scenario_.drops);
  const auto contacts = map.find("contacts");
  check_materials_meet(contacts ? *contacts : map.require("materials"));
  check_overlaps();
  check_spins();
}

void ScenarioReader::read_items() {
  const MapReader map = root_.map("items", {"parcel_types", "parcels", "sequences"});
  const std::size_t known = scenario_.parcels.size();
  const auto each = [&map](const char* key, auto&& read_one) {
    if (const auto values = map.find(key))
      for (const Value& value : values->list()) read_one(value);
  };
  each("parcel_types", [this](const Value& value) { read_parcel_type(value); });
  each("parcels", [this](const Value& value) { read_parcel(value); });
  each("sequences", [this](const Value& value) { read_sequence(value); });
  for (std::size_t i = known; i < scenario_.parcels.size(); ++i)
    check_parcel_fits(parcel_values_[i - known], scenario_.parcels[i]);
}

}  // namespace snug::model::internal
