// Meshes as convex hulls: of many points, of points that are there twice, and what takes too much memory.
#include "snug/model/mesh_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <numbers>

#include "snug/core/rng.hpp"
#include "snug/core/test/peak_memory.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::model {
namespace {

/// m^3, of a hull around the origin.
double volume(const geometry::ConvexHull& hull) {
  double six_times = 0.0;
  for (const std::vector<int>& face : hull.faces) {
    const auto at = [&](std::size_t k) { return hull.vertices[static_cast<std::size_t>(face[k])]; };
    for (std::size_t k = 1; k + 1 < face.size(); ++k) six_times += at(0).dot(at(k).cross(at(k + 1)));
  }
  return six_times / 6.0;
}

/// A ball of radius 0.1 m.
std::vector<Vector3> points_on_sphere(int count) {
  Rng rng(1);
  std::vector<Vector3> points;
  for (int i = 0; i < count; ++i) {
    points.push_back(0.1 * Vector3(rng.normal(), rng.normal(), rng.normal()).normalized());
  }
  return points;
}

void expect_refused_in_little_memory(const std::string& ending, const std::string& text) {
  const snug::test::ScratchFolder folder;
  const std::filesystem::path path = folder / ("mesh" + ending);
  std::ofstream(path) << text;
  const auto peak = snug::test::peak_memory([&] {
    const MeshParts mesh = read_mesh_parts(path);
    if (mesh.error.find("than its size allows") == std::string::npos) ::_exit(1);
  });
  ASSERT_TRUE(peak.has_value()) << "read: " << text.substr(0, 40);
  EXPECT_LE(*peak, snug::test::allowed_memory(text.size()));
}

std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST(MakeSimpleHull, OfManyPointsOnASphereIsAlmostTheBall) {
  const auto hull = make_simple_hull(points_on_sphere(500'000));
  ASSERT_TRUE(hull.has_value());
  EXPECT_EQ(hull->vertices.size(), 64U);
  const double ball = 4.0 / 3.0 * std::numbers::pi * 1e-3;
  EXPECT_LT(volume(*hull), ball);
  EXPECT_GT(volume(*hull), 0.85 * ball);
}

TEST(MakeSimpleHull, OfAMillionPointsInACubeIsAlmostTheCube) {
  Rng rng(2);
  std::vector<Vector3> points;
  for (int i = 0; i < 1'000'000; ++i)
    points.emplace_back(rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1));
  const auto inside = make_simple_hull(points);
  ASSERT_TRUE(inside.has_value());
  EXPECT_LT(volume(*inside), 8e-3);
  EXPECT_GT(volume(*inside), 0.95 * 8e-3);
  for (int v = 0; v < 8; ++v)
    points.emplace_back((v & 1) != 0 ? 0.1 : -0.1, (v & 2) != 0 ? 0.1 : -0.1, (v & 4) != 0 ? 0.1 : -0.1);
  const auto cube = make_simple_hull(points);
  ASSERT_TRUE(cube.has_value());
  EXPECT_EQ(cube->vertices.size(), 8U);
  EXPECT_EQ(cube->faces.size(), 6U);
  EXPECT_NEAR(volume(*cube), 8e-3, 1e-9);
  std::reverse(points.begin(), points.end());
  const auto reversed = make_simple_hull(points);
  ASSERT_TRUE(reversed.has_value());
  EXPECT_EQ(reversed->vertices.size(), 8U);
  EXPECT_NEAR(volume(*reversed), 8e-3, 1e-9);
}

TEST(MakeSimpleHull, IsTheSameWhenPointsAreThereTwice) {
  std::vector<Vector3> points = points_on_sphere(5000);
  const auto once = make_simple_hull(points);
  points.insert(points.end(), points.begin(), points.begin() + 5000);
  const auto twice = make_simple_hull(points);
  ASSERT_TRUE(once && twice);
  EXPECT_EQ(once->vertices, twice->vertices);
  EXPECT_EQ(once->faces, twice->faces);
}

TEST(ReadMeshParts, RefusesTextsThatTakeMuchMoreMemoryThanTheirSize) {
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";
  const std::string faces = "f 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n";
  expect_refused_in_little_memory(".obj", corners + repeated("f 1 2 3\n", 1'000'000));
  expect_refused_in_little_memory(".obj", corners + faces + repeated("p 1\n", 1'000'000));
  expect_refused_in_little_memory(".obj", corners + faces + repeated("usemtl a\nusemtl b\n", 2000));
  expect_refused_in_little_memory(".dae", "<COLLADA>" + repeated("<node/>", 100'000) + "</COLLADA>");
  std::string doubled = "<COLLADA><library_nodes><node id=\"n0\"/>";
  for (int i = 1; i < 30; ++i) {
    const std::string instance = "<instance_node url=\"#n" + std::to_string(i - 1) + "\"/>";
    doubled += "<node id=\"n" + std::to_string(i) + "\">" + instance + instance + "</node>";
  }
  expect_refused_in_little_memory(".dae", doubled + "</library_nodes></COLLADA>");
}

TEST(ReadMeshParts, LeavesMaterialsAndOtherFilesUnopened) {
  const snug::test::ScratchFolder folder;
  std::ofstream(folder / "mesh.obj")
      << "mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl a\nf 1 2 3\nf 1 2 4\n"
         "usemtl b\nf 1 3 4\nf 2 3 4\n";
  const MeshParts mesh = read_mesh_parts(folder / "mesh.obj");
  EXPECT_EQ(mesh.error, "");
  ASSERT_EQ(mesh.parts.size(), 2U) << "one for each material";
  EXPECT_EQ(mesh.parts[0].points.size(), 4U);
  EXPECT_EQ(mesh.parts[1].points.size(), 4U);
}

}  // namespace
}  // namespace snug::model
