// The header of the replay form: what ran, the bodies, what happened and what became of it.
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "snug/core/input_error.hpp"
#include "snug/geometry/convex_hull.hpp"
#include "snug/model/reported_agent.hpp"
#include "snug/model/scenario.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/replay/internal/recorded_scenario.hpp"
#include "snug/replay/internal/robot_look.hpp"
#include "snug/replay/limits.hpp"
#include "snug/replay/replay.hpp"
#include "snug/runs/result_json.hpp"

namespace snug::replay {
namespace {

using Json = nlohmann::ordered_json;

Json as_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json as_json(const record::PoseSample& X) {
  return {X.p.x(), X.p.y(), X.p.z(), X.quat.w(), X.quat.x(), X.quat.y(), X.quat.z()};
}

/// The text as JSON, or null: also when it is larger than any result, or so deep that taking it apart would need more
/// stack than there is.
Json parsed(const std::string& text) {
  constexpr std::size_t kLongestText = std::size_t{4} << 20U;
  constexpr int kDeepest = 32;
  if (text.size() > kLongestText) return {};
  bool is_too_deep = false;
  const auto look = [&](int depth, Json::parse_event_t, Json&) {
    is_too_deep = is_too_deep || depth > kDeepest;
    return !is_too_deep;
  };
  Json value = Json::parse(text, look, false);
  return value.is_discarded() || is_too_deep ? Json() : value;
}

Json hull_as_json(const std::vector<Vector3>& vertices, Json shape) {
  const auto hull = geometry::make_convex_hull(vertices);
  Json points = Json::array(), triangles = Json::array();
  for (const Vector3& vertex : hull ? hull->vertices : vertices) points.push_back(as_json(vertex));
  if (hull) {
    for (const std::vector<int>& face : hull->faces) {
      for (std::size_t i = 2; i < face.size(); ++i) triangles.push_back({face[0], face[i - 1], face[i]});
    }
  }
  shape["vertices"] = std::move(points);
  shape["triangles"] = std::move(triangles);
  return shape;
}

Json shape_as_json(const record::ShapeInfo& shape) {
  const Json pose = as_json(shape.X_BG);
  switch (shape.kind) {
    case record::ShapeKind::Box:
      return {{"kind", "box"}, {"pose", pose}, {"half", as_json(shape.half)}};
    case record::ShapeKind::Capsule:
      return {{"kind", "capsule"}, {"pose", pose}, {"radius", shape.radius}, {"half_length", shape.half_length}};
    case record::ShapeKind::Cylinder:
      return {{"kind", "cylinder"}, {"pose", pose}, {"radius", shape.radius}, {"half_length", shape.half_length}};
    case record::ShapeKind::Hull:
      break;
  }
  return hull_as_json(shape.vertices, {{"kind", "hull"}, {"pose", pose}});
}

Json shapes_as_json(const std::vector<record::ShapeInfo>& shapes) {
  Json list = Json::array();
  for (const record::ShapeInfo& shape : shapes) list.push_back(shape_as_json(shape));
  return list;
}

Json bodies_as_json(const record::RecordingHeader& header) {
  static constexpr const char* kKinds[] = {"static", "kinematic", "dynamic"};
  Json list = Json::array();
  for (const record::BodyInfo& body : header.bodies) {
    list.push_back({{"name", body.name},
                    {"type", body.type},
                    {"kind", kKinds[static_cast<std::size_t>(body.kind)]},
                    {"mass", body.mass},
                    {"com", as_json(body.com)},
                    {"shapes", shapes_as_json(body.shapes)}});
  }
  return list;
}

Json container_as_json(const record::ContainerInfo& container) {
  if (container.name.empty()) return nullptr;
  return {{"name", container.name},
          {"pose", {as_json(container.X_WT), as_json(container.X_TI)}},
          {"inner_size", as_json(container.inner_size)}};
}

/// The tool that `cell` puts into each recording of a program is a body of this name.
constexpr const char* kToolBody = "tool";

Json tool_as_json(const record::RecordingHeader& header) {
  const int body = record::find_body(header, kToolBody);
  if (body < 0 || header.bodies[static_cast<std::size_t>(body)].kind != record::BodyKind::Kinematic) return nullptr;
  return {{"body", body}, {"shapes", shapes_as_json(header.bodies[static_cast<std::size_t>(body)].shapes)}};
}

/// To a tenth of a millimetre: a page shows no more.
double rounded(double metres) { return std::round(metres * 1e4) / 1e4; }

Json mesh_as_json(const model::DrawnMesh& mesh, const Json& pose) {
  Json vertices = Json::array(), triangles = Json::array();
  for (const Vector3& v : mesh.vertices) vertices.push_back({rounded(v.x()), rounded(v.y()), rounded(v.z())});
  for (const auto& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
  return {{"kind", "mesh"}, {"pose", pose}, {"vertices", std::move(vertices)}, {"triangles", std::move(triangles)}};
}

Json visual_as_json(const robot::Visual& visual) {
  const Json pose = as_json(record::PoseSample(visual.X_LG));
  Json shape;
  if (const auto* box = std::get_if<geometry::Box>(&visual.shape)) {
    shape = {{"kind", "box"}, {"pose", pose}, {"half", as_json(box->half)}};
  } else if (const auto* capsule = std::get_if<geometry::Capsule>(&visual.shape)) {
    shape = {{"kind", "capsule"}, {"pose", pose}, {"radius", capsule->radius}, {"half_length", capsule->half_length}};
  } else if (const auto* cylinder = std::get_if<geometry::Cylinder>(&visual.shape)) {
    shape = {
        {"kind", "cylinder"}, {"pose", pose}, {"radius", cylinder->radius}, {"half_length", cylinder->half_length}};
  } else {
    shape = mesh_as_json(std::get<model::DrawnMesh>(visual.shape), pose);
  }
  return {{"colour", {visual.rgba[0], visual.rgba[1], visual.rgba[2]}}, {"shape", std::move(shape)}};
}

Json looks_as_json(const record::RecordingHeader& header, const RobotDescription& robot) {
  Json looks = Json::array();
  for (const internal::LinkLook& look : internal::find_looks(header, robot)) {
    Json parts = Json::array();
    for (const robot::Visual& visual : look.visuals) parts.push_back(visual_as_json(visual));
    looks.push_back({{"body", look.body}, {"parts", std::move(parts)}});
  }
  return looks;
}

Json limits_as_json(const record::RecordingHeader& header, const RobotDescription& robot) {
  const std::optional<JointUseLimits> limits = joint_limits_of(header, robot.urdf);
  if (!limits) return nullptr;
  return {{"speed", limits->speed}, {"acceleration", limits->acceleration}, {"torque", limits->torque}};
}

/// Links of a robot are kinematic bodies whose names begin with this.
constexpr const char* kLinkPrefix = "robot/";

Json robot_as_json(const record::RecordingHeader& header, const RobotDescription& robot) {
  Json links = Json::array();
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    const record::BodyInfo& body = header.bodies[i];
    if (body.kind != record::BodyKind::Dynamic && body.name.starts_with(kLinkPrefix)) links.push_back(i);
  }
  if (links.empty()) return nullptr;
  return {
      {"links", std::move(links)}, {"looks", looks_as_json(header, robot)}, {"limits", limits_as_json(header, robot)}};
}

Json frames_as_json(const std::optional<model::Scenario>& scenario) {
  Json list = Json::array({{{"name", "world"}, {"letter", "W"}, {"X_W", as_json(record::PoseSample())}}});
  if (!scenario) return list;
  for (const model::Frame& frame : scenario->frames) {
    const bool is_letter = frame.name.size() == 1;
    list.push_back({{"name", frame.name},
                    {"letter", is_letter ? frame.name : ""},
                    {"X_W", as_json(record::PoseSample(frame.X_WF))}});
  }
  return list;
}

Json program_as_json(const record::RecordingHeader& header) {
  Json names = Json::array();
  try {
    if (!header.program_text.empty()) {
      const motion::Program program = motion::parse_program(header.program_text, header.program_name);
      for (const motion::Waypoint& waypoint : program.waypoints) names.push_back(motion::name_of(waypoint));
    }
  } catch (const InputError&) {  // of another version of the format: the rows then have numbers only
  }
  return {{"name", header.program_name}, {"names", std::move(names)}};
}

Json speed_as_json(const std::optional<runs::RunResult>& result) {
  if (!result || (result->duration <= 0.0 && result->wall <= 0.0)) return nullptr;
  return {{"duration_s", result->duration}, {"wall_s", result->wall}, {"real_time_factor", result->real_time_factor}};
}

/// What others reached with the sequence, beside what the boxes of the first of them fill as snug counts.
Json reported_as_json(const std::optional<model::Scenario>& scenario, const std::string& sequence_name) {
  if (!scenario) return nullptr;
  const model::Sequence* sequence = model::find_sequence(*scenario, sequence_name);
  const model::Container* container = model::find_container(*scenario, scenario->target);
  if (sequence == nullptr || container == nullptr || sequence->reported.empty()) return nullptr;
  const model::Reported& first = sequence->reported.front();
  if (!first.filling_percent) return nullptr;
  Json agents = Json::array();
  for (const model::Reported& one : sequence->reported) {
    const auto [name, about] = model::split_agent(one.agent);
    if (one.filling_percent)
      agents.push_back({{"agent", name}, {"about", about}, {"filling_percent", *one.filling_percent}});
  }
  Json table = {{"filling_percent", *first.filling_percent},
                {"boxes", nullptr},
                {"same_boxes_percent", nullptr},
                {"agent", model::split_agent(first.agent).name},
                {"agents", std::move(agents)}};
  if (first.packed_count) {
    table["boxes"] = *first.packed_count;
    table["same_boxes_percent"] = model::compute_filling_degree_percent(
        *scenario, *container, model::first_parcels(*sequence, *first.packed_count));
  }
  return table;
}

Json events_as_json(const std::vector<record::Event>& events) {
  Json list = Json::array();
  for (const record::Event& event : events) {
    Json numbers = Json::object();
    for (const record::EventNumber& number : event.numbers) numbers[number.name] = number.value;
    list.push_back({{"time", event.time},
                    {"kind", event.kind},
                    {"body", event.body},
                    {"text", event.text},
                    {"numbers", std::move(numbers)}});
  }
  return list;
}

/// Boxes as the result tells, for a run that ended.
Json boxes_from_result(const runs::RunResult& result) {
  Json list = Json::array();
  for (const cell::BoxResult& box : result.boxes) {
    Json events = Json::array();
    for (const record::Event& event : box.events) {
      events.push_back({{"kind", event.kind}, {"time", event.time}, {"text", event.text}});
    }
    list.push_back({{"id", box.id},
                    {"state", cell::name_of(box.state)},
                    {"up", std::string(1, box.up)},
                    {"pose", as_json(record::PoseSample(box.X_TP))},
                    {"events", std::move(events)}});
  }
  return list;
}

/// Boxes as the events tell, for a run that was killed: in the order in which they came.
Json boxes_from_events(const std::vector<record::Event>& events) {
  Json list = Json::array();
  std::map<std::string, std::size_t> place;
  for (const record::Event& event : events) {
    if (event.body.empty()) continue;
    const auto [at, is_new] = place.try_emplace(event.body, list.size());
    if (is_new) {
      list.push_back(
          {{"id", event.body}, {"state", nullptr}, {"up", nullptr}, {"pose", nullptr}, {"events", Json::array()}});
    }
    list[at->second]["events"].push_back({{"kind", event.kind}, {"time", event.time}, {"text", event.text}});
  }
  return list;
}

Json result_as_json(const HeaderInput& input, const std::optional<runs::RunResult>& result,
                    const std::optional<model::Scenario>& scenario) {
  Json boxes = result ? boxes_from_result(*result) : boxes_from_events(input.events);
  if (boxes.empty() && !result) return nullptr;
  Json packed;
  if (result) {
    packed = std::ranges::count(result->boxes, cell::BoxState::Packed, &cell::BoxResult::state);
  }
  return {{"boxes", std::move(boxes)},
          {"filling_degree_percent", result ? Json(result->filling_degree_percent) : Json()},
          {"packed", std::move(packed)},
          {"failure", result ? result->failure.text : ""},
          {"ended_by", result ? result->ended_by : ""},
          {"warnings", result ? Json(result->warnings) : Json::array()},
          {"report_table7", reported_as_json(scenario, input.header->sequence)}};
}

}  // namespace

std::string make_header_json(const HeaderInput& input) {
  const record::RecordingHeader& header = *input.header;
  const std::optional<model::Scenario> scenario = internal::scenario_of(header);
  const Json settings = parsed(header.settings);
  Json json = {{"format", "snug replay"},
               {"version", kReplayVersion},
               {"name", input.name},
               {"snug_version", header.version},
               {"seed", std::to_string(header.seed)},
               {"sequence", header.sequence},
               {"dt", header.dt},
               {"record_period", header.record_period},
               {"complete", input.is_complete},
               {"interrupted", input.is_interrupted},
               {"frames", input.frames},
               {"scenario", {{"name", scenario ? scenario->name : ""}, {"text", header.scenario_text}}},
               {"program", program_as_json(header)},
               {"settings", settings.is_object() ? settings : Json::object()}};
  const std::optional<runs::RunResult> result = runs::read_result(input.result_json);
  json["speed"] = speed_as_json(result);
  json["result"] = result_as_json(input, result, scenario);
  json["bodies"] = bodies_as_json(header);
  json["container"] = container_as_json(header.container);
  json["tool"] = tool_as_json(header);
  json["robot"] = robot_as_json(header, input.robot);
  json["cup"] = nullptr;
  if (scenario && scenario->tool) {
    json["cup"] = {{"lip_radius", scenario->cup.lip_radius},
                   {"free_length", scenario->cup.free_length},
                   {"hold_length", scenario->cup.hold_length}};
  }
  json["frames_named"] = frames_as_json(scenario);
  json["events"] = events_as_json(input.events);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace snug::replay
