// Scene: from a scenario, from a recording.
#include "snug/camera/scene.hpp"

#include "snug/core/input_error.hpp"
#include "snug/geometry/convex_hull.hpp"

namespace snug::camera {
namespace {

bool is_size(double value) { return value > 0.0 && value < 1e4; }
/// Each by itself: the least of numbers with a NaN among them may be any of them.
bool is_size(const Vector3& values) { return is_size(values.x()) && is_size(values.y()) && is_size(values.z()); }

geometry::Shape make_shape(const record::ShapeInfo& info, const std::string& body, const std::string& name) {
  const auto refuse = [&](const std::string& got) {
    throw InputError(name, "body '" + body + "'", got, "shapes with a volume");
  };
  switch (info.kind) {
    case record::ShapeKind::Box:
      if (!is_size(info.half)) refuse("a box without size");
      return geometry::Box{info.half};
    case record::ShapeKind::Capsule:
      if (!is_size(info.radius) || !(info.half_length >= 0.0 && info.half_length < 1e4))
        refuse("a capsule without size");
      return geometry::Capsule{info.half_length, info.radius};
    case record::ShapeKind::Cylinder:
      if (!is_size(info.radius) || !is_size(info.half_length)) refuse("a cylinder without size");
      return geometry::Cylinder{info.half_length, info.radius};
    case record::ShapeKind::Hull:
      break;
  }
  auto hull = geometry::make_convex_hull(info.vertices);
  if (!hull) refuse("a hull without volume");
  return *std::move(hull);
}

}  // namespace

int add_body(Scene& scene, const std::string& name, const Pose& X_WB, const std::vector<model::PlacedShape>& shapes) {
  const int body = static_cast<int>(scene.names.size());
  scene.names.push_back(name);
  scene.X_WB.push_back(X_WB);
  for (const model::PlacedShape& placed : shapes) scene.shapes.push_back({placed.shape, X_WB * placed.X_BG, body});
  return body;
}

int add_box(Scene& scene, const std::string& name, const Pose& X_WB, const Vector3& size) {
  return add_body(scene, name, X_WB, {{geometry::Box{0.5 * size}, {}}});
}

Scene make_surroundings(const model::Scenario& scenario) {
  Scene scene;
  for (const model::Container& container : scenario.containers)
    add_body(scene, container.name, container.X_WT, model::make_walls(container));
  for (const model::Body& body : scenario.bodies)
    if (body.kind == model::BodyKind::Static) add_body(scene, body.name, body.X_WB, body.shapes);
  if (scenario.aligner && !scenario.aligner->plates.empty())
    add_body(scene, "aligner", scenario.aligner->X_WA, scenario.aligner->plates);
  return scene;
}

Scene make_scene(const record::RecordingHeader& header, const record::Frame& frame, const std::string& name) {
  Scene scene;
  if (frame.bodies.size() != header.bodies.size())
    throw InputError(name, "bodies", std::to_string(frame.bodies.size()) + " in a frame",
                     std::to_string(header.bodies.size()) + ", as in its header");
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    const record::BodySample& sample = frame.bodies[i];
    if (!sample.present) continue;
    if (!sample.X_WB.p.allFinite() || !sample.X_WB.quat.coeffs().allFinite())
      throw InputError(name, "body '" + header.bodies[i].name + "'", "a pose that is not finite", "finite numbers");
    std::vector<model::PlacedShape> shapes;
    for (const record::ShapeInfo& info : header.bodies[i].shapes)
      shapes.push_back({make_shape(info, header.bodies[i].name, name), info.X_BG.pose()});
    add_body(scene, header.bodies[i].name, sample.X_WB.pose(), shapes);
  }
  return scene;
}

}  // namespace snug::camera
