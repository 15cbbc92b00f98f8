// What a viewer draws of a recording, as foxglove.SceneUpdate.
#include "snug/replay/internal/mcap_scene.hpp"

#include <algorithm>
#include <array>

#include "snug/geometry/convex_hull.hpp"
#include "snug/replay/internal/body_colours.hpp"
#include "snug/replay/internal/mcap_messages.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::replay::internal {
namespace {

using record::PoseSample;

constexpr int kDeleteAll = 1;  // of a SceneEntityDeletion

constexpr std::array<double, 4> kLabel = {0.1, 0.1, 0.1, 1.0};

Json color_json(const std::array<double, 4>& color) {
  return {{"r", color[0]}, {"g", color[1]}, {"b", color[2]}, {"a", color[3]}};
}

Json make_entity(std::uint64_t ns, std::string_view frame, const std::string& id) {
  Json entity = {{"timestamp", time_json(ns)}, {"frame_id", frame},    {"id", id},
                 {"lifetime", time_json(0)},   {"frame_locked", true}, {"metadata", Json::array()}};
  for (const char* list : {"arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "texts", "models"}) {
    entity[list] = Json::array();
  }
  return entity;
}

Json solid(const PoseSample& X, const Vector3& size, const Json& color) {
  return {{"pose", as_json(X)}, {"size", as_json(size)}, {"color", color}};
}

Json cylinder(const PoseSample& X, const Vector3& size, double top_scale, const Json& color) {
  Json json = solid(X, size, color);
  json["bottom_scale"] = 1.0;
  json["top_scale"] = top_scale;
  return json;
}

void add_cylinder(Json& entity, const record::ShapeInfo& shape, const Json& color) {
  const double width = 2.0 * shape.radius;
  entity["cylinders"].push_back(cylinder(shape.X_BG, {width, width, 2.0 * shape.half_length}, 1.0, color));
}

void add_capsule(Json& entity, const record::ShapeInfo& shape, const Json& color) {
  const double width = 2.0 * shape.radius;
  add_cylinder(entity, shape, color);
  for (const double end : {-shape.half_length, shape.half_length}) {
    const PoseSample X(shape.X_BG.p + shape.X_BG.quat.normalized() * Vector3(0.0, 0.0, end), shape.X_BG.quat);
    entity["spheres"].push_back(solid(X, Vector3::Constant(width), color));
  }
}

void add_hull(Json& entity, const record::ShapeInfo& shape, const Json& color) {
  const auto hull = geometry::make_convex_hull(shape.vertices);
  if (!hull) return;
  Json points = Json::array(), indices = Json::array();
  for (const Vector3& vertex : hull->vertices) points.push_back(as_json(vertex));
  for (const std::vector<int>& face : hull->faces) {
    for (std::size_t i = 2; i < face.size(); ++i) {
      for (const int corner : {face[0], face[i - 1], face[i]}) indices.push_back(corner);
    }
  }
  entity["triangles"].push_back({{"pose", as_json(shape.X_BG)},
                                 {"points", std::move(points)},
                                 {"color", color},
                                 {"colors", Json::array()},
                                 {"indices", std::move(indices)}});
}

Json body_entity(std::uint64_t ns, const record::BodyInfo& body, bool is_container) {
  Json entity = make_entity(ns, body.name, body.name);
  const bool is_parcel = body.kind == record::BodyKind::Dynamic;
  const Json color = color_json(body_colour(body, is_container));
  for (const record::ShapeInfo& shape : body.shapes) {
    switch (shape.kind) {
      case record::ShapeKind::Box:
        entity["cubes"].push_back(solid(shape.X_BG, 2.0 * shape.half, color));
        break;
      case record::ShapeKind::Capsule:
        add_capsule(entity, shape, color);
        break;
      case record::ShapeKind::Cylinder:
        add_cylinder(entity, shape, color);
        break;
      case record::ShapeKind::Hull:
        add_hull(entity, shape, color);
        break;
    }
  }
  if (!is_parcel) return entity;
  entity["metadata"] = {{{"key", "type"}, {"value", body.type}},
                        {{"key", "mass_kg"}, {"value", Json(body.mass).dump()}}};
  entity["texts"].push_back({{"pose", as_json(PoseSample())},
                             {"billboard", true},
                             {"font_size", 12.0},
                             {"scale_invariant", true},
                             {"color", color_json(kLabel)},
                             {"text", body.name}});
  return entity;
}

void add_mesh(Json& entity, const model::DrawnMesh& mesh, const PoseSample& X, const Json& color) {
  Json points = Json::array(), indices = Json::array();
  for (const Vector3& vertex : mesh.vertices) points.push_back(as_json(vertex));
  for (const auto& triangle : mesh.triangles) {
    for (const int corner : triangle) indices.push_back(corner);
  }
  entity["triangles"].push_back({{"pose", as_json(X)},
                                 {"points", std::move(points)},
                                 {"color", color},
                                 {"colors", Json::array()},
                                 {"indices", std::move(indices)}});
}

void add_visual(Json& entity, const robot::Visual& visual) {
  const Json color = color_json(visual.rgba);
  record::ShapeInfo shape;
  shape.X_BG = visual.X_LG;
  if (const auto* box = std::get_if<geometry::Box>(&visual.shape)) {
    entity["cubes"].push_back(solid(shape.X_BG, 2.0 * box->half, color));
  } else if (const auto* capsule = std::get_if<geometry::Capsule>(&visual.shape)) {
    shape.radius = capsule->radius;
    shape.half_length = capsule->half_length;
    add_capsule(entity, shape, color);
  } else if (const auto* cylinder = std::get_if<geometry::Cylinder>(&visual.shape)) {
    shape.radius = cylinder->radius;
    shape.half_length = cylinder->half_length;
    add_cylinder(entity, shape, color);
  } else {
    add_mesh(entity, std::get<model::DrawnMesh>(visual.shape), shape.X_BG, color);
  }
}

Json update(std::uint64_t ns, Json entities) {
  const Json deletions = Json::array({{{"timestamp", time_json(ns)}, {"type", kDeleteAll}, {"id", ""}}});
  return {{"deletions", deletions}, {"entities", std::move(entities)}};
}

}  // namespace

Json robot_message(std::uint64_t ns, const record::RecordingHeader& header, const std::vector<LinkLook>& looks) {
  Json entities = Json::array();
  for (const LinkLook& look : looks) {
    const std::string& name = header.bodies[static_cast<std::size_t>(look.body)].name;
    Json entity = make_entity(ns, name, name);
    for (const robot::Visual& visual : look.visuals) add_visual(entity, visual);
    entities.push_back(std::move(entity));
  }
  return update(ns, std::move(entities));
}

Json scene_message(std::uint64_t ns, const record::RecordingHeader& header, const record::Frame& frame,
                   const std::vector<LinkLook>& looks) {
  Json entities = Json::array();
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    const record::BodyInfo& body = header.bodies[i];
    if (std::ranges::find(looks, static_cast<int>(i), &LinkLook::body) != looks.end()) continue;
    if (frame.bodies[i].present) entities.push_back(body_entity(ns, body, body.name == header.container.name));
  }
  return update(ns, std::move(entities));
}

Json cup_message(std::uint64_t ns, const CupLook& look, const record::CupSample& cup) {
  constexpr double kLip = 0.004;  // m, drawn thickness of the lip
  const bool holds = cup.attached_body >= 0;
  const PoseSample X_ES = holds ? cup.X_ES : PoseSample({0.0, 0.0, look.free_length}, Quaternion::Identity());
  const Quaternion towards_lip = rotation_between(Vector3::UnitZ(), X_ES.p);
  const double length = X_ES.p.norm(), width = 2.0 * look.lip_radius;
  Json entity = make_entity(ns, kToolFrame, "cup");
  const Json color = color_json(holds ? kCupHolds : kCupFree);
  // Narrow at the gripper, wide at the lip.
  Json bellows = cylinder({0.5 * X_ES.p, towards_lip}, {width, width, length}, 1.0, color);
  bellows["bottom_scale"] = 0.6;
  entity["cylinders"].push_back(std::move(bellows));
  entity["cylinders"].push_back(cylinder(X_ES, {width, width, kLip}, 1.0, color));
  return update(ns, Json::array({std::move(entity)}));
}

}  // namespace snug::replay::internal
