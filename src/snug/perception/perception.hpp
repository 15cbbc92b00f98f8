// Perception: from what there is to what is seen of it: exact, noisy, or nothing at all, behind one interface.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>

#include "snug/perception/observation.hpp"

namespace snug::perception {

enum class Kind {
  Exact,          ///< poses and sizes as they are
  Noisy,          ///< with noise, its covariance stated
  DeadReckoning,  ///< nothing is seen: boxes are believed to be where they were meant to be
  Camera,         ///< a depth camera over the container: camera_perception.hpp makes it
  Frames,         ///< the frames of a camera that is somebody else's: camera_perception.hpp makes it
};
[[nodiscard]] const char* name_of(Kind kind);
/// Throws InputError for a word that is none of `name_of`.
[[nodiscard]] Kind kind_of(std::string_view word);

/// A box as it is. Only a simulated cell knows.
struct SceneBox {
  std::string item;
  Pose X_WP;
  Vector3 size = Vector3::Constant(0.1);  ///< m
};

/// What a simulated sensor looks at.
struct Scene {
  double time = 0.0;  ///< s
  Pose X_WE;          ///< of the tool, which may stand in the way
  std::vector<SceneBox> boxes;
  std::vector<SceneBox> objects = {};  ///< what nobody told of: seen, it is an obstacle
};

class Perception {
 public:
  virtual ~Perception() = default;
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// One look. What was expected and is not in `seen` is in `not_seen`.
  [[nodiscard]] virtual Observation perceive(const Scene& scene, std::span<const Expectation> expected) = 0;
};

/// Of the noise of Kind::Noisy; uniform draws, so that nothing is far off.
struct NoiseLevels {
  double position = 0.002;  ///< m, half width of each coordinate
  double rotation = 0.020;  ///< rad, half width of each coordinate of the rotation vector
  double size = 0.0005;     ///< m, half width of each edge
};

/// `seed`: of the noise alone. Not Kind::Camera, Kind::Frames (checked): they have to know the cell.
[[nodiscard]] std::unique_ptr<Perception> make_perception(Kind kind, std::uint64_t seed, const NoiseLevels& noise = {});

}  // namespace snug::perception
