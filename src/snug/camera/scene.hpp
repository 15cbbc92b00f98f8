// Scene: what can be seen: convex shapes of bodies, where they are at one instant.
#pragma once

#include <string>
#include <vector>

#include "snug/geometry/shape.hpp"
#include "snug/model/scenario.hpp"
#include "snug/record/recording.hpp"

namespace snug::camera {

struct SceneShape {
  geometry::Shape shape;
  Pose X_WG;
  int body = 0;  ///< index into Scene::names
};

struct Scene {
  std::vector<std::string> names;
  std::vector<Pose> X_WB;
  std::vector<SceneShape> shapes;
};

/// Adds a body; returns its index.
int add_body(Scene& scene, const std::string& name, const Pose& X_WB, const std::vector<model::PlacedShape>& shapes);
/// Adds a box centred at its frame.
int add_box(Scene& scene, const std::string& name, const Pose& X_WB, const Vector3& size);

/// Containers, static bodies and the aligner's plates of a scenario: what stands still.
[[nodiscard]] Scene make_surroundings(const model::Scenario& scenario);

/// All bodies that are present in a frame of a recording. Shapes that cannot be (hulls without volume, sizes that are
/// not positive) throw InputError with `name`, the recording's.
[[nodiscard]] Scene make_scene(const record::RecordingHeader& header, const record::Frame& frame,
                               const std::string& name);

}  // namespace snug::camera
