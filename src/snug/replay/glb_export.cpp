// GlbExport: the document, its binary part, and which bodies are in it. Numbers in brackets are sections of the
// glTF 2.0 specification (Khronos Group, version 2.0.1).
#include "snug/replay/glb_export.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"
#include "snug/replay/internal/body_colours.hpp"
#include "snug/replay/internal/glb_mesh.hpp"
#include "snug/replay/internal/instant.hpp"
#include "snug/replay/internal/mcap_messages.hpp"
#include "snug/replay/internal/recorded_scenario.hpp"
#include "snug/replay/internal/robot_look.hpp"

namespace snug::replay {
namespace {

using internal::GlbMesh;
using internal::GlbPart;
using internal::Json;

constexpr std::size_t kMostGlbTriangles = 200'000;                ///< of the robot's meshes
constexpr int kArrayBuffer = 34962, kElementArrayBuffer = 34963;  // [5.11.5]
constexpr int kFloat = 5126, kUnsignedInt = 5125;                 // [5.1.3]

static_assert(std::endian::native == std::endian::little, "numbers of glTF are little endian [3.6.2]");

/// Grows a document and its binary part.
class GlbDocument {
 public:
  GlbDocument(const std::string& generator, Json extras) {
    document_["asset"] = {{"version", "2.0"}, {"generator", generator}};
    document_["scene"] = 0;
    document_["scenes"] = Json::array({{{"nodes", Json::array({0})}, {"extras", std::move(extras)}}});
    // The y axis of glTF is up [3.4]; ours is z.
    const double half = std::sqrt(0.5);
    document_["nodes"] = Json::array({{{"name", "W"}, {"rotation", {-half, 0.0, 0.0, half}}}});
  }

  /// A body at X in the frame of the root; nothing for one without triangles.
  void add_body(const std::string& name, const record::PoseSample& X, const GlbMesh& mesh, Json extras = {}) {
    Json primitives = Json::array();
    for (const GlbPart& part : mesh) {
      if (part.triangles.empty()) continue;
      primitives.push_back({{"attributes", {{"POSITION", add_positions(part)}}},
                            {"indices", add_indices(part)},
                            {"material", material_of(part.rgba)}});
      triangles_ += part.triangles.size();
    }
    if (primitives.empty()) return;
    document_["meshes"].push_back({{"name", name}, {"primitives", std::move(primitives)}});
    const Quaternion q = X.quat.normalized();
    Json node = {{"name", name},
                 {"mesh", document_["meshes"].size() - 1},
                 {"translation", {X.p.x(), X.p.y(), X.p.z()}},
                 {"rotation", {q.x(), q.y(), q.z(), q.w()}}};
    if (!extras.empty()) node["extras"] = std::move(extras);
    document_["nodes"][0]["children"].push_back(document_["nodes"].size());
    document_["nodes"].push_back(std::move(node));
    ++bodies_;
  }

  [[nodiscard]] std::size_t bodies() const { return bodies_; }
  [[nodiscard]] std::size_t triangles() const { return triangles_; }

  /// The whole file [4.4]: a header, the document, the binary part; each in multiples of four bytes. Empty when that is
  /// more than its 32-bit sizes can tell.
  [[nodiscard]] std::string bytes() {
    if (!binary_.empty()) document_["buffers"] = Json::array({{{"byteLength", binary_.size()}}});
    std::string text = internal::to_text(document_);
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const std::size_t size = 12 + 8 + text.size() + (binary_.empty() ? 0 : 8 + binary_.size());
    if (size > std::numeric_limits<std::uint32_t>::max()) return "";
    std::string file = "glTF";
    file.reserve(size);
    put(file, 2U);
    put(file, static_cast<std::uint32_t>(size));
    put(file, static_cast<std::uint32_t>(text.size()));
    file += "JSON" + text;
    if (binary_.empty()) return file;
    put(file, static_cast<std::uint32_t>(binary_.size()));
    file.append("BIN\0", 4);
    return file + binary_;
  }

 private:
  template <class Number>
  static void put(std::string& bytes, Number number) {
    char raw[sizeof number];
    std::memcpy(raw, &number, sizeof number);
    bytes.append(raw, sizeof number);
  }

  /// A piece of the binary part, whose place is a multiple of four: all numbers have four bytes.
  std::size_t add_view(std::size_t begin, int target) {
    document_["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", binary_.size() - begin}, {"target", target}});
    return document_["bufferViews"].size() - 1;
  }
  std::size_t add_accessor(Json accessor) {
    document_["accessors"].push_back(std::move(accessor));
    return document_["accessors"].size() - 1;
  }

  std::size_t add_positions(const GlbPart& part) {
    const std::size_t begin = binary_.size();
    std::array<float, 3> low = part.vertices.front(), high = low;
    for (const std::array<float, 3>& vertex : part.vertices) {
      for (std::size_t k = 0; k < 3; ++k) {
        put(binary_, vertex[k]);
        low[k] = std::min(low[k], vertex[k]);
        high[k] = std::max(high[k], vertex[k]);
      }
    }
    const std::size_t view = add_view(begin, kArrayBuffer);
    return add_accessor({{"bufferView", view},
                         {"componentType", kFloat},
                         {"count", part.vertices.size()},
                         {"type", "VEC3"},
                         {"min", low},
                         {"max", high}});
  }
  std::size_t add_indices(const GlbPart& part) {
    const std::size_t begin = binary_.size();
    for (const std::array<std::uint32_t, 3>& triangle : part.triangles)
      for (const std::uint32_t corner : triangle) put(binary_, corner);
    const std::size_t view = add_view(begin, kElementArrayBuffer);
    return add_accessor({{"bufferView", view},
                         {"componentType", kUnsignedInt},
                         {"count", 3 * part.triangles.size()},
                         {"type", "SCALAR"}});
  }

  std::size_t material_of(const robot::Rgba& rgba) {
    const auto found = std::ranges::find(colours_, rgba);
    if (found != colours_.end()) return static_cast<std::size_t>(found - colours_.begin());
    colours_.push_back(rgba);
    // Base colours are linear [3.9.2]; ours are those of a screen (IEC 61966-2-1).
    const auto linear = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
    Json material = {{"pbrMetallicRoughness",
                      {{"baseColorFactor", {linear(rgba[0]), linear(rgba[1]), linear(rgba[2]), rgba[3]}},
                       {"metallicFactor", 0.0},
                       {"roughnessFactor", 0.8}}},
                     {"doubleSided", true}};
    if (rgba[3] < 1.0) material["alphaMode"] = "BLEND";
    document_["materials"].push_back(std::move(material));
    return colours_.size() - 1;
  }

  Json document_;
  std::string binary_;
  std::vector<robot::Rgba> colours_;
  std::size_t bodies_ = 0, triangles_ = 0;
};

/// Does a box lie in the container, or on the pallet? Not one that the cup holds over it.
bool is_packed(const record::RecordingHeader& header, const record::Frame& frame, std::size_t body) {
  if (header.bodies[body].kind != record::BodyKind::Dynamic || frame.cup.attached_body == static_cast<int>(body))
    return false;
  const Pose X_WI = header.container.X_WT.pose() * header.container.X_TI.pose();
  const Vector3 p_I = X_WI.inverse() * (frame.bodies[body].X_WB.pose() * header.bodies[body].com);
  const Vector3& size = header.container.inner_size;
  return std::abs(p_I.x()) <= 0.5 * size.x() && std::abs(p_I.y()) <= 0.5 * size.y() && p_I.z() >= 0.0;
}

/// What of an instant is drawn.
class GlbScene {
 public:
  GlbScene(const record::RecordingHeader& header, const record::Frame& frame, const GlbSettings& settings,
           const RobotDescription& robot)
      : header_(header), frame_(frame), is_load_(settings.load_only) {
    if (!is_load_) looks_ = internal::find_looks(header, robot, kMostGlbTriangles);
  }

  void add_to(GlbDocument& document) const {
    for (std::size_t i = 0; i < header_.bodies.size(); ++i) {
      const record::BodyInfo& body = header_.bodies[i];
      const bool is_container = body.name == header_.container.name;
      if (!frame_.bodies[i].present || (is_load_ && !is_container && !is_packed(header_, frame_, i))) continue;
      document.add_body(body.name, placed(frame_.bodies[i].X_WB), look_of(i, is_container), told_of(body));
    }
    if (!is_load_) add_cup_to(document);
  }

 private:
  [[nodiscard]] record::PoseSample placed(const record::PoseSample& X_WB) const {
    if (!is_load_) return X_WB;
    return header_.container.X_WT.pose().inverse() * X_WB.pose();
  }

  [[nodiscard]] GlbMesh look_of(std::size_t body, bool is_container) const {
    GlbMesh mesh;
    const auto look = std::ranges::find(looks_, static_cast<int>(body), &internal::LinkLook::body);
    if (look != looks_.end()) {
      for (const robot::Visual& visual : look->visuals) internal::add_glb_visual(mesh, visual);
      return mesh;
    }
    const record::BodyInfo& info = header_.bodies[body];
    for (const record::ShapeInfo& shape : info.shapes)
      internal::add_glb_shape(mesh, shape, internal::body_colour(info, is_container));
    return mesh;
  }

  static Json told_of(const record::BodyInfo& body) {
    if (body.kind != record::BodyKind::Dynamic) return {};
    return {{"type", body.type}, {"mass_kg", body.mass}};
  }

  void add_cup_to(GlbDocument& document) const {
    const auto scenario = internal::scenario_of(header_);
    if (!scenario || !scenario->tool) return;
    const bool holds = frame_.cup.attached_body >= 0;
    const Pose X_ES =
        holds ? frame_.cup.X_ES.pose() : Pose{Matrix3::Identity(), Vector3(0.0, 0.0, scenario->cup.free_length)};
    GlbMesh mesh;
    internal::add_glb_cup(mesh, X_ES, scenario->cup.lip_radius, holds ? internal::kCupHolds : internal::kCupFree);
    document.add_body("cup", frame_.X_WE, mesh);
  }

  const record::RecordingHeader& header_;
  const record::Frame& frame_;
  bool is_load_;
  std::vector<internal::LinkLook> looks_;
};

}  // namespace

GlbTotals export_glb(record::RecordingReader& reader, const std::string& name, const GlbSettings& settings,
                     OutputFile file, const RobotDescription& robot) {
  const record::RecordingHeader& header = reader.header();
  if (reader.times().empty()) throw InputError(name, "", "a recording without frames", "at least one frame");
  if (settings.load_only && header.container.name.empty())
    throw InputError(name, "", "a recording without a container", "one of a cell that packs");
  record::Frame frame;
  reader.read_frame(internal::nearest_frame(reader.times(), settings.time), frame);
  GlbDocument document("snug " + header.version, {{"recording", name}, {"time_s", frame.time}});
  GlbScene(header, frame, settings, robot).add_to(document);
  const std::string bytes = document.bytes();
  if (bytes.empty()) throw InputError(name, "", "more than 4 GiB of triangles", "a recording of fewer shapes");
  write_file(std::move(file), bytes);
  return {frame.time, document.bodies(), document.triangles(), bytes.size()};
}

std::string to_text(const GlbTotals& totals) {
  return fmt::format("{} bodies at {:.3f} s, {} triangles, {:.2f} MB", totals.bodies, totals.time, totals.triangles,
                     static_cast<double>(totals.bytes) / 1e6);
}

}  // namespace snug::replay
