// RawScene: bodies, shapes and surfaces as the readers leave them, before a scenario is made of them.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "snug/model/body.hpp"
#include "snug/scene_import/import_scene.hpp"

namespace snug::scene_import::internal {

/// What decides how two shapes that touch slide.
struct Surface {
  double friction = 1.0;
  double restitution = 0.0;
  double torsional = 0.0;  ///< m, as torsional_friction of scenarios
  double rolling = 0.0;    ///< m, as rolling_resistance of scenarios
  int dimensions = 3;      ///< MuJoCo's condim
  int priority = 0;
  auto operator<=>(const Surface&) const = default;
};

struct RawShape {
  model::PlacedShape placed;  ///< in the body's frame
  Surface surface;
};

struct RawBody {
  std::string name;
  bool is_static = false;
  Pose X_WB;
  std::vector<RawShape> shapes;
  SpatialInertia inertia{0.0, Vector3::Zero(), Matrix3::Zero()};  ///< dynamic bodies only
  std::string file;
  int line = 0;
};

/// How two surfaces become one.
enum class Combination { Larger, Smaller };

/// Collects remarks of one kind into one.
class RemarkList {
 public:
  void add(const std::string& file, int line, const std::string& what);
  [[nodiscard]] std::vector<Remark> list() const { return remarks_; }

 private:
  std::vector<Remark> remarks_;
  std::map<std::pair<std::string, std::string>, std::size_t> at_;
};

struct RawScene {
  std::string name;
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);  ///< m/s^2
  double time_step = 0.002;                    ///< s
  Combination combination = Combination::Larger;
  std::vector<RawBody> bodies;
  RemarkList remarks;
};

/// Bodies that are static and overlap become one, as scenarios want statics that touch at most; one for each surface.
void merge_statics(RawScene& scene);
/// Gives each body a name of its own, printable and of bounded length.
void name_bodies(RawScene& scene);
/// The scenario's text.
[[nodiscard]] std::string format_scenario(RawScene& scene, const std::string& source);

}  // namespace snug::scene_import::internal
