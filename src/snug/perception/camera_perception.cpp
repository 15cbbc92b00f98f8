// CameraPerception: boxes as a depth camera over the container tells them, behind the interface of perception.
#include "snug/perception/camera_perception.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "snug/box_estimation/estimate.hpp"
#include "snug/camera/render.hpp"
#include "snug/core/input_error.hpp"

namespace snug::perception {
namespace {

constexpr double kBeyondWall = 0.05;  ///< m, a middle so far beyond the walls is outside the container

const model::Container& container_of(const model::Scenario& scenario) {
  if (scenario.cameras.empty()) {
    throw InputError(scenario.source_name, "cameras", "none", "a camera, for --perception camera");
  }
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) {
    throw InputError(scenario.source_name, "containers", "none", "a container to look into, for --perception camera");
  }
  return *container;
}

LookFault fault_of(box_estimation::FrameFault fault) {
  switch (fault) {
    case box_estimation::FrameFault::None:
      return LookFault::None;
    case box_estimation::FrameFault::TooFewPoints:
      return LookFault::TooFewPoints;
    case box_estimation::FrameFault::ViewBlocked:
      return LookFault::ViewBlocked;
  }
  return LookFault::None;
}

void report_obstacles(const box_estimation::Estimate& estimate, Observation& observation) {
  observation.obstacles.emplace();
  for (const box_estimation::Obstacle& one : estimate.obstacles) {
    observation.obstacles->push_back({one.columns, one.deviation});
  }
  const box_estimation::HeightMap& seen = estimate.heights;
  HeightMap& map = observation.heights.emplace();
  const auto index = [](double corner) { return static_cast<int>(std::lround(corner / kColumnSide)); };
  map.x = index(seen.origin.x());
  map.y = index(seen.origin.y());
  map.cols = seen.height.cols();
  map.rows = seen.height.rows();
  for (const float z : seen.height.values()) map.height.push_back(std::isnan(z) ? HeightMap::kUnseen : z);
}

class Camera final : public Perception {
 public:
  Camera(std::uint64_t seed, const model::Scenario& scenario)
      : container_(container_of(scenario)),
        params_(scenario.cameras.front()),
        draw_(camera::draw_camera(params_, seed)),
        known_(box_estimation::make_input(scenario, container_)),
        station_(make_perception(Kind::Noisy, seed, kStationNoise)) {}

  [[nodiscard]] std::string_view name() const override { return name_of(Kind::Camera); }

  [[nodiscard]] Observation perceive(const Scene& scene, std::span<const Expectation> expected) override {
    Observation observation = station_->perceive(outside_of(scene), {});
    box_estimation::EstimateInput input = known_;
    for (const Expectation& one : expected) {
      if (one.X_WP && find(observation, one.item) == nullptr) {
        input.boxes.push_back({one.item, one.size, *one.X_WP});
      }
    }
    const box_estimation::Estimate estimate =
        box_estimation::estimate_boxes(camera::render(view_of(scene), params_, draw_, ++shot_).frame, input);
    for (const box_estimation::BoxEstimate& box : estimate.boxes) {
      if (box.sight == box_estimation::Sight::Missing) observation.missing.push_back(box.id);
      if (box.sight != box_estimation::Sight::Seen) continue;
      observation.seen.push_back({box.id, box.X_WP, box.covariance, std::nullopt, 0.0, box.common});
    }
    observation.obstacles.reset();  // the stations' tell nothing of the container
    observation.fault = fault_of(estimate.fault);
    if (observation.fault == LookFault::None) report_obstacles(estimate, observation);
    for (const Expectation& one : expected) {
      if (find(observation, one.item) == nullptr) observation.not_seen.push_back(one.item);
    }
    return observation;
  }

 private:
  [[nodiscard]] camera::Scene view_of(const Scene& scene) const {
    camera::Scene view = known_.surroundings;
    for (const SceneBox& box : scene.boxes) camera::add_box(view, box.item, box.X_WP, box.size);
    for (const SceneBox& one : scene.objects) camera::add_box(view, one.item, one.X_WP, one.size);
    return view;
  }

  [[nodiscard]] Scene outside_of(const Scene& scene) const {
    Scene outside = scene;
    outside.objects.clear();
    const Vector3 half = 0.5 * container_.inner_size + Vector3::Constant(kBeyondWall);
    std::erase_if(outside.boxes, [&](const SceneBox& box) {
      const Vector3 p_TP = container_.X_WT.inverse() * box.X_WP.p;
      return std::abs(p_TP.x()) < half.x() && std::abs(p_TP.y()) < half.y();
    });
    return outside;
  }

  model::Container container_;
  model::CameraParams params_;
  camera::CameraDraw draw_;
  box_estimation::EstimateInput known_;  ///< no boxes in it
  std::unique_ptr<Perception> station_;
  std::uint64_t shot_ = 0;
};

}  // namespace

std::unique_ptr<Perception> make_perception(Kind kind, std::uint64_t seed, const model::Scenario& scenario) {
  if (kind == Kind::Camera) return std::make_unique<Camera>(seed, scenario);
  return make_perception(kind, seed);
}

}  // namespace snug::perception
