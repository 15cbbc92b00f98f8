// Surfaces of triangles: what they enclose and what they fall into, and what a scene says of hollows that hulls fill.
#include "snug/model/mesh_pieces.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "snug/core/rng.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/model/scenario.hpp"
#include "snug/model/test/scenario_text.hpp"

namespace snug::model {
namespace {

/// Closed box from `low` to `high`, counter-clockwise from outside, each triangle with corners of its own as in STL.
MeshPart box(const Vector3& low, const Vector3& high) {
  // Bits of a corner: x, y, z high.
  constexpr std::array<std::array<int, 4>, 6> kFaces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  MeshPart part;
  for (const std::array<int, 4>& face : kFaces) {
    for (const std::array<int, 3>& triangle : {std::array{face[0], face[1], face[2]}, {face[0], face[2], face[3]}}) {
      const int first = static_cast<int>(part.points.size());
      for (const int v : triangle) {
        part.points.emplace_back((v & 1) != 0 ? high.x() : low.x(), (v & 2) != 0 ? high.y() : low.y(),
                                 (v & 4) != 0 ? high.z() : low.z());
      }
      part.triangles.push_back({first, first + 1, first + 2});
    }
  }
  return part;
}

MeshPart joined(const std::vector<MeshPart>& parts) {
  MeshPart all;
  for (const MeshPart& part : parts) {
    const int first = static_cast<int>(all.points.size());
    all.points.insert(all.points.end(), part.points.begin(), part.points.end());
    for (const std::array<int, 3>& t : part.triangles)
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  return all;
}

MeshPart inside_out(MeshPart part) {
  for (std::array<int, 3>& t : part.triangles) std::swap(t[1], t[2]);
  return part;
}

/// Open at the top: outer walls, inner walls, rim and both floors as one closed surface. 0.4 x 0.3 x 0.2 m outside,
/// 10 mm thick: a box minus a box that meets it at the rim.
MeshPart tote() {
  const MeshPart outer = box(Vector3(-0.2, -0.15, 0.0), Vector3(0.2, 0.15, 0.2));
  const MeshPart inner = inside_out(box(Vector3(-0.19, -0.14, 0.01), Vector3(0.19, 0.14, 0.2)));
  MeshPart all;
  for (const MeshPart& part : {outer, inner}) {
    for (const std::array<int, 3>& t : part.triangles) {
      const auto z = [&](std::size_t k) { return part.points[static_cast<std::size_t>(t[k])].z(); };
      if (z(0) == 0.2 && z(1) == 0.2 && z(2) == 0.2) continue;
      const int first = static_cast<int>(all.points.size());
      for (const int i : t) all.points.push_back(part.points[static_cast<std::size_t>(i)]);
      all.triangles.push_back({first, first + 1, first + 2});
    }
  }
  const auto rim = [&](double ax, double ay, double bx, double by, double cx, double cy) {
    const int first = static_cast<int>(all.points.size());
    for (const auto& [x, y] : {std::pair(ax, ay), std::pair(bx, by), std::pair(cx, cy)})
      all.points.emplace_back(x, y, 0.2);
    all.triangles.push_back({first, first + 1, first + 2});
  };
  const std::array<std::array<double, 2>, 4> signs = {{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto& [ax, ay] = signs[k];
    const auto& [bx, by] = signs[(k + 1) % 4];
    rim(0.2 * ax, 0.15 * ay, 0.2 * bx, 0.15 * by, 0.19 * bx, 0.14 * by);
    rim(0.2 * ax, 0.15 * ay, 0.19 * bx, 0.14 * by, 0.19 * ax, 0.14 * ay);
  }
  return all;
}

constexpr double kToteVolume = 0.4 * 0.3 * 0.2 - 0.38 * 0.28 * 0.19;

void write_stl(const std::filesystem::path& path, const MeshPart& part) {
  std::ofstream file(path);
  file << "solid s\n";
  for (const std::array<int, 3>& t : part.triangles) {
    file << "facet normal 0 0 0\nouter loop\n";
    for (const int i : t) file << "vertex " << part.points[static_cast<std::size_t>(i)].transpose() << "\n";
    file << "endloop\nendfacet\n";
  }
  file << "endsolid s\n";
}

Scenario scene_with(const MeshPart& part, const std::string& more = "") {
  const snug::test::ScratchFolder folder;
  write_stl(folder / "mesh.stl", part);
  std::ofstream(folder / "scene.yaml")
      << "materials: [{name: m}]\ncontacts: {default: {friction: 0.4, restitution: 0}}\n"
         "bodies:\n  - {name: tote, kind: static, material: m, shapes: [{mesh: {file: mesh.stl"
      << more << "}}]}\n";
  return load_scenario(folder / "scene.yaml");
}

TEST(MeasureSurface, GivesVolumeAndAreaOfBoxesAndHollows) {
  const SurfaceMeasures cube = measure_surface(box(Vector3(100.0, 0.0, 0.0), Vector3(100.1, 0.2, 0.3)));
  EXPECT_TRUE(cube.is_closed);
  EXPECT_NEAR(cube.volume, 0.006, 1e-12);  // rounding of coordinates of 100 m: 1e-14 m over 0.2 m^2
  EXPECT_NEAR(cube.area, 2.0 * (0.02 + 0.03 + 0.06), 1e-12);
  const SurfaceMeasures hollow = measure_surface(tote());
  EXPECT_TRUE(hollow.is_closed);
  EXPECT_NEAR(hollow.volume, kToteVolume, 1e-15);
  EXPECT_NEAR(measure_surface(inside_out(tote())).volume, -kToteVolume, 1e-15);
}

TEST(MeasureSurface, IsNotClosedWithAHoleOrATurnedTriangle) {
  MeshPart holed = tote();
  holed.triangles.pop_back();
  EXPECT_FALSE(measure_surface(holed).is_closed);
  MeshPart turned = tote();
  std::swap(turned.triangles[3][1], turned.triangles[3][2]);
  EXPECT_FALSE(measure_surface(turned).is_closed);
  EXPECT_FALSE(measure_surface(MeshPart{}).is_closed);
}

TEST(SplitLoosePieces, TakesClosedPiecesApartWhateverTheOrderOfTriangles) {
  std::vector<MeshPart> boxes;
  for (int i = 0; i < 5; ++i) boxes.push_back(box(Vector3(i, 0, 0), Vector3(i + 0.5 + 0.1 * i, 1, 1)));
  MeshPart all = joined(boxes);
  Rng rng(4);
  for (std::size_t i = all.triangles.size(); i-- > 1;)
    std::swap(all.triangles[i], all.triangles[static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(i)))]);
  const std::vector<MeshPart> pieces = split_loose_pieces(all, 64);
  ASSERT_EQ(pieces.size(), 5U);
  double volume = 0.0;
  for (const MeshPart& piece : pieces) {
    EXPECT_EQ(piece.triangles.size(), 12U);
    const double own = measure_surface(piece).volume;
    EXPECT_GT(own, 0.49);
    volume += own;
  }
  EXPECT_NEAR(volume, 0.5 + 0.6 + 0.7 + 0.8 + 0.9, 1e-12);
}

TEST(SplitLoosePieces, LeavesWholeWhatIsOpenFlatOrOfTooManyPieces) {
  const MeshPart a = box(Vector3(0, 0, 0), Vector3(1, 1, 1)), b = box(Vector3(2, 0, 0), Vector3(3, 1, 1));
  MeshPart open = b;
  open.triangles.pop_back();
  EXPECT_EQ(split_loose_pieces(joined({a, open}), 64).size(), 1U);
  EXPECT_EQ(split_loose_pieces(joined({a, box(Vector3(2, 0, 0), Vector3(3, 1, 0))}), 64).size(), 1U) << "flat";
  EXPECT_EQ(split_loose_pieces(joined({a, b, a}), 64).size(), 1U) << "edges of four triangles";
  EXPECT_EQ(split_loose_pieces(joined({a, b}), 1).size(), 1U);
  EXPECT_EQ(split_loose_pieces(MeshPart{}, 64).size(), 1U);
}

TEST(SplitLoosePieces, DropsCavitiesAndKeepsWhatFacesTheOtherWayOutside) {
  const MeshPart outer = box(Vector3(0, 0, 0), Vector3(1, 1, 1));
  const MeshPart cavity = inside_out(box(Vector3(0.2, 0.2, 0.2), Vector3(0.8, 0.8, 0.8)));
  const MeshPart apart = inside_out(box(Vector3(2, 0, 0), Vector3(2.5, 1, 1)));
  EXPECT_EQ(split_loose_pieces(joined({outer, cavity}), 64).size(), 1U);
  EXPECT_EQ(split_loose_pieces(joined({outer, apart}), 64).size(), 2U);
  EXPECT_EQ(split_loose_pieces(inside_out(joined({outer, cavity, apart})), 64).size(), 2U);
}

TEST(SceneWithAMesh, WarnsOfHollowsThatItsHullFills) {
  const Scenario scenario = scene_with(tote());
  EXPECT_EQ(scenario.bodies.back().shapes.size(), 1U);
  ASSERT_EQ(scenario.warnings.size(), 1U);
  // 24 l outside, 3.784 l of walls.
  EXPECT_EQ(scenario.warnings.front(),
            "bodies[0].shapes[0].mesh.file: part 1 of 'mesh.stl' encloses 3.78 l; its convex hull of 24 l, which is "
            "what bodies touch, fills hollows of 20.2 l (84 %); cut it into convex pieces that are closed and share no "
            "corner, or write `shapes`");
  EXPECT_NE(scene_with(tote(), ", scale: 0.5").warnings.front().find("encloses 0.473 l"), std::string::npos);
  EXPECT_EQ(scene_with(inside_out(tote())).warnings.size(), 1U);
}

TEST(SceneWithAMesh, WarnsOfOpenSurfacesThatAreNotConvex) {
  MeshPart open = tote();
  open.triangles.pop_back();
  const Scenario scenario = scene_with(open);
  ASSERT_EQ(scenario.warnings.size(), 1U);
  EXPECT_NE(scenario.warnings.front().find("is no closed surface"), std::string::npos) << scenario.warnings.front();
  MeshPart turned = tote();
  std::swap(turned.triangles[3][1], turned.triangles[3][2]);
  EXPECT_NE(scene_with(turned).warnings.front().find("encloses 3.78 l"), std::string::npos) << "wound as it comes";
}

/// Five boxes that meet in edges and corners, as in the files that people make.
std::vector<MeshPart> tote_of_boxes() {
  return {box(Vector3(-0.2, -0.15, 0.0), Vector3(0.2, 0.15, 0.01)),
          box(Vector3(-0.2, -0.15, 0.01), Vector3(-0.19, 0.15, 0.2)),
          box(Vector3(0.19, -0.15, 0.01), Vector3(0.2, 0.15, 0.2)),
          box(Vector3(-0.2, -0.15, 0.0), Vector3(0.2, -0.14, 0.2)),
          box(Vector3(-0.2, 0.14, 0.0), Vector3(0.2, 0.15, 0.2))};
}

TEST(SceneWithAMesh, TakesAToteOfFiveClosedBoxesAsOneInSilence) {
  MeshPart tote = joined(tote_of_boxes());
  EXPECT_EQ(scene_with(tote).bodies.back().shapes.size(), 5U);
  EXPECT_TRUE(scene_with(tote).warnings.empty());
  Rng rng(8);
  for (std::array<int, 3>& triangle : tote.triangles)
    if (rng.uniform(0.0, 1.0) < 0.5) std::swap(triangle[1], triangle[2]);
  EXPECT_EQ(scene_with(tote).bodies.back().shapes.size(), 5U) << "wound as it comes";
  EXPECT_TRUE(scene_with(tote).warnings.empty());
}

}  // namespace
}  // namespace snug::model
