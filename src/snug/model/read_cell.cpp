// Reading the robot cell: parcels, aligner, tool, cup, controller and sequences.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "snug/model/internal/fields.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/mass_properties.hpp"

namespace snug::model::internal {
namespace {

void check_inside(const Value& at, const Vector3& size, const Vector3& point, const std::string& what) {
  if (((point.cwiseAbs() - 0.5 * size).array() > 1e-9).any())
    at.fail(what + " inside the box, from its middle, in metres");
}

Layer read_layer(const Value& value, const Scenario& scenario, const Vector3& box_size) {
  const MapReader map = value.map("layer", {"material", "density", "size", "z"});
  Layer layer;
  if (map.require_one_of({"material", "density"}) == "density") {
    layer.density = map.require("density").number_within(0.1, 30000.0, "a density in kg/m^3");
  } else {
    const Value name = map.require("material");
    const std::vector<Material>& all = scenario.materials;
    const auto found = std::find_if(all.begin(), all.end(), [&](const Material& m) { return m.name == name.name(); });
    if (found == all.end())
      fail_unknown_name(name, "material", names_of(all, [](const Material& m) { return m.name; }));
    if (!found->density) name.fail("a material with a density (key 'density' in materials), or density here");
    layer.density = *found->density;
  }
  layer.size = map.require("size").sizes();
  layer.centre.z() = map.require("z").number_within(-kLargestSize, kLargestSize, "a height in metres");
  const Vector3 farthest = layer.centre.cwiseAbs() + 0.5 * layer.size;
  if (((farthest - 0.5 * box_size).array() > 1e-9).any())
    value.fail("a layer that sticks out of the box", "size and z that lie inside the box");
  return layer;
}

Shell read_shell(const MapReader& map, const Vector3& size, double layers_mass, const std::optional<double>& total) {
  Shell shell;
  shell.thickness = map.require("thickness").size();
  if (!(2.0 * shell.thickness < size.minCoeff())) map.require("thickness").fail("less than half the smallest edge");
  const auto mass = map.find("mass");
  if (mass && total) mass->fail("a mass for the shell and for the box", "one of the two");
  if (mass)
    shell.mass = mass->mass();
  else if (total)
    shell.mass = *total - layers_mass;
  else
    (void)map.require("mass");
  if (!(shell.mass > 0.0))
    map.self().fail("layers of " + to_text(layers_mass) + " kg in a box of " + to_text(total.value_or(0.0)) + " kg",
                    "layers lighter than the box");
  return shell;
}

void check_elasticity(const Value& at, const CupElasticity& e, const std::string& what, bool may_be_zero) {
  const bool is_positive = e.lateral > 0.0 && e.axial > 0.0 && e.bend > 0.0 && e.torsion > 0.0;
  const double room = e.lateral * e.bend - e.coupling * e.coupling;
  if ((may_be_zero || is_positive) && (room > 0.0 || (may_be_zero && room >= 0.0))) return;
  at.fail("lateral " + to_text(e.lateral) + ", axial " + to_text(e.axial) + ", bend " + to_text(e.bend) + ", torsion " +
              to_text(e.torsion) + ", coupling " + to_text(e.coupling),
          may_be_zero ? what + " with lateral * bend >= coupling^2" : what + " > 0 with lateral * bend > coupling^2");
}

/// Sets the stiffness that planning uses. Refuses a law whose energy has no lower bound. lateral * bend < coupling^2 is
/// fine where the cup is compressed: bellows that are pressed may buckle.
void check_cup_law(const Value& at, const std::optional<Value>& stiffness, CupParams& cup) {
  const CupLaw& law = cup.law;
  if (!law.is_used()) at.fail("half_range " + to_text(law.half_range), "half_range in metres, above 0");
  if (std::max(law.half_range, std::abs(law.middle)) > 1.0)
    at.fail("half_range " + to_text(law.half_range) + ", middle " + to_text(law.middle), "metres, below 1");
  if (stiffness) stiffness->fail("stiffness beside law", "one of the two");
  constexpr int kSamples = 30;  // of the measured range, and as many up to where stiffnesses end beyond it
  for (int i = -2 * kSamples; i <= 2 * kSamples; ++i) {
    const double u = static_cast<double>(i) / kSamples, z = law.middle + u * law.half_range;
    const double lateral = law.lateral(z).value, bend = law.bend(z).value, torsion = law.torsion(z).value;
    if (!(lateral > 0.0 && bend > 0.0 && torsion > 0.0))
      at.fail("at u = " + to_text(u) + " lateral " + to_text(lateral) + ", bend " + to_text(bend) + ", torsion " +
                  to_text(torsion),
              "stiffness > 0 for u from -2 to 2");
  }
  for (const double u : {-1.0, 1.0}) {
    const double slope = law.axial(law.middle + u * law.half_range).curvature;
    if (!(slope > 0.0))
      at.fail("axial stiffness " + to_text(slope) + " N/m at u = " + to_text(u), "above 0 at both ends");
  }
  cup.stiffness = undeformed_stiffness(law);
}

}  // namespace

void ScenarioReader::read_parcel_type(const Value& value) {
  const MapReader map = value.map("parcel_type", {"name", "size", "mass"});
  const Value name = map.require("name");
  check_new_name(name, "parcel type", find_parcel_type(scenario_, name.name()) != nullptr);
  scenario_.parcel_types.push_back({name.name(), map.require("size").sizes(), map.require("mass").mass()});
}

void ScenarioReader::read_parcel(const Value& value) {
  const MapReader map = value.map("parcel", {"id", "type", "size", "mass", "inertia", "com", "layers", "shell",
                                             "material", "upright_only", "no_stack", "max_load"});
  Parcel parcel;
  const Value id = map.require("id");
  check_new_name(id, "parcel", find_parcel(scenario_, id.name()) != nullptr);
  parcel.id = id.name();
  // Waypoints are named after their box, and a comma ends a field of the program's file.
  if (parcel.id.find(',') != std::string::npos) id.fail("an id without commas: it stands in programs (CSV)");
  const Value type_name = map.require("type");
  const ParcelType* type = find_parcel_type(scenario_, type_name.name());
  if (type == nullptr)
    fail_unknown_name(type_name, "parcel type",
                      names_of(scenario_.parcel_types, [](const ParcelType& t) { return t.name; }));
  parcel.type = type->name;
  const auto size = map.find("size");
  parcel.size = size ? size->sizes() : type->size;
  if (!(parcel.size.minCoeff() - scenario_.parcel_clearance >= kSmallestSize))
    (size ? *size : value).fail("a size of " + to_text(parcel.size.minCoeff()), "edges larger than parcel_clearance");
  parcel.inertia = read_parcel_inertia(map, *type, parcel.size);
  parcel.material = read_material(map.require("material"));
  if (const auto flag = map.find("upright_only")) parcel.handling.upright_only = flag->boolean();
  if (const auto flag = map.find("no_stack")) parcel.handling.no_stack = flag->boolean();
  if (const auto load = map.find("max_load")) parcel.handling.max_load = load->number_within(0.0, 1e6, "a mass in kg");
  scenario_.parcels.push_back(parcel);
  parcel_values_.push_back(value);
}

SpatialInertia ScenarioReader::read_parcel_inertia(const MapReader& map, const ParcelType& type,
                                                   const Vector3& size) const {
  for (const char* key : {"inertia", "com"})
    for (const char* layered : {"layers", "shell"}) map.forbid_together(key, layered);
  std::optional<double> mass;
  if (const auto value = map.find("mass")) mass = value->mass();
  if (map.has("layers") || map.has("shell")) {
    std::vector<Layer> layers;
    double layers_mass = 0.0;
    if (const auto values = map.find("layers")) {
      for (const Value& value : values->list()) layers.push_back(read_layer(value, scenario_, size));
      if (layers.empty()) values->fail("at least one layer");
    }
    for (const Layer& layer : layers) layers_mass += layer.density * layer.size.prod();
    std::optional<Shell> shell;
    if (const auto value = map.find("shell"))
      shell = read_shell(value->map("shell", {"mass", "thickness"}), size, layers_mass, mass);
    else if (mass)
      map.require("mass").fail("a mass beside layers without a shell", "no mass, or a shell that makes up the rest");
    return compute_layered_inertia(size, shell, layers);
  }
  const double total = mass.value_or(type.mass);
  SpatialInertia result{total, Vector3::Zero(), cuboid_inertia(size, total)};
  if (const auto inertia = map.find("inertia")) result.inertia = read_inertia(*inertia);
  if (const auto com = map.find("com")) {
    result.com = com->position();
    check_inside(*com, size, result.com, "a centre of mass");
  }
  return result;
}

void ScenarioReader::read_aligner(const Value& value) {
  const MapReader map =
      value.map("aligner", {"pose", "support_height", "plates", "material", "yaw_rule", "heavy_side"});
  Aligner aligner;
  aligner.X_WA = read_world_pose(map.require("pose"));
  if (!(aligner.X_WA.R(2, 2) > 1.0 - 1e-9)) map.require("pose").fail("a tilted frame", "Az up: yaw only");
  aligner.support_height =
      map.require("support_height").number_within(-kFarthestPosition, kFarthestPosition, "a height in metres");
  if (const auto plates = map.find("plates")) {
    aligner.plates = read_shapes(*plates);
    aligner.material = read_material(map.require("material"));
  } else if (const auto material = map.find("material")) {
    aligner.material = read_material(*material);
  }
  if (const auto rule = map.find("yaw_rule"))
    aligner.yaw_rule = static_cast<YawRule>(rule->choice({"nearest_pick", "zero"}));
  if (const auto side = map.find("heavy_side"))
    aligner.heavy_side = static_cast<HeavySide>(side->choice({"corner", "away", "any"}));
  scenario_.aligner = aligner;
  aligner_value_ = value;
}

void ScenarioReader::read_uncertainty(const Value& value) {
  Uncertainty& uncertainty = scenario_.uncertainty;
  read_fields(value, "uncertainty", uncertainty);
  const double longest = std::max({uncertainty.size, uncertainty.com, uncertainty.clearance, uncertainty.position,
                                   uncertainty.aligner_position, uncertainty.cup_length});
  if (longest > 0.1) value.fail("a length of " + to_text(longest) + " m", "half widths in metres, at most 0.1");
  if (std::max(uncertainty.yaw, uncertainty.aligner_yaw) > 0.25 * std::numbers::pi)
    value.fail("an angle above 45 degrees", "half widths of at most 45 degrees");
}

void ScenarioReader::read_tool(const Value& value) {
  const MapReader map = value.map("tool", {"mass", "rod_shapes", "cup_shapes", "rod_material", "cup_material"});
  ToolParams tool;
  tool.mass = map.require("mass").mass();
  if (const auto rod = map.find("rod_shapes")) {
    tool.rod_shapes = read_shapes(*rod);
    tool.rod_material = read_material(map.require("rod_material"));
  }
  if (const auto cup = map.find("cup_shapes")) {
    tool.cup_shapes = read_shapes(*cup);
    tool.cup_material = read_material(map.require("cup_material"));
  }
  scenario_.tool = tool;
}

void ScenarioReader::read_cup(const Value& value, CupParams& cup) const {
  const MapReader map = value.map("cup", field_keys<CupParams>());
  read_fields(map, cup);
  if (const auto law = map.find("law")) check_cup_law(*law, map.find("stiffness"), cup);
  check_elasticity(value, cup.stiffness, "stiffness", false);
  check_elasticity(value, cup.damping, "damping", true);
  if (!(cup.hold_length <= cup.free_length))
    value.fail("hold_length " + to_text(cup.hold_length) + ", free_length " + to_text(cup.free_length),
               "hold_length <= free_length");
  if (!(cup.centre_from_lip <= cup.hold_length))
    value.fail("centre_from_lip " + to_text(cup.centre_from_lip), "no more than hold_length");
  for (const double length : {cup.free_length, cup.lip_radius, cup.effective_diameter})
    if (length > 1.0) value.fail("a length of " + to_text(length) + " m", "cup lengths in metres, below 1");
  const VacuumParams& vacuum = cup.vacuum;
  const bool is_ordered = -vacuum.ambient_pressure_abs < vacuum.pressure_gauge_hold &&
                          vacuum.pressure_gauge_hold <= vacuum.pressure_gauge_collapse &&
                          vacuum.pressure_gauge_collapse < 0.0;
  if (!is_ordered)
    value.fail("pressure_gauge_hold " + to_text(vacuum.pressure_gauge_hold) + ", pressure_gauge_collapse " +
                   to_text(vacuum.pressure_gauge_collapse),
               "-ambient_pressure_abs < hold <= collapse < 0 (vacuum is negative)");
  if (cup.release.growth > 1.0) value.fail("release.growth " + to_text(cup.release.growth) + " m", "metres, below 1");
  if (!(-vacuum.ambient_pressure_abs < cup.release.pressure_gauge_start && cup.release.pressure_gauge_start < 0.0))
    value.fail("release.pressure_gauge_start " + to_text(cup.release.pressure_gauge_start),
               "-ambient_pressure_abs < pressure_gauge_start < 0 (vacuum is negative)");
  const HoldLimits& limits = cup.limits;
  if (!(limits.warn_bend <= limits.fail_bend && limits.peel_onset <= limits.peel_full))
    value.fail("a first limit above the last", "warn_bend_deg <= fail_bend_deg and peel_onset <= peel_full");
}

void ScenarioReader::read_controller(const Value& value) {
  const MapReader map =
      value.map("controller", keys_with<ControllerParams>({"start_pose", "limits", "correction_layers"}));
  ControllerParams& controller = scenario_.controller;
  read_fields(map, controller);
  if (!(controller.tick >= scenario_.time_step)) map.require("tick").fail("a tick no shorter than time_step");
  if (!(controller.velocity_fraction > 0.0)) map.require("velocity_fraction").fail("0", "more than 0, at most 1");
  controller.X_WE_start = read_world_pose(map.find("start_pose"));
  if (const auto limits = map.find("limits")) {
    for (const Value& entry : limits->list()) {
      const MapReader row = entry.map("limit", keys_with<MoveLimits>({"prefix"}));
      MoveLimits limit;
      const Value prefix = row.require("prefix");
      limit.prefix = prefix.name_or_empty();
      for (const MoveLimits& known : controller.limits) check_new_name(prefix, "limit", known.prefix == limit.prefix);
      for (const std::string& key : field_keys<MoveLimits>()) (void)row.require(key);
      read_fields(row, limit);
      controller.limits.push_back(limit);
    }
  }
  const auto layers = map.find("correction_layers");
  if (!layers) return;
  for (const Value& entry : layers->list()) {
    const MapReader layer_map = entry.map("correction_layer", {"name", "cup", "corrections"});
    const Value name = layer_map.require("name");
    check_new_name(name, "correction layer", find_correction_layer(scenario_, name.name()) != nullptr);
    CorrectionLayer layer{name.name(), {}};
    if (const auto cup = layer_map.find("cup")) layer.with_phases = cup->choice({"holding", "phases"}) == 1;
    for (const Value& row_value : layer_map.require("corrections").list()) {
      const MapReader row = row_value.map("correction", {"prefixes", "offset"});
      Correction correction;
      for (const Value& prefix : row.require("prefixes").list()) correction.prefixes.push_back(prefix.name());
      if (correction.prefixes.empty()) row.require("prefixes").fail("at least one prefix");
      const Value offset = row.require("offset");
      correction.offset = offset.position();
      if (!(correction.offset.norm() <= 0.5)) offset.fail("an offset in metres no longer than 0.5");
      layer.corrections.push_back(correction);
    }
    controller.correction_layers.push_back(layer);
  }
}

Item ScenarioReader::read_item(const Value& value) const {
  const MapReader map = value.map("item", {"parcel", "up", "yaw_deg", "heavy_side"});
  Item item;
  const Value parcel = map.require("parcel");
  item.parcel = parcel.name();
  if (find_parcel(scenario_, item.parcel) == nullptr)
    fail_unknown_name(parcel, "parcel", names_of(scenario_.parcels, [](const Parcel& p) { return p.id; }));
  const std::size_t up = map.require("up").choice({"X", "Y", "Z", "-X", "-Y", "-Z"});
  item.up = static_cast<UpAxis>(up % 3);
  item.up_sign = up < 3 ? 1 : -1;
  if (const auto yaw = map.find("yaw_deg")) {
    const double quarters = yaw->number() / 90.0;
    if (std::abs(quarters) > 3.0 || quarters != std::round(quarters)) yaw->fail("0, 90, 180, 270 or their negatives");
    item.yaw = quarters * 0.5 * std::numbers::pi;
  }
  if (const auto side = map.find("heavy_side"))
    item.heavy_side = static_cast<HeavySide>(side->choice({"corner", "away", "any"}));
  return item;
}

void ScenarioReader::read_reported(const MapReader& map, Sequence& sequence) const {
  const auto read_count = [&](const Value& value) {
    return static_cast<int>(value.integer(0, static_cast<std::int64_t>(sequence.items.size())));
  };
  map.forbid_together("reported", "packed_count");
  map.forbid_together("reported", "reported_filling_percent");
  const auto count = map.find("packed_count"), percent = map.find("reported_filling_percent");
  if (count || percent) {
    Reported& one = sequence.reported.emplace_back();
    one.agent = "the report";
    if (count) one.packed_count = read_count(*count);
    if (percent) one.filling_percent = percent->number_within(0.0, 100.0, "a percentage");
  }
  const auto rows = map.find("reported");
  if (!rows) return;
  for (const Value& entry : rows->list()) {
    const MapReader row = entry.map("reported", {"agent", "packed_count", "filling_percent"});
    const Value agent = row.require("agent");
    Reported one;
    one.agent = agent.name();
    for (const Reported& known : sequence.reported) check_new_name(agent, "agent", known.agent == one.agent);
    if (const auto packed = row.find("packed_count")) one.packed_count = read_count(*packed);
    if (const auto filling = row.find("filling_percent"))
      one.filling_percent = filling->number_within(0.0, 100.0, "a percentage");
    if (!one.packed_count && !one.filling_percent)
      entry.fail("neither packed_count nor filling_percent", "at least one of them");
    sequence.reported.push_back(one);
  }
}

void ScenarioReader::read_sequence(const Value& value) {
  const MapReader map = value.map(
      "sequence", {"name", "items", "task_stiffness", "reported", "packed_count", "reported_filling_percent"});
  Sequence sequence;
  const Value name = map.require("name");
  check_new_name(name, "sequence", find_sequence(scenario_, name.name()) != nullptr);
  sequence.name = name.name();
  std::set<std::string> used;
  for (const Value& entry : map.require("items").list()) {
    sequence.items.push_back(read_item(entry));
    const std::string& id = sequence.items.back().parcel;
    if (!used.insert(id).second) entry.fail("parcel " + quote(id) + " a second time", "each parcel once in a sequence");
  }
  if (sequence.items.empty()) map.require("items").fail("at least one item");
  if (const auto stiffness = map.find("task_stiffness")) sequence.task_stiffness = stiffness->number(Range::Positive);
  read_reported(map, sequence);
  scenario_.sequences.push_back(sequence);
}

}  // namespace snug::model::internal
