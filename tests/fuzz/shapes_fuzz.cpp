// What scenes are made of beside their file: paths of kinematic bodies (CSV) and meshes (OBJ, STL, DAE), by the first
// byte.
#include "fuzz.hpp"
#include "snug/model/mesh_file.hpp"
#include "snug/model/pose_path.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  if (size == 0) return 0;
  const std::string_view text = fuzz::text_of(data + 1, size - 1);
  if (data[0] == 'p') {
    fuzz::expect_answer([&] { (void)model::parse_pose_path(text, "x.csv", Pose{}); });
    return 0;
  }
  const char* const ending = data[0] == 's' ? ".stl" : data[0] == 'd' ? ".dae" : ".obj";
  for (const model::DrawnMesh& mesh : model::parse_drawn_meshes(text, ending)) {
    const auto count = static_cast<int>(mesh.vertices.size());
    for (const std::array<int, 3>& corners : mesh.triangles)
      for (const int corner : corners) SNUG_CHECK(corner >= 0 && corner < count, "corners are vertices");
    if (mesh.vertices.size() < 1000) (void)model::make_simple_hull(mesh.vertices);
  }
  return 0;
}
