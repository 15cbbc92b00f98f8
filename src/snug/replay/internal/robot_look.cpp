// RobotLook: the links of a robot as they are drawn, small enough for a page.
#include "snug/replay/internal/robot_look.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace snug::replay::internal {
namespace {

constexpr double kFinest = 2e-4;    ///< m, below what a page shows of an arm
constexpr double kCoarsest = 0.05;  ///< m

std::size_t count_triangles(const std::vector<LinkLook>& looks) {
  std::size_t count = 0;
  for (const LinkLook& look : looks) {
    for (const robot::Visual& visual : look.visuals) {
      if (const auto* mesh = std::get_if<model::DrawnMesh>(&visual.shape)) count += mesh->triangles.size();
    }
  }
  return count;
}

std::vector<LinkLook> merged(std::vector<LinkLook> looks, double cell) {
  for (LinkLook& look : looks) {
    for (robot::Visual& visual : look.visuals) {
      if (auto* mesh = std::get_if<model::DrawnMesh>(&visual.shape)) *mesh = merge_vertices(*mesh, cell);
    }
  }
  return looks;
}

}  // namespace

model::DrawnMesh merge_vertices(const model::DrawnMesh& mesh, double cell) {
  model::DrawnMesh result;
  result.rgba = mesh.rgba;
  std::map<std::array<std::int64_t, 3>, int> cells;
  std::vector<int> merged_into;
  std::vector<int> counts;
  for (const Vector3& vertex : mesh.vertices) {
    const auto of = [&](double x) { return static_cast<std::int64_t>(std::floor(std::clamp(x, -1e3, 1e3) / cell)); };
    const auto [at, is_new] =
        cells.try_emplace({of(vertex.x()), of(vertex.y()), of(vertex.z())}, static_cast<int>(result.vertices.size()));
    if (is_new) {
      result.vertices.emplace_back(Vector3::Zero());
      counts.push_back(0);
    }
    const auto index = static_cast<std::size_t>(at->second);
    result.vertices[index] += vertex;
    ++counts[index];
    merged_into.push_back(at->second);
  }
  for (std::size_t i = 0; i < counts.size(); ++i) result.vertices[i] /= counts[i];
  for (const std::array<int, 3>& triangle : mesh.triangles) {
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) corners[k] = merged_into[static_cast<std::size_t>(triangle[k])];
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    result.triangles.push_back(corners);
  }
  return result;
}

std::vector<LinkLook> find_looks(const record::RecordingHeader& header, const RobotDescription& description,
                                 std::size_t most_triangles) {
  std::vector<LinkLook> looks;
  if (description.urdf.empty()) return looks;
  for (robot::LinkVisuals& link : robot::parse_visuals(description.urdf, description.meshes)) {
    const int body = record::find_body(header, "robot/" + link.link);
    if (body >= 0) looks.push_back({body, std::move(link.visuals)});
  }
  double cell = kFinest;
  std::vector<LinkLook> small = merged(looks, cell);
  while (count_triangles(small) > most_triangles && cell < kCoarsest) small = merged(looks, cell *= 1.5);
  return small;
}

}  // namespace snug::replay::internal
