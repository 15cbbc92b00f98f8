// Reading the scene: settings, materials, frames, containers, bodies, springs and drops.
#include <cmath>

#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/internal/side_file.hpp"
#include "snug/model/mass_properties.hpp"

namespace snug::model::internal {
namespace {

/// Speeds beyond these are slips.
constexpr double kLargestSpeed = 1000.0;  // m/s and rad/s
constexpr double kLatestStart = 1e6;      // s

std::string name_of(const Material& material) { return material.name; }

Vector3 read_speed(const Value& value, const std::string& unit) {
  Vector3 v = Vector3::Zero();
  int i = 0;
  for (const Value& part : value.list_of(3, "speeds in " + unit))
    v(i++) = part.number_within(-kLargestSpeed, kLargestSpeed, "a speed in " + unit);
  return v;
}

Twist read_twist(const std::optional<Value>& value) {
  Twist V;
  if (!value) return V;
  const MapReader map = value->map("twist", {"linear", "angular"});
  if (const auto linear = map.find("linear")) V.linear = read_speed(*linear, "m/s");
  if (const auto angular = map.find("angular")) V.angular = read_speed(*angular, "rad/s");
  return V;
}

double read_time(const Value& value) { return value.number_within(0.0, kLatestStart, "a time in seconds"); }

double read_duration(const Value& value) { return value.number_within(1e-6, kLatestStart, "a duration in seconds"); }

HolderMove read_swing(const Value& value, double start, double duration) {
  const MapReader map = value.map("swing", {"point", "axis", "angle_deg"});
  SwingMove move{start, duration, map.require("point").position(), map.require("axis").vector3(),
                 map.require("angle_deg").radians_from_degrees()};
  const double length = move.axis_W.norm();
  if (!(length > 1e-6)) map.require("axis").fail("an axis of length " + to_text(length), "a direction");
  move.axis_W /= length;
  return move;
}

double end_of(const HolderMove& move) {
  return std::visit([](const auto& m) { return m.start + m.duration; }, move);
}

/// A pair gives way only with a stiffness, and what says how comes complete.
void check_softness(const MapReader& map, const ContactParams& params) {
  if (params.damping && !params.stiffness)
    map.require("damping").fail("damping without stiffness", "a stiffness too: a rigid contact has no damping");
  for (const char* key : {"travel", "full_area", "damping_ratio"})
    if (map.has(key) && !params.stiffness)
      map.require(key).fail(std::string(key) + " without stiffness",
                            "a stiffness too: a rigid contact does not give way");
  if (params.travel.has_value() != params.stiffness_beyond.has_value())
    map.require(params.travel ? "travel" : "stiffness_beyond")
        .fail("one of travel and stiffness_beyond",
              "both, or neither: how far a contact is soft and how stiff it is then");
  if (params.stiffness_beyond && *params.stiffness_beyond < *params.stiffness)
    map.require("stiffness_beyond")
        .fail("less than the stiffness before", "at least the stiffness: what is pressed gets stiffer");
  if (params.edge_share && !params.full_area)
    map.require("edge_share").fail("edge_share without full_area", "a full_area too: below it faces give way more");
  if (params.edge_share && *params.edge_share > 1.0)
    map.require("edge_share")
        .fail("a fraction of " + to_text(*params.edge_share), "a fraction of the stiffness, above 0, at most 1");
}

}  // namespace

void ScenarioReader::read_settings(const MapReader& map) {
  if (const auto name = map.find("name")) scenario_.name = name->name();
  if (const auto gravity = map.find("gravity")) {
    scenario_.gravity = gravity->vector3();
    if (!(scenario_.gravity.norm() <= 1000.0)) gravity->fail("an acceleration in m/s^2 no larger than 1000");
  }
  if (const auto step = map.find("time_step"))
    scenario_.time_step = step->number_within(1e-6, 0.1, "a time step in seconds");
  if (const auto duration = map.find("duration")) scenario_.duration = read_duration(*duration);
  if (const auto seed = map.find("seed"))
    scenario_.seed = static_cast<std::uint64_t>(seed->integer(0, 9'000'000'000'000'000));
  if (const auto period = map.find("record_period"))
    scenario_.record_period = period->number_within(1e-6, 1e4, "a time between frames in seconds");
  if (const auto state = map.find("initial_state")) read_initial_state(*state);
  if (const auto solver = map.find("solver")) read_fields(*solver, "solver", scenario_.solver);
  if (const auto clearance = map.find("parcel_clearance"))
    scenario_.parcel_clearance = clearance->number_within(0.0, 0.05, "a clearance in metres");
}

void ScenarioReader::read_initial_state(const Value& value) {
  const MapReader map = value.map("initial_state", {"recording", "time"});
  InitialState state{beside_scenario(map.require("recording")), std::nullopt};
  if (const auto time = map.find("time")) state.time = read_time(*time);
  scenario_.initial_state = state;
}

void ScenarioReader::read_materials(const MapReader& map) {
  for (const Value& value : map.require("materials").list()) {
    const MapReader entry = value.map("material", {"name", "density"});
    const Value name = entry.require("name");
    const std::vector<std::string> names = names_of(scenario_.materials, name_of);
    check_new_name(name, "material", std::find(names.begin(), names.end(), name.name()) != names.end());
    Material material{name.name(), std::nullopt};
    if (const auto density = entry.find("density"))
      material.density = density->number_within(0.1, 30000.0, "a density in kg/m^3");
    scenario_.materials.push_back(material);
  }
}

MaterialId ScenarioReader::read_material(const Value& value) const {
  const std::string name = value.name();
  for (std::size_t i = 0; i < scenario_.materials.size(); ++i)
    if (scenario_.materials[i].name == name) return {static_cast<int>(i)};
  fail_unknown_name(value, "material", names_of(scenario_.materials, name_of));
}

void ScenarioReader::read_contacts(const Value& value) {
  const auto read_params = [](const MapReader& map) {
    ContactParams params;
    (void)map.require("friction");
    (void)map.require("restitution");
    read_fields(map, params);
    check_softness(map, params);
    if (const auto bearing = map.find("bearing"))
      params.bearing = static_cast<Bearing>(bearing->choice({"corners", "edges", "face"}));
    return params;
  };
  const MapReader map = value.map("contacts", {"pairs", "default"});
  if (const auto fallback = map.find("default"))
    scenario_.default_contact = read_params(fallback->map("default", keys_with<ContactParams>({"bearing"})));
  const auto pairs = map.find("pairs");
  if (!pairs) return;
  for (const Value& entry : pairs->list()) {
    const MapReader pair = entry.map("pair", keys_with<ContactParams>({"between", "bearing"}));
    const std::vector<Value> names = pair.require("between").list_of(2, "material names");
    const MaterialId a = read_material(names[0]);
    const MaterialId b = read_material(names[1]);
    for (const ContactPair& known : scenario_.contact_pairs)
      if ((known.a == a && known.b == b) || (known.a == b && known.b == a))
        pair.require("between").fail("the pair " + names[0].name() + ", " + names[1].name() + " a second time",
                                     "each pair once, in either order");
    scenario_.contact_pairs.push_back({a, b, read_params(pair)});
  }
}

void ScenarioReader::read_frames(const Value& value) {
  for (const Value& entry : value.list()) {
    const MapReader map = entry.map("frame", {"name", "pose"});
    const Value name = map.require("name");
    const std::vector<std::string> names = names_of(scenario_.frames, [](const Frame& f) { return f.name; });
    check_new_name(name, "frame", std::find(names.begin(), names.end(), name.name()) != names.end());
    scenario_.frames.push_back({name.name(), read_world_pose(map.find("pose"))});
  }
}

void ScenarioReader::read_containers(const MapReader& map) {
  const auto values = map.find("containers");
  if (values) container_values_ = values->list();
  for (const Value& value : container_values_) {
    const MapReader entry = value.map("container", {"name", "pose", "inner_size", "wall_thickness", "floor_thickness",
                                                    "material", "walls", "holds_all"});
    const Value name = entry.require("name");
    check_new_name(name, "container", find_container(scenario_, name.name()) != nullptr);
    Container container;
    container.name = name.name();
    container.X_WT = read_world_pose(entry.find("pose"));
    container.inner_size = entry.require("inner_size").sizes();
    if (const auto wall = entry.find("wall_thickness")) container.wall_thickness = wall->size();
    if (const auto floor = entry.find("floor_thickness")) container.floor_thickness = floor->size();
    container.material = read_material(entry.require("material"));
    if (const auto walls = entry.find("walls")) container.has_walls = walls->boolean();
    if (const auto holds_all = entry.find("holds_all")) container.holds_all = holds_all->boolean();
    scenario_.containers.push_back(container);
  }
  const auto target = map.find("target");
  if (target) {
    scenario_.target = target->name();
    if (find_container(scenario_, scenario_.target) == nullptr)
      fail_unknown_name(*target, "container",
                        names_of(scenario_.containers, [](const Container& c) { return c.name; }));
  } else if (scenario_.containers.size() == 1) {
    scenario_.target = scenario_.containers.front().name;
  } else if (scenario_.containers.size() > 1) {
    (void)map.require("target");
  }
}

void ScenarioReader::read_body(const Value& value) {
  const MapReader map =
      value.map("body", {"name", "kind", "parcel", "size", "shapes", "material", "pose", "twist", "mass", "inertia",
                         "com", "appears_at", "surface_velocity", "path", "asleep"});
  Body body;
  const Value name = map.require("name");
  check_new_name(name, "body or container",
                 find_body(scenario_, name.name()) != nullptr || find_container(scenario_, name.name()) != nullptr);
  body.name = name.name();
  const auto kind = map.find("kind");
  body.kind = kind ? static_cast<BodyKind>(kind->choice({"dynamic", "static", "kinematic"})) : BodyKind::Dynamic;
  const std::string form = map.require_one_of({"parcel", "size", "shapes"});
  const Parcel* parcel = nullptr;
  if (form == "parcel") {
    body.parcel = map.require(form).name();
    parcel = find_parcel(scenario_, body.parcel);
    if (parcel == nullptr)
      fail_unknown_name(map.require(form), "parcel", names_of(scenario_.parcels, [](const Parcel& p) { return p.id; }));
    body.shapes = {{geometry::Box{0.5 * collision_size(scenario_, *parcel)}, {}}};
  }
  if (form == "size") body.shapes = {{geometry::Box{0.5 * map.require(form).sizes()}, {}}};
  if (form == "shapes") body.shapes = read_shapes(map.require(form));
  const auto material = map.find("material");
  body.material = parcel != nullptr && !material ? parcel->material : read_material(map.require("material"));
  read_motion(map, body);
  read_body_inertia(map, parcel, body);
  scenario_.bodies.push_back(body);
  body_values_.push_back(value);
}

PosePath ScenarioReader::read_path(const Value& value) const {
  const MapReader map = value.map("path", {"file", "frame"});
  const auto frame = map.find("frame");
  return load_pose_path(find_side_file(map.require("file"), "a table of poses (CSV)"),
                        frame ? read_frame_name(*frame) : Pose{});
}

void ScenarioReader::read_motion(const MapReader& map, Body& body) const {
  if (const auto at = map.find("appears_at")) body.appears_at = read_time(*at);
  if (const auto path = map.find("path")) {
    if (body.kind != BodyKind::Kinematic) path->fail("a path", "none: only kinematic bodies follow one");
    map.forbid_together("path", "pose");
    map.forbid_together("path", "twist");
    body.path = read_path(*path);
  }
  body.X_WB = body.path ? pose_at(*body.path, body.appears_at) : read_world_pose(map.find("pose"));
  body.V_WB = read_twist(map.find("twist"));
  if (const auto twist = map.find("twist"); twist && body.kind == BodyKind::Static)
    twist->fail("a twist", "none: a static body never moves; kind kinematic has one");
  if (const auto velocity = map.find("surface_velocity")) body.surface_velocity = read_speed(*velocity, "m/s");
  const auto asleep = map.find("asleep");
  body.is_asleep = asleep && asleep->boolean();
  if (!body.is_asleep) return;
  if (body.kind != BodyKind::Dynamic) asleep->fail("a body that does not move by forces", "none: dynamic bodies sleep");
  map.forbid_together("asleep", "twist");
  map.forbid_together("asleep", "appears_at");
}

void ScenarioReader::read_body_inertia(const MapReader& map, const Parcel* parcel, Body& body) const {
  for (const char* key : {"mass", "inertia", "com"}) {
    const auto value = map.find(key);
    if (value && parcel != nullptr) value->fail("both 'parcel' and '" + std::string(key) + "'", "one of the two");
    if (value && body.kind != BodyKind::Dynamic)
      value->fail("a " + std::string(key), "none: only dynamic bodies have inertia");
  }
  if (parcel != nullptr) {
    body.inertia = parcel->inertia;
    return;
  }
  if (body.kind != BodyKind::Dynamic) return;
  body.inertia = uniform_inertia(body.shapes, map.require("mass").mass());
  if (const auto com = map.find("com")) body.inertia.com = com->position();
  if (const auto inertia = map.find("inertia")) body.inertia.inertia = read_inertia(*inertia);
  if (!body.inertia.inertia.allFinite() || !(body.inertia.inertia.diagonal().minCoeff() > 0.0))
    map.self().fail("shapes and mass whose inertia is not positive", "shapes with a volume, or an inertia");
}

const Body& ScenarioReader::find_dynamic_body(const Value& value) const {
  const Body* body = find_body(scenario_, value.name());
  if (body == nullptr)
    fail_unknown_name(value, "body", names_of(scenario_.bodies, [](const Body& b) { return b.name; }));
  if (body->kind != BodyKind::Dynamic) value.fail("a dynamic body");
  return *body;
}

void ScenarioReader::read_wrench(const Value& value) {
  const MapReader map = value.map("wrench", {"body", "force", "torque", "frame", "point", "start", "end"});
  AppliedWrench wrench;
  wrench.body = find_dynamic_body(map.require("body")).name;
  if (!map.has("force") && !map.has("torque")) (void)map.require("force");
  if (const auto force = map.find("force")) wrench.force = force->vector3();
  if (const auto torque = map.find("torque")) wrench.torque = torque->vector3();
  if (const auto frame = map.find("frame")) wrench.is_in_body = frame->choice({"world", "body"}) == 1;
  if (const auto point = map.find("point")) wrench.p_BQ = point->position();
  if (const auto start = map.find("start")) wrench.start = read_time(*start);
  if (const auto end = map.find("end")) {
    wrench.end = read_time(*end);
    if (!(wrench.end > wrench.start)) end->fail("a time after the start, " + to_text(wrench.start) + " s");
  }
  scenario_.wrenches.push_back(wrench);
}

void ScenarioReader::read_spring(const Value& value) {
  const MapReader map = value.map("spring", {"name", "body", "attachment", "stiffness", "damping", "holder", "moves"});
  Spring spring;
  const Value name = map.require("name");
  for (const Spring& known : scenario_.springs) check_new_name(name, "spring", known.name == name.name());
  spring.name = name.name();
  const Body& body = find_dynamic_body(map.require("body"));
  spring.body = body.name;
  spring.X_BS = read_local_pose(map.find("attachment"));
  read_fields(map.require("stiffness"), "stiffness", spring.stiffness);
  if (const auto damping = map.find("damping")) read_fields(*damping, "damping", spring.damping);
  const auto holder = map.find("holder");
  spring.X_WH = holder ? read_world_pose(holder) : body.X_WB * spring.X_BS;
  if (const auto moves = map.find("moves")) {
    for (const Value& entry : moves->list()) {
      const MapReader move = entry.map("move", {"start", "duration", "to", "swing"});
      const double start = read_time(move.require("start"));
      const double duration = read_duration(move.require("duration"));
      if (!spring.moves.empty() && start < end_of(spring.moves.back()) - 1e-9)
        move.require("start").fail("a time not before the end of the move before");
      if (move.require_one_of({"to", "swing"}) == "to")
        spring.moves.emplace_back(StraightMove{start, duration, read_world_pose(move.find("to"))});
      else
        spring.moves.push_back(read_swing(move.require("swing"), start, duration));
    }
  }
  scenario_.springs.push_back(spring);
}

void ScenarioReader::read_drops(const Value& value) {
  const MapReader map =
      value.map("drops", {"container", "types", "count", "start", "interval", "clearance", "seed", "material"});
  Drops drops;
  const Value container = map.require("container");
  drops.container = container.name();
  if (find_container(scenario_, drops.container) == nullptr)
    fail_unknown_name(container, "container",
                      names_of(scenario_.containers, [](const Container& c) { return c.name; }));
  for (const Value& type : map.require("types").list()) {
    if (find_parcel_type(scenario_, type.name()) == nullptr)
      fail_unknown_name(type, "parcel type",
                        names_of(scenario_.parcel_types, [](const ParcelType& t) { return t.name; }));
    drops.types.push_back(type.name());
  }
  if (drops.types.empty()) map.require("types").fail("at least one parcel type");
  drops.count = static_cast<int>(map.require("count").integer(1, 100000));
  if (const auto start = map.find("start")) drops.start = read_time(*start);
  if (const auto interval = map.find("interval")) drops.interval = read_duration(*interval);
  if (const auto clearance = map.find("clearance"))
    drops.clearance = clearance->number_within(0.0, kLargestSize, "a height in metres");
  drops.seed = scenario_.seed;
  if (const auto seed = map.find("seed"))
    drops.seed = static_cast<std::uint64_t>(seed->integer(0, 9'000'000'000'000'000));
  drops.material = read_material(map.require("material"));
  scenario_.drops = drops;
  drops_value_ = value;
}

}  // namespace snug::model::internal
