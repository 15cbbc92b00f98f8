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
/// m, around the tool: for the wrist over it, and because a frame is taken while it moves. Chosen for a UR10.
constexpr double kAroundTool = 0.12;

const model::Container& container_of(const model::Scenario& scenario) {
  if (scenario.cameras.empty()) {
    throw InputError(scenario.source_name, "cameras", "none", "a camera, for --perception camera or frames");
  }
  const model::Container* container = model::find_container(scenario, scenario.target);
  if (container == nullptr) {
    throw InputError(scenario.source_name, "containers", "none",
                     "a container to look into, for --perception camera or frames");
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

/// What a depth camera over the container tells, and stations outside of it.
class DepthPerception : public Perception {
 public:
  DepthPerception(std::uint64_t seed, const model::Scenario& scenario)
      : container_(container_of(scenario)),
        known_(box_estimation::make_input(scenario, container_)),
        station_(make_perception(Kind::Noisy, seed, kStationNoise)) {}

  [[nodiscard]] Observation perceive(const Scene& scene, std::span<const Expectation> expected) override {
    Observation observation = station_->perceive(outside_of(scene), {});
    observation.obstacles.reset();  // the stations' tell nothing of the container
    box_estimation::EstimateInput input = known_;
    for (const Expectation& one : expected) {
      if (one.X_WP && find(observation, one.item) == nullptr && looks_for(*one.X_WP)) {
        input.boxes.push_back({one.item, one.size, *one.X_WP});
      }
    }
    const Expected<camera::Frame, std::string> frame = take_frame(scene, ++look_);
    if (frame) {
      add_estimate(box_estimation::estimate_boxes(*frame, input), observation);
    } else {
      observation.fault = LookFault::NoFrame;
      observation.trouble = frame.error();
    }
    for (const Expectation& one : expected) {
      if (find(observation, one.item) == nullptr) observation.not_seen.push_back(one.item);
    }
    return observation;
  }

 protected:
  /// `look`: from 1 on.
  [[nodiscard]] virtual Expected<camera::Frame, std::string> take_frame(const Scene& scene, std::uint64_t look) = 0;
  /// Is a box that is believed to be there looked for in the frame?
  [[nodiscard]] virtual bool looks_for(const Pose& X_WP) const = 0;
  [[nodiscard]] const camera::Scene& surroundings() const { return known_.surroundings; }

  [[nodiscard]] bool is_about_container(const Pose& X_WP) const {
    const Vector3 half = 0.5 * container_.inner_size + Vector3::Constant(kBeyondWall);
    const Vector3 p_TP = container_.X_WT.inverse() * X_WP.p;
    return std::abs(p_TP.x()) < half.x() && std::abs(p_TP.y()) < half.y();
  }

 private:
  static void add_estimate(const box_estimation::Estimate& estimate, Observation& observation) {
    for (const box_estimation::BoxEstimate& box : estimate.boxes) {
      if (box.sight == box_estimation::Sight::Missing) observation.missing.push_back(box.id);
      if (box.sight != box_estimation::Sight::Seen) continue;
      observation.seen.push_back({box.id, box.X_WP, box.covariance, std::nullopt, 0.0, box.common});
    }
    observation.fault = fault_of(estimate.fault);
    if (observation.fault == LookFault::None) report_obstacles(estimate, observation);
  }

  [[nodiscard]] Scene outside_of(const Scene& scene) const {
    Scene outside = scene;
    outside.objects.clear();
    std::erase_if(outside.boxes, [&](const SceneBox& box) { return is_about_container(box.X_WP); });
    return outside;
  }

  model::Container container_;
  box_estimation::EstimateInput known_;  ///< no boxes in it
  std::unique_ptr<Perception> station_;
  std::uint64_t look_ = 0;
};

/// Frames are rendered here, from the scene.
class Camera final : public DepthPerception {
 public:
  Camera(std::uint64_t seed, const model::Scenario& scenario)
      : DepthPerception(seed, scenario), params_(scenario.cameras.front()), draw_(camera::draw_camera(params_, seed)) {}

  [[nodiscard]] std::string_view name() const override { return name_of(Kind::Camera); }

 private:
  [[nodiscard]] Expected<camera::Frame, std::string> take_frame(const Scene& scene, std::uint64_t look) override {
    camera::Scene view = surroundings();
    for (const SceneBox& box : scene.boxes) camera::add_box(view, box.item, box.X_WP, box.size);
    for (const SceneBox& one : scene.objects) camera::add_box(view, one.item, one.X_WP, one.size);
    return camera::render(view, params_, draw_, look).frame;
  }
  [[nodiscard]] bool looks_for(const Pose& /*X_WP*/) const override { return true; }

  model::CameraParams params_;
  camera::CameraDraw draw_;
};

/// Leaves the tool, and the wrist over it, out of what a frame tells.
class ToolFilter {
 public:
  explicit ToolFilter(const model::Scenario& scenario) {
    if (!scenario.tool) return;
    shapes_ = scenario.tool->rod_shapes;
    shapes_.insert(shapes_.end(), scenario.tool->cup_shapes.begin(), scenario.tool->cup_shapes.end());
  }

  /// Columns within kAroundTool of the tool, and not farther than that under it, tell nothing of the container.
  void leave_out(const Pose& X_WE, Observation& look) const {
    if (shapes_.empty() || !look.obstacles || !look.heights) return;
    Vector3 low = X_WE.p, high = X_WE.p;
    for (const model::PlacedShape& one : shapes_) {
      const geometry::Aabb box = geometry::bounds(one.shape, X_WE * one.X_BG);
      low = low.cwiseMin(box.lower), high = high.cwiseMax(box.upper);
    }
    const auto is_tool = [&](int x, int y, double top) {
      const Eigen::Vector2d middle = kColumnSide * Eigen::Vector2d(x + 0.5, y + 0.5);
      return top > low.z() - kAroundTool && (middle.array() > low.head<2>().array() - kAroundTool).all() &&
             (middle.array() < high.head<2>().array() + kAroundTool).all();
    };
    for (Obstacle& one : *look.obstacles)
      std::erase_if(one.columns, [&](const Column& column) { return is_tool(column.x, column.y, column.top); });
    std::erase_if(*look.obstacles, [](const Obstacle& one) { return one.columns.empty(); });
    HeightMap& map = *look.heights;
    for (std::size_t k = 0; k < map.height.size(); ++k) {
      const int index = static_cast<int>(k);
      if (is_tool(map.x + index % map.cols, map.y + index / map.cols, map.height[k]))
        map.height[k] = HeightMap::kUnseen;
    }
  }

 private:
  std::vector<model::PlacedShape> shapes_;
};

/// Frames come from elsewhere. The robot may stand in the view.
class Frames final : public DepthPerception {
 public:
  Frames(std::uint64_t seed, const model::Scenario& scenario, camera::FrameSource source)
      : DepthPerception(seed, scenario), source_(std::move(source)), tool_(scenario) {}

  [[nodiscard]] std::string_view name() const override { return name_of(Kind::Frames); }
  [[nodiscard]] Observation perceive(const Scene& scene, std::span<const Expectation> expected) override {
    Observation observation = DepthPerception::perceive(scene, expected);
    tool_.leave_out(scene.X_WE, observation);
    return observation;
  }

 private:
  [[nodiscard]] Expected<camera::Frame, std::string> take_frame(const Scene& scene, std::uint64_t look) override {
    return source_(look, scene.time);
  }
  /// At the aligner nobody may have measured it: the frame does not show that place.
  [[nodiscard]] bool looks_for(const Pose& X_WP) const override { return is_about_container(X_WP); }

  camera::FrameSource source_;
  ToolFilter tool_;
};

}  // namespace

std::unique_ptr<Perception> make_perception(Kind kind, std::uint64_t seed, const model::Scenario& scenario) {
  if (kind == Kind::Camera) return std::make_unique<Camera>(seed, scenario);
  if (kind == Kind::Frames) return make_perception(kind, seed, scenario, {});
  return make_perception(kind, seed);
}

std::unique_ptr<Perception> make_perception(Kind kind, std::uint64_t seed, const model::Scenario& scenario,
                                            camera::FrameSource frames) {
  if (kind != Kind::Frames) return make_perception(kind, seed, scenario);
  if (!frames) {
    throw InputError("command line", "--perception", "frames, without --frames",
                     "--frames of `snug pack`, with a folder or with a command that writes a frame");
  }
  return std::make_unique<Frames>(seed, scenario, std::move(frames));
}

}  // namespace snug::perception
