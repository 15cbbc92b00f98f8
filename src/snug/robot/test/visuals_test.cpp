// Visuals: shapes, materials and meshes of a URDF as they are drawn; what cannot be drawn is left out and fails
// nothing.
#include "snug/robot/visuals.hpp"
#include "snug/core/test/scratch_folder.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "snug/core/input_error.hpp"

namespace snug::robot {
namespace {

/// One triangle of 1 m, as STL.
constexpr const char* kTriangle =
    "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
    "t\n";

std::string robot_drawn_with(const std::string& visuals) {
  return "<robot name='r'><material name='blue'><color rgba='0 0 1 1'/></material><link name='arm'>" + visuals +
         "</link></robot>";
}

TEST(Visuals, HaveShapesPosesAndColoursOfMaterialsByName) {
  const auto links = parse_visuals(
      robot_drawn_with(
          "<visual><origin xyz='1 2 3'/><geometry><box size='2 4 6'/></geometry><material name='blue'/></visual>"
          "<visual><geometry><sphere radius='0.5'/></geometry></visual>"),
      {});
  ASSERT_EQ(links.size(), 1U);
  EXPECT_EQ(links[0].link, "arm");
  ASSERT_EQ(links[0].visuals.size(), 2U);
  const Visual& box = links[0].visuals[0];
  EXPECT_EQ(box.X_LG.p, Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(std::get<geometry::Box>(box.shape).half, Vector3(1.0, 2.0, 3.0));
  EXPECT_EQ(box.rgba, (Rgba{0.0, 0.0, 1.0, 1.0}));
  EXPECT_EQ(std::get<geometry::Capsule>(links[0].visuals[1].shape).half_length, 0.0);
  EXPECT_EQ(links[0].visuals[1].rgba, kPlainLink);
}

TEST(Visuals, OfMeshesAreTrianglesScaledAsTheUrdfSays) {
  const auto links = parse_visuals(
      robot_drawn_with("<visual><geometry><mesh filename='t.stl' scale='0.5 0.5 0.5'/></geometry></visual>"),
      {{"t.stl", kTriangle}});
  ASSERT_EQ(links.size(), 1U);
  const auto& mesh = std::get<model::DrawnMesh>(links[0].visuals.at(0).shape);
  EXPECT_EQ(mesh.triangles.size(), 1U);
  double reach = 0.0;
  for (const Vector3& v : mesh.vertices) reach = std::max(reach, v.norm());
  EXPECT_DOUBLE_EQ(reach, 0.5);
}

TEST(Visuals, LeaveOutWhatCannotBeDrawn) {
  for (const char* visual : {"<visual><geometry><mesh filename='none.stl'/></geometry></visual>", "<visual/>",
                             "<visual><geometry><box size='1 nan 1'/></geometry></visual>",
                             "<visual><geometry><sphere radius='-1'/></geometry></visual>",
                             "<visual><geometry><cone/></geometry></visual>"}) {
    EXPECT_TRUE(parse_visuals(robot_drawn_with(visual), {}).empty()) << visual;
  }
  EXPECT_TRUE(parse_visuals("no XML", {}).empty());
  EXPECT_TRUE(parse_visuals("", {}).empty());
  EXPECT_TRUE(parse_visuals(robot_drawn_with("<visual><geometry><mesh filename='t.stl'/></geometry></visual>"),
                            {{"t.stl", "broken"}})
                  .empty());
}

TEST(Visuals, ReadEachMeshFileOnceAndNoneBeyondTheLimit) {
  const snug::test::ScratchFolder folder;
  std::ofstream(folder / "t.stl") << kTriangle;
  const std::string mesh = "<visual><geometry><mesh filename='t.stl'/></geometry></visual>";
  std::ofstream(folder / "r.urdf") << robot_drawn_with(
      mesh + mesh + "<visual><geometry><mesh filename='none.stl'/></geometry></visual>");
  const auto files = read_visual_meshes(folder / "r.urdf", 1000);
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(files[0].name, "t.stl");
  EXPECT_EQ(files[0].bytes, kTriangle);
  EXPECT_TRUE(read_visual_meshes(folder / "r.urdf", 10).empty());
  EXPECT_THROW((void)read_visual_meshes(folder / "absent.urdf", 1000), InputError);
}

// Meshes and the text go into pages and exports that are given away.
TEST(Visuals, TakeNoFileThatIsNoMeshAndNoUrdf) {
  const snug::test::ScratchFolder folder;
  std::ofstream(folder / "secret") << "a key";
  std::ofstream(folder / "secret.txt") << "a key";
  const std::string meshes =
      "<visual><geometry><mesh filename='secret'/></geometry></visual>"
      "<visual><geometry><mesh filename='secret.txt'/></geometry></visual>"
      "<visual><geometry><mesh filename='./secret'/></geometry></visual>";
  std::ofstream(folder / "r.urdf") << robot_drawn_with(meshes);
  EXPECT_TRUE(read_visual_meshes(folder / "r.urdf", 1000).empty());
  for (const char* text : {"", "a key", "<html/>", "<robot>"}) {
    std::ofstream(folder / "other.urdf") << text;
    EXPECT_THROW((void)read_visual_meshes(folder / "other.urdf", 1000), InputError) << text;
  }
}

}  // namespace
}  // namespace snug::robot
