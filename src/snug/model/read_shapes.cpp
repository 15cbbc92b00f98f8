// Reading poses, shapes and inertias of a scenario.
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "snug/geometry/convex_hull.hpp"
#include "snug/model/internal/scenario_reader.hpp"
#include "snug/model/internal/side_file.hpp"
#include "snug/model/mass_properties.hpp"
#include "snug/model/mesh_file.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::model::internal {
namespace {

const std::vector<std::string> kRotationKeys = {"yaw_deg", "rpy_deg", "quat_wxyz", "rotation_vector"};

Matrix3 rotation_about_z(double angle) {
  // Exact for quarter turns: walls that should be flush are flush.
  const double quarter = angle / (0.5 * std::numbers::pi);
  const bool is_quarter = std::abs(quarter - std::round(quarter)) < 1e-12;
  const double c = is_quarter ? std::round(std::cos(angle)) : std::cos(angle);
  const double s = is_quarter ? std::round(std::sin(angle)) : std::sin(angle);
  Matrix3 R;
  R << c, -s, 0, s, c, 0, 0, 0, 1;
  return R;
}

Matrix3 rotation_from_rpy(const Value& value) {
  const std::vector<Value> parts = value.list_of(3, "angles in degrees");
  const Vector3 roll(parts[0].radians_from_degrees(), 0, 0);
  const Vector3 pitch(0, parts[1].radians_from_degrees(), 0);
  return rotation_about_z(parts[2].radians_from_degrees()) * exp_rotation(pitch) * exp_rotation(roll);
}

Matrix3 rotation_from_quaternion(const Value& value) {
  const std::vector<Value> parts = value.list_of(4, "numbers (w, x, y, z)");
  const Eigen::Vector4d wxyz(parts[0].number(), parts[1].number(), parts[2].number(), parts[3].number());
  const double norm = wxyz.norm();
  // Hand-written quaternions carry three digits or more.
  if (!(std::abs(norm - 1.0) <= 1e-3)) value.fail("norm " + to_text(norm), "a quaternion of norm 1 (w, x, y, z)");
  return Quaternion(wxyz(0) / norm, wxyz(1) / norm, wxyz(2) / norm, wxyz(3) / norm).toRotationMatrix();
}

Pose read_pose_map(const MapReader& map) {
  Pose X;
  if (const auto position = map.find("position")) X.p = position->position();
  X.R = read_rotation(map);
  return X;
}

geometry::Shape read_capsule(const Value& value) {
  const MapReader map = value.map("capsule", {"length", "radius"});
  const double length = map.require("length").number_within(0.0, kLargestSize, "a length in metres");
  return geometry::Capsule{0.5 * length, map.require("radius").size()};
}

geometry::Shape read_cylinder(const Value& value) {
  const MapReader map = value.map("cylinder", {"length", "radius"});
  return geometry::Cylinder{0.5 * map.require("length").size(), map.require("radius").size()};
}

/// A mesh whose hull holds more than it encloses by this fraction of the hull is said to be concave.
constexpr double kConcave = 0.01;

/// What the hull that stands for a piece fills in, or nothing.
std::optional<std::string> describe_filled(const MeshPart& piece, const geometry::ConvexHull& hull) {
  const SurfaceMeasures solid = measure_surface(hull);
  const SurfaceMeasures surface = measure_surface(piece);
  const auto litres = [](double volume) { return fmt::format("{:.3g} l", 1e3 * volume); };
  const std::string filled = "its convex hull of " + litres(solid.volume) + ", which is what bodies touch,";
  if (surface.is_closed) {
    const double lost = 1.0 - std::abs(surface.volume) / solid.volume;
    if (!(lost > kConcave)) return std::nullopt;
    return fmt::format("encloses {}; {} fills hollows of {} ({:.0f} %)", litres(std::abs(surface.volume)), filled,
                       litres(lost * solid.volume), 100.0 * lost);
  }
  if (std::abs(surface.area / solid.area - 1.0) <= kConcave) return std::nullopt;
  return "is no closed surface, and " + filled + " may fill hollows";
}

/// The convex hulls of the loose pieces of each part of a mesh file.
std::vector<geometry::Shape> read_mesh(const Value& value) {
  constexpr std::size_t kMostParts = 64;
  const std::string expected = "a mesh file (STL, OBJ, DAE)";
  const MapReader map = value.map("mesh", {"file", "scale"});
  const Value file = map.require("file");
  const std::filesystem::path path = find_side_file(file, expected);
  check_side_file(path, kLargestMesh, expected);
  const auto given = map.find("scale");
  const double scale = given ? given->number_within(1e-6, 1e6, "a factor") : 1.0;
  MeshParts mesh = read_mesh_parts(path);
  if (!mesh.error.empty()) file.fail(quote(path.string()) + ": " + mesh.error, expected);
  if (mesh.parts.empty() || mesh.parts.size() > kMostParts)
    file.fail(std::to_string(mesh.parts.size()) + " parts in " + quote(path.string()),
              "1 to " + std::to_string(kMostParts));
  std::vector<geometry::Shape> hulls;
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    double extent = 0.0;
    for (Vector3& point : mesh.parts[i].points) extent = std::max(extent, (point *= scale).norm());
    const std::string part = "part " + std::to_string(i + 1) + " of " + quote(path.string());
    if (!(extent <= kLargestSize))
      file.fail(part + ", which reaches " + to_text(extent) + " m", "metres; for millimetres give scale: 0.001");
    // What is left of the 64 after one for each later part.
    const std::size_t most = kMostParts - std::min(kMostParts - 1, hulls.size() + mesh.parts.size() - i - 1);
    const std::vector<MeshPart> pieces = split_loose_pieces(mesh.parts[i], most);
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      auto hull = make_simple_hull(pieces[k].points);
      if (!hull) file.fail(part + ", which spans no volume", "parts with a volume");
      if (const auto filled = describe_filled(pieces[k], *hull)) {
        const std::string piece = pieces.size() == 1 ? "" : fmt::format(", loose piece {},", k + 1);
        file.document().warnings.push_back(fmt::format(
            "{}: part {} of {}{} {}; cut it into convex pieces that are closed and share no corner, or write `shapes`",
            file.path(), i + 1, quote(path.filename().string()), piece, *filled));
      }
      hulls.emplace_back(*std::move(hull));
    }
  }
  return hulls;
}

geometry::Shape read_hull(const Value& value) {
  std::vector<Vector3> points;
  for (const Value& point : value.list()) points.push_back(point.position());
  constexpr std::size_t kMostPoints = 200;
  const std::string expected = "4 to " + std::to_string(kMostPoints) + " points that span a volume and leave at most " +
                               std::to_string(geometry::kMaxHullVertices) + " corners";
  if (points.size() < 4 || points.size() > kMostPoints) value.fail(expected);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if ((points[i] - points[j]).norm() > kLargestSize) value.fail("points no more than 100 m apart");
  auto hull = geometry::make_convex_hull(points);
  if (!hull && hull.error() == geometry::NoHull::TooManyVertices) value.fail("too many corners", expected);
  if (!hull) value.fail("points in one plane, on one line or in one place", expected);
  return *std::move(hull);
}

}  // namespace

std::vector<std::string> pose_keys() {
  std::vector<std::string> keys = kRotationKeys;
  keys.insert(keys.begin(), "position");
  return keys;
}

Matrix3 read_rotation(const MapReader& map) {
  for (std::size_t i = 0; i < kRotationKeys.size(); ++i)
    for (std::size_t j = i + 1; j < kRotationKeys.size(); ++j) map.forbid_together(kRotationKeys[i], kRotationKeys[j]);
  if (const auto yaw = map.find("yaw_deg")) return rotation_about_z(yaw->radians_from_degrees());
  if (const auto rpy = map.find("rpy_deg")) return rotation_from_rpy(*rpy);
  if (const auto quat = map.find("quat_wxyz")) return rotation_from_quaternion(*quat);
  if (const auto turn = map.find("rotation_vector")) return exp_rotation(turn->position());
  return Matrix3::Identity();
}

Pose read_local_pose(const std::optional<Value>& value) {
  if (!value) return {};
  return read_pose_map(value->map("pose", pose_keys()));
}

Pose ScenarioReader::read_world_pose(const std::optional<Value>& value) const {
  if (!value) return {};
  std::vector<std::string> keys = pose_keys();
  keys.emplace_back("frame");
  const MapReader map = value->map("pose", keys);
  const Pose X_FG = read_pose_map(map);
  const auto frame = map.find("frame");
  if (!frame) return X_FG;
  return read_frame_name(*frame) * X_FG;
}

Pose ScenarioReader::read_frame_name(const Value& value) const {
  const std::string name = value.name();
  for (const Frame& known : scenario_.frames)
    if (known.name == name) return known.X_WF;
  fail_unknown_name(value, "frame", names_of(scenario_.frames, [](const Frame& f) { return f.name; }));
}

namespace {

void read_shape(const Value& value, std::vector<PlacedShape>& shapes) {
  const std::vector<std::string> forms = {"box", "capsule", "cylinder", "hull", "mesh"};
  std::vector<std::string> keys = forms;
  keys.emplace_back("pose");
  const MapReader map = value.map("shape", keys);
  const std::string form = map.require_one_of(forms);
  const Value given = map.require(form);
  const Pose X_BG = read_local_pose(map.find("pose"));
  if (form == "box") shapes.push_back({geometry::Box{0.5 * given.sizes()}, X_BG});
  if (form == "capsule") shapes.push_back({read_capsule(given), X_BG});
  if (form == "cylinder") shapes.push_back({read_cylinder(given), X_BG});
  if (form == "hull") shapes.push_back({read_hull(given), X_BG});
  if (form != "mesh") return;
  for (geometry::Shape& hull : read_mesh(given)) shapes.push_back({std::move(hull), X_BG});
}

}  // namespace

std::vector<PlacedShape> read_shapes(const Value& value) {
  std::vector<PlacedShape> shapes;
  for (const Value& part : value.list()) read_shape(part, shapes);
  if (shapes.empty()) value.fail("at least one shape");
  return shapes;
}

Matrix3 read_inertia(const Value& value) {
  const std::vector<Value> parts = value.list();
  if (parts.size() != 3 && parts.size() != 6)
    value.fail("3 principal moments, or 6 numbers xx, yy, zz, xy, xz, yz, in kg m^2");
  std::array<double, 6> e{};
  for (std::size_t i = 0; i < parts.size(); ++i) e[i] = parts[i].number(i < 3 ? Range::Positive : Range::Any);
  Matrix3 inertia;
  inertia << e[0], e[3], e[4], e[3], e[1], e[5], e[4], e[5], e[2];
  const Vector3 moments = symmetric_eigenpairs(inertia).values;
  const std::string got =
      "principal moments " + to_text(moments(0)) + ", " + to_text(moments(1)) + ", " + to_text(moments(2));
  // Eigenvalues ascend. A flat plate meets the triangle inequality with equality; 1e-6 leaves room for its rounding.
  if (!(moments(0) > 1e-12 * moments(2))) value.fail(got, "a positive definite inertia");
  if (!(moments(2) <= (moments(0) + moments(1)) * (1.0 + 1e-6)))
    value.fail(got, "the triangle inequality: no moment larger than the sum of the other two");
  return inertia;
}

void fail_unknown_name(const Value& value, const std::string& what, const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  const std::string word = value.name();
  const std::string_view nearest = find_nearest(word, names);
  value.fail("the " + what + (nearest.empty() ? "" : " " + quote(nearest) + " (nearest)") +
             (names.empty() ? ", but none is defined" : "; defined are " + all));
}

void check_new_name(const Value& value, const std::string& what, bool is_taken) {
  if (is_taken) value.fail(value.describe() + " a second time", "a name that no other " + what + " has");
}

}  // namespace snug::model::internal
