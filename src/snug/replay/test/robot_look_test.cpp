// RobotLook: meshes are merged until they fit into a page, and stay where they are.
#include "snug/replay/internal/robot_look.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace snug::replay::internal {
namespace {

/// A square of n x n cells of 1 m in all.
model::DrawnMesh make_square(int n) {
  model::DrawnMesh mesh;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j <= n; ++j)
      mesh.vertices.emplace_back(static_cast<double>(i) / n, static_cast<double>(j) / n, 0.0);
  }
  const auto at = [n](int i, int j) { return i * (n + 1) + j; };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// OBJ text of a mesh.
std::string as_obj(const model::DrawnMesh& mesh) {
  std::string text;
  for (const Vector3& v : mesh.vertices)
    text += "v " + std::to_string(v.x()) + " " + std::to_string(v.y()) + " " + std::to_string(v.z()) + "\n";
  for (const auto& t : mesh.triangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  return text;
}

record::RecordingHeader arm_header() {
  record::RecordingHeader header;
  header.bodies.push_back({"robot/arm", "", record::BodyKind::Kinematic, 0.0, Vector3::Zero(), {}});
  return header;
}

RobotDescription robot_with(const model::DrawnMesh& mesh) {
  RobotDescription robot;
  robot.urdf =
      "<robot name='r'><link name='arm'><visual><geometry><mesh filename='a.obj'/></geometry></visual></link>"
      "<link name='none'><visual><geometry><box size='1 1 1'/></geometry></visual></link></robot>";
  robot.meshes.push_back({"a.obj", as_obj(mesh)});
  return robot;
}

TEST(MergeVertices, MovesNoVertexFartherThanACellIsWide) {
  const model::DrawnMesh mesh = make_square(40);
  const double cell = 0.1;
  const model::DrawnMesh merged = merge_vertices(mesh, cell);
  EXPECT_LT(merged.triangles.size(), mesh.triangles.size() / 8);
  for (const Vector3& v : merged.vertices) {
    double nearest = 1.0;
    for (const Vector3& u : mesh.vertices) nearest = std::min(nearest, (u - v).norm());
    EXPECT_LE(nearest, cell * std::sqrt(3.0));
    EXPECT_EQ(v.z(), 0.0);
  }
}

TEST(RobotLook, IsOfLinksThatAreBodiesAndHasAsManyTrianglesAsAPageMayHave) {
  const record::RecordingHeader header = arm_header();
  const RobotDescription robot = robot_with(make_square(60));
  const auto whole = find_looks(header, robot, 100'000);
  ASSERT_EQ(whole.size(), 1U);  // 'none' is no body of the recording
  EXPECT_EQ(whole[0].body, 0);
  EXPECT_EQ(std::get<model::DrawnMesh>(whole[0].visuals.at(0).shape).triangles.size(), 7200U);
  const auto small = find_looks(header, robot, 1000);
  EXPECT_LE(std::get<model::DrawnMesh>(small.at(0).visuals.at(0).shape).triangles.size(), 1000U);
  EXPECT_TRUE(find_looks(header, RobotDescription{}).empty());
}

}  // namespace
}  // namespace snug::replay::internal
