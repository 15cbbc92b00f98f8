// McapSchema: JSON schemas field by field; the ones called foxglove.* have the fields of the public schemas of that
// name.
#include "snug/replay/mcap_schemas.hpp"

#include <nlohmann/json.hpp>

#include "snug/core/check.hpp"

namespace snug::replay {
namespace {

using Json = nlohmann::ordered_json;

Json typed(const char* type) { return {{"type", type}}; }
Json number() { return typed("number"); }
Json integer() { return typed("integer"); }
Json text() { return typed("string"); }
Json boolean() { return typed("boolean"); }
Json list_of(Json items) { return {{"type", "array"}, {"items", std::move(items)}}; }

Json object(Json properties) { return {{"type", "object"}, {"properties", std::move(properties)}}; }

Json titled(McapSchema schema, const char* description, Json properties) {
  return {{"$schema", "https://json-schema.org/draft/2020-12/schema"},
          {"title", schema_name(schema)},
          {"description", description},
          {"type", "object"},
          {"properties", std::move(properties)}};
}

Json time() { return object({{"sec", integer()}, {"nsec", integer()}}); }
Json vector() { return object({{"x", number()}, {"y", number()}, {"z", number()}}); }
Json quaternion() { return object({{"x", number()}, {"y", number()}, {"z", number()}, {"w", number()}}); }
Json pose() { return object({{"position", vector()}, {"orientation", quaternion()}}); }
Json color() { return object({{"r", number()}, {"g", number()}, {"b", number()}, {"a", number()}}); }
Json header() { return object({{"stamp", time()}, {"frame_id", text()}}); }

Json frame_transforms() {
  return {{"transforms", list_of(object({{"timestamp", time()},
                                         {"parent_frame_id", text()},
                                         {"child_frame_id", text()},
                                         {"translation", vector()},
                                         {"rotation", quaternion()}}))}};
}

Json scene_entity() {
  const Json solid = object({{"pose", pose()}, {"size", vector()}, {"color", color()}});
  Json cylinder = solid;
  cylinder["properties"]["bottom_scale"] = number();
  cylinder["properties"]["top_scale"] = number();
  return object({{"timestamp", time()},
                 {"frame_id", text()},
                 {"id", text()},
                 {"lifetime", time()},
                 {"frame_locked", boolean()},
                 {"metadata", list_of(object({{"key", text()}, {"value", text()}}))},
                 {"arrows", list_of(object({{"pose", pose()},
                                            {"shaft_length", number()},
                                            {"shaft_diameter", number()},
                                            {"head_length", number()},
                                            {"head_diameter", number()},
                                            {"color", color()}}))},
                 {"cubes", list_of(solid)},
                 {"spheres", list_of(solid)},
                 {"cylinders", list_of(cylinder)},
                 {"lines", list_of(object({{"type", integer()},
                                           {"pose", pose()},
                                           {"thickness", number()},
                                           {"scale_invariant", boolean()},
                                           {"points", list_of(vector())},
                                           {"color", color()},
                                           {"colors", list_of(color())},
                                           {"indices", list_of(integer())}}))},
                 {"triangles", list_of(object({{"pose", pose()},
                                               {"points", list_of(vector())},
                                               {"color", color()},
                                               {"colors", list_of(color())},
                                               {"indices", list_of(integer())}}))},
                 {"texts", list_of(object({{"pose", pose()},
                                           {"billboard", boolean()},
                                           {"font_size", number()},
                                           {"scale_invariant", boolean()},
                                           {"color", color()},
                                           {"text", text()}}))},
                 {"models", list_of(typed("object"))}});
}

Json scene_update() {
  return {{"deletions", list_of(object({{"timestamp", time()}, {"type", integer()}, {"id", text()}}))},
          {"entities", list_of(scene_entity())}};
}

Json vectors_stamped(const char* key, const char* linear, const char* angular) {
  return {{"header", header()}, {key, object({{linear, vector()}, {angular, vector()}})}};
}

Json cup_state() {
  return {{"timestamp", time()},     {"vacuum", boolean()},  {"blow_off", boolean()}, {"pressure_gauge_pa", number()},
          {"attached_body", text()}, {"length_m", number()}, {"bend_rad", number()}};
}

}  // namespace

std::string schema_name(McapSchema schema) {
  switch (schema) {
    case McapSchema::FrameTransforms:
      return "foxglove.FrameTransforms";
    case McapSchema::PoseInFrame:
      return "foxglove.PoseInFrame";
    case McapSchema::SceneUpdate:
      return "foxglove.SceneUpdate";
    case McapSchema::Log:
      return "foxglove.Log";
    case McapSchema::TwistStamped:
      return "geometry_msgs/TwistStamped";
    case McapSchema::WrenchStamped:
      return "geometry_msgs/WrenchStamped";
    case McapSchema::JointState:
      return "sensor_msgs/JointState";
    case McapSchema::String:
      return "std_msgs/String";
    case McapSchema::CupState:
      return "snug.CupState";
    case McapSchema::SolverState:
      return "snug.SolverState";
    case McapSchema::ProgramState:
      return "snug.ProgramState";
    case McapSchema::JointStates:
      return "foxglove.JointStates";
    case McapSchema::Event:
      return "snug.Event";
  }
  SNUG_CHECK(false, "a schema that exists");
  return "";
}

std::string protobuf_name(McapSchema schema) {
  switch (schema) {
    case McapSchema::TwistStamped:
      return "snug.TwistStamped";
    case McapSchema::WrenchStamped:
      return "snug.WrenchStamped";
    case McapSchema::JointState:
    case McapSchema::String:
      return "";
    default:
      return schema_name(schema);
  }
}

std::string schema_text(McapSchema schema) {
  const auto of = [schema](const char* description, Json properties) {
    return titled(schema, description, std::move(properties)).dump();
  };
  switch (schema) {
    case McapSchema::FrameTransforms:
      return of("poses of frames in their parents", frame_transforms());
    case McapSchema::PoseInFrame:
      return of("a pose and the frame it is given in", {{"timestamp", time()}, {"frame_id", text()}, {"pose", pose()}});
    case McapSchema::SceneUpdate:
      return of("things to draw, and things to draw no more", scene_update());
    case McapSchema::Log:
      return of("what happened", {{"timestamp", time()},
                                  {"level", integer()},
                                  {"message", text()},
                                  {"name", text()},
                                  {"file", text()},
                                  {"line", integer()},
                                  {"kind", text()},
                                  {"numbers", typed("object")}});
    case McapSchema::TwistStamped:
      return of("m/s, rad/s", vectors_stamped("twist", "linear", "angular"));
    case McapSchema::WrenchStamped:
      return of("N, Nm", vectors_stamped("wrench", "force", "torque"));
    case McapSchema::JointState:
      return of("rad, rad/s, Nm", {{"header", header()},
                                   {"name", list_of(text())},
                                   {"position", list_of(number())},
                                   {"velocity", list_of(number())},
                                   {"effort", list_of(number())}});
    case McapSchema::String:
      return of("a text: the URDF of the robot", {{"data", text()}});
    case McapSchema::CupState:
      return of("suction cup: commands, gauge pressure, body held, deformation while it holds", cup_state());
    case McapSchema::SolverState:
      return of("contact solver: residual in m/s, sweeps, status, contact points", {{"timestamp", time()},
                                                                                    {"residual", number()},
                                                                                    {"iterations", integer()},
                                                                                    {"status", text()},
                                                                                    {"contacts", integer()}});
    case McapSchema::ProgramState:
      return of("row of the program that is being approached, from 0; -1 none",
                {{"timestamp", time()}, {"row", integer()}, {"name", text()}});
    case McapSchema::JointStates:
    case McapSchema::Event:
      return "";
  }
  SNUG_CHECK(false, "a schema that exists");
  return "";
}

}  // namespace snug::replay
