// GLB files: their framing, closed bodies of the right volume, what stands where, and what of a cell is the load. That
// others read them is tested in viewer/test/export/glb.test.ts.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/glb_export.hpp"
#include "snug/replay/internal/glb_mesh.hpp"
#include "snug/replay/test/scratch.hpp"

namespace snug::replay {
namespace {

using internal::GlbMesh;
using internal::GlbPart;

Vector3 glb_vertex(const GlbPart& part, std::uint32_t i) {
  const auto& v = part.vertices.at(i);
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

/// By the divergence theorem: right only where all triangles turn outwards.
double glb_volume(const GlbMesh& mesh) {
  double sum = 0.0;
  for (const GlbPart& part : mesh)
    for (const auto& t : part.triangles)
      sum += glb_vertex(part, t[0]).dot(glb_vertex(part, t[1]).cross(glb_vertex(part, t[2]))) / 6.0;
  return sum;
}

/// Each edge is there once in each direction.
bool is_closed(const GlbPart& part) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (const auto& t : part.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
  for (const auto& [edge, count] : edges)
    if (count != 1 || !edges.contains({edge.second, edge.first})) return false;
  return !edges.empty();
}

TEST(GlbMesh, ClosesEveryShapeAndTurnsItsTrianglesOutwards) {
  record::ShapeInfo box, capsule, cylinder, hull;
  box.half = {0.1, 0.2, 0.05};
  capsule.kind = record::ShapeKind::Capsule;
  cylinder.kind = record::ShapeKind::Cylinder;
  capsule.radius = cylinder.radius = 0.3;
  capsule.half_length = cylinder.half_length = 0.4;
  hull.kind = record::ShapeKind::Hull;
  hull.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  // A prism of n sides in a circle has sin(2 pi / n) / (2 pi / n) of its area; of a ball's latitudes less is lost.
  const double pi = std::numbers::pi, prism = std::sin(pi / 16) / (pi / 16) * pi * 0.09 * 0.8;
  const double ball = 4.0 / 3.0 * pi * 0.027;
  Rng rng = Rng(5).split("glb shapes");
  for (auto& [shape, least, most] :
       {std::tuple{box, 0.008, 0.008}, std::tuple{cylinder, prism, prism},
        std::tuple{capsule, prism + 0.96 * ball, prism + ball}, std::tuple{hull, 1.0 / 6.0, 1.0 / 6.0}}) {
    record::ShapeInfo turned = shape;
    turned.X_BG = test::random_pose(rng);
    GlbMesh mesh;
    add_glb_shape(mesh, turned, robot::kPlainLink);
    ASSERT_EQ(mesh.size(), 1u);
    EXPECT_TRUE(is_closed(mesh[0]));
    EXPECT_GE(glb_volume(mesh), least * (1.0 - 1e-5));  // single precision within 2 m
    EXPECT_LE(glb_volume(mesh), most * (1.0 + 1e-5));
  }
  GlbMesh cup;
  internal::add_glb_cup(cup, Pose{Matrix3::Identity(), {0.0, 0.01, 0.06}}, 0.035, robot::kPlainLink);
  EXPECT_TRUE(is_closed(cup[0]));
  EXPECT_GT(glb_volume(cup), 0.0);
}

/// A file read again: [4.4] of the specification.
struct Glb {
  nlohmann::json document;
  std::string binary;
};

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.substr(at, 4).data(), 4);
  return word;
}

Glb read_glb(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  const std::string bytes = text.str();
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word_at(bytes, 4), 2u);
  EXPECT_EQ(word_at(bytes, 8), bytes.size());
  const std::size_t json = word_at(bytes, 12);
  EXPECT_EQ(json % 4, 0u);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  Glb glb{nlohmann::json::parse(bytes.substr(20, json)), {}};
  if (bytes.size() == 20 + json) return glb;
  EXPECT_EQ(word_at(bytes, 20 + json), bytes.size() - 28 - json);
  EXPECT_EQ(bytes.substr(24 + json, 4), std::string("BIN\0", 4));
  glb.binary = bytes.substr(28 + json);
  EXPECT_EQ(glb.document["buffers"][0]["byteLength"], glb.binary.size());
  return glb;
}

std::vector<std::string> names_in(const Glb& glb) {
  std::vector<std::string> names;
  for (const auto& child : glb.document["nodes"][0].value("children", nlohmann::json::array()))
    names.push_back(glb.document["nodes"][child.get<std::size_t>()]["name"]);
  return names;
}

/// The recording in a file, and what is exported of it.
class GlbExport : public ::testing::Test {
 protected:
  Glb exported(const record::Recording& recording, const GlbSettings& settings) {
    const std::filesystem::path path = folder_ / "run.h5", out = folder_ / "run.glb";
    record::RecordingWriter writer(OutputFile(path), recording.header);
    for (const record::Frame& frame : recording.frames) writer.append(frame);
    writer.close();
    record::RecordingReader reader(path);
    totals_ = export_glb(reader, "run.h5", settings, OutputFile(out));
    return read_glb(out);
  }
  test::ScratchFolder folder_;
  GlbTotals totals_;
};

TEST_F(GlbExport, PutsEachBodyThatIsThereWhereTheFrameNearestToTheTimeHasIt) {
  Rng rng = Rng(6).split("glb");
  const record::Recording recording = test::random_recording(rng, 10);
  const Glb glb = exported(recording, {recording.frames[7].time + 0.003, false});
  EXPECT_EQ(totals_.time, recording.frames[7].time);
  EXPECT_EQ(names_in(glb), (std::vector<std::string>{"table", "tool", "BOX001", "BOX002"}));
  EXPECT_EQ(totals_.bodies, 4u);
  // The root turns our z to the y of glTF, ours -y to its z.
  const auto& root = glb.document["nodes"][0]["rotation"];
  const Quaternion up(root[3].get<double>(), root[0].get<double>(), root[1].get<double>(), root[2].get<double>());
  EXPECT_LT((up * Vector3::UnitZ() - Vector3::UnitY()).norm(), 1e-15);
  EXPECT_LT((up * -Vector3::UnitY() - Vector3::UnitZ()).norm(), 1e-15);
  for (std::size_t i = 0; i < 4; ++i) {
    const auto& node = glb.document["nodes"][i + 1];
    const record::PoseSample& X = recording.frames[7].bodies[i].X_WB;
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(node["translation"][k], X.p[static_cast<Eigen::Index>(k)]);
      EXPECT_NEAR(node["rotation"][k], X.quat.vec()[static_cast<Eigen::Index>(k)], 1e-15);
    }
  }
  EXPECT_EQ(glb.document["nodes"][3]["extras"]["mass_kg"], 0.5);
  EXPECT_EQ(names_in(exported(recording, {recording.frames[0].time, false})).size(), 3u);  // BOX002 comes later
  EXPECT_EQ(totals_.time, recording.frames[0].time);
  (void)exported(recording, {});
  EXPECT_EQ(totals_.time, recording.frames.back().time);
}

TEST_F(GlbExport, TellsTheExtentOfItsVertices) {
  Rng rng = Rng(7).split("glb");
  const Glb glb = exported(test::random_recording(rng, 3), {});
  for (const auto& accessor : glb.document["accessors"]) {
    const auto& view = glb.document["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const std::size_t begin = view["byteOffset"], size = view["byteLength"], count = accessor["count"];
    const bool is_vector = accessor["type"] == "VEC3";
    ASSERT_EQ(size, count * (is_vector ? 12 : 4));
    ASSERT_LE(begin + size, glb.binary.size());
    if (!is_vector) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      float low = 1e9F, high = -1e9F;
      for (std::size_t i = 0; i < count; ++i) {
        float x = 0.0F;
        std::memcpy(&x, glb.binary.data() + begin + 12 * i + 4 * k, 4);
        low = std::min(low, x);
        high = std::max(high, x);
      }
      EXPECT_EQ(accessor["min"][k].get<float>(), low);
      EXPECT_EQ(accessor["max"][k].get<float>(), high);
    }
  }
}

TEST_F(GlbExport, OfTheLoadHasTheContainerAndWhatLiesInIt) {
  Rng rng = Rng(8).split("glb");
  record::Recording recording = test::random_recording(rng, 1);
  recording.header.container = {"table", {{1.0, 2.0, 0.5}, Quaternion(0.0, 0.0, 0.0, 1.0)}, {}, {0.6, 0.4, 0.3}};
  record::Frame& frame = recording.frames[0];
  frame.cup.attached_body = -1;
  frame.bodies[0].X_WB = recording.header.container.X_WT;
  frame.bodies[2].X_WB = record::PoseSample({1.2, 1.9, 0.6}, Quaternion::Identity());
  frame.bodies[3] = frame.bodies[2];
  EXPECT_EQ(names_in(exported(recording, {{}, true})), (std::vector<std::string>{"table", "BOX001", "BOX002"}));
  const Glb glb = exported(recording, {{}, true});
  const auto& middle = glb.document["nodes"][2]["translation"];  // in T, which is turned half about z
  EXPECT_NEAR(middle[0], -0.2, 1e-12);
  EXPECT_NEAR(middle[1], 0.1, 1e-12);
  EXPECT_NEAR(middle[2], 0.1, 1e-12);
  frame.cup.attached_body = 2;  // still on the cup
  frame.bodies[3].X_WB.p.x() = 1.31;
  EXPECT_EQ(names_in(exported(recording, {{}, true})), (std::vector<std::string>{"table"}));
  recording.header.container = {};
  EXPECT_THROW((void)exported(recording, {{}, true}), InputError);
}

TEST_F(GlbExport, HasTheSameBytesEachTime) {
  Rng rng = Rng(9).split("glb");
  const record::Recording recording = test::random_recording(rng, 2);
  const Glb once = exported(recording, {}), twice = exported(recording, {});
  EXPECT_EQ(once.document, twice.document);
  EXPECT_EQ(once.binary, twice.binary);
}

}  // namespace
}  // namespace snug::replay
