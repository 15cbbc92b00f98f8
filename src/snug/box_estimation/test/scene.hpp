// Boxes in a container under a camera, for tests: what is true is known by construction.
#pragma once

#include <string>
#include <vector>

#include "snug/box_estimation/estimate.hpp"
#include "snug/box_estimation/internal/view.hpp"
#include "snug/camera/render.hpp"

namespace snug::box_estimation::test {

/// A container of 0.4 x 0.6 x 0.25 m with its floor at z = 0, a camera 1 m over it.
struct Cell {
  model::Scenario scenario;
  model::CameraParams camera;
  explicit Cell(const std::string& preset = "structured_light") {
    model::Container container;
    container.name = "tote";
    container.inner_size = Vector3(0.4, 0.6, 0.25);
    scenario.containers.push_back(container);
    camera = model::make_camera(preset);
    camera.name = "test";
    camera.X_WC = {(Matrix3() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished(), Vector3(0, 0, 1.0)};
  }
};

struct Box {
  std::string id;
  Vector3 size;
  Pose X_WP;
};

inline Pose level(double x, double y, double z, double yaw = 0.0) {
  return {exp_rotation(Vector3(0, 0, yaw)), Vector3(x, y, z)};
}

/// Three boxes of different heights, 20 mm apart and more.
inline std::vector<Box> three_boxes() {
  return {{"a", Vector3(0.20, 0.15, 0.10), level(-0.05, -0.15, 0.05, 0.1)},
          {"b", Vector3(0.10, 0.12, 0.06), level(0.08, 0.10, 0.03, -0.4)},
          {"c", Vector3(0.16, 0.10, 0.08), level(-0.10, 0.15, 0.04, 0.02)}};
}

inline camera::Frame frame_of(const Cell& cell, const std::vector<Box>& boxes, std::uint64_t seed) {
  camera::Scene scene = camera::make_surroundings(cell.scenario);
  for (const Box& box : boxes) camera::add_box(scene, box.id, box.X_WP, box.size);
  return camera::render(scene, cell.camera, camera::draw_camera(cell.camera, seed), seed).frame;
}

inline Vector3 normals(Rng& rng, double size) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return size * Vector3(x, y, z);
}

inline EstimateInput expect(const Cell& cell, const std::vector<Box>& boxes, std::uint64_t seed) {
  EstimateInput input = make_input(cell.scenario, cell.scenario.containers.front());
  Rng rng = Rng(seed).split("belief");
  for (const Box& box : boxes)
    input.boxes.push_back({box.id,
                           box.size,
                           {exp_rotation(normals(rng, 0.02)) * box.X_WP.R, box.X_WP.p + normals(rng, 0.004)},
                           0.004,
                           0.02});
  return input;
}

/// What a fit is made in: a frame of these boxes, by a camera without errors or another one.
class FitScene {
 public:
  explicit FitScene(const std::vector<Box>& boxes, const std::string& preset = "ideal", std::uint64_t seed = 1)
      : cell(preset),
        frame(frame_of(cell, boxes, seed)),
        errors(cell.camera),
        surroundings_C(internal::in_camera(camera::make_surroundings(cell.scenario), cell.camera.X_WC)),
        range{0, cell.camera.height, 0, cell.camera.width} {}

  [[nodiscard]] internal::FitContext context() const { return {frame, range, surroundings_C, errors, settings}; }
  [[nodiscard]] internal::Prediction predict(const std::vector<internal::TrackedBox>& boxes) const {
    return internal::predict(frame, range, surroundings_C, boxes);
  }
  /// A box as it is believed, off by `p` and the rotation vector `w`, both in C; `information` of the belief.
  [[nodiscard]] internal::TrackedBox tracked(const Box& box, const Vector3& p = Vector3::Zero(),
                                             const Vector3& w = Vector3::Zero(), double information = 1e-6) const {
    internal::TrackedBox one;
    const Pose X_CP = cell.camera.X_WC.inverse() * box.X_WP;
    one.half = 0.5 * box.size;
    one.X_CP = {exp_rotation(w) * X_CP.R, X_CP.p + p};
    one.X_CP_prior = one.X_CP;
    one.prior_information = information * Matrix6::Identity();
    return one;
  }

  Cell cell;
  camera::Frame frame;
  internal::ErrorModel errors;
  camera::Scene surroundings_C;
  internal::PixelRange range;
  EstimatorSettings settings;
};

/// Leftmost pose error [translation; rotation vector] from one pose to another, both in the same frame.
inline Vector6 difference(const Pose& from, const Pose& to) {
  Vector6 off;
  off << to.p - from.p, log_rotation(to.R * from.R.transpose());
  return off;
}

}  // namespace snug::box_estimation::test
