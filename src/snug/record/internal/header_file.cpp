// The part of a recording that is fixed from the start: scenario, program, bodies, container.
#include "snug/record/internal/header_file.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "snug/core/text.hpp"
#include "snug/record/internal/dimension_scales.hpp"
#include "snug/record/internal/layout.hpp"

namespace snug::record::internal {
namespace {

// Each takes memory for each frame that is read; no run has had a hundredth of them.
constexpr std::size_t kMostBodies = 20'000;
constexpr std::size_t kMostJoints = 1000;
constexpr const char* kPoseColumns = "x,y,z,qw,qx,qy,qz";

void push(std::vector<double>& out, const Vector3& v) { out.insert(out.end(), {v.x(), v.y(), v.z()}); }

void push(std::vector<double>& out, const PoseSample& X) {
  push(out, X.p);
  out.insert(out.end(), {X.quat.w(), X.quat.x(), X.quat.y(), X.quat.z()});
}

Vector3 vector_at(const std::vector<double>& values, std::size_t row, std::size_t width = 3) {
  const double* v = values.data() + row * width;
  return {v[0], v[1], v[2]};
}

PoseSample pose_at(const std::vector<double>& values, std::size_t row) {
  const double* v = values.data() + row * 7;
  return {Vector3(v[0], v[1], v[2]), Quaternion(v[3], v[4], v[5], v[6])};
}

template <class T>
void write_table(hid_t file, const char* path, std::size_t width, const std::vector<T>& values, const char* unit,
                 const char* columns = "") {
  Dims dims = {values.size() / width};
  if (width > 1) dims.push_back(width);
  const Handle dataset = write_dataset(file, path, file_type<T>(), dims, values.data());
  write_units(dataset.get(), unit);
  if (*columns != '\0') write_attribute(dataset.get(), "columns", columns);
}

/// The shapes of all bodies, one row each.
struct ShapeTable {
  std::vector<std::int32_t> body, vertex_first, vertex_count;
  std::vector<std::uint8_t> kind;
  std::vector<double> pose, half, radius, half_length, vertex;
};

void add(ShapeTable& table, std::size_t body, const ShapeInfo& shape) {
  table.body.push_back(static_cast<std::int32_t>(body));
  table.kind.push_back(static_cast<std::uint8_t>(shape.kind));
  push(table.pose, shape.X_BG);
  push(table.half, shape.half);
  table.radius.push_back(shape.radius);
  table.half_length.push_back(shape.half_length);
  table.vertex_first.push_back(static_cast<std::int32_t>(table.vertex.size() / 3));
  table.vertex_count.push_back(static_cast<std::int32_t>(shape.vertices.size()));
  for (const Vector3& vertex : shape.vertices) push(table.vertex, vertex);
}

void write_bodies(hid_t file, const std::vector<BodyInfo>& bodies) {
  std::vector<std::string> names, types;
  std::vector<std::uint8_t> kinds;
  std::vector<double> masses, coms;
  ShapeTable shapes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    names.push_back(bodies[i].name);
    types.push_back(bodies[i].type);
    kinds.push_back(static_cast<std::uint8_t>(bodies[i].kind));
    masses.push_back(bodies[i].mass);
    push(coms, bodies[i].com);
    for (const ShapeInfo& shape : bodies[i].shapes) add(shapes, i, shape);
  }
  write_texts(file, "/bodies/name", names);
  write_texts(file, "/bodies/type", types);
  write_table(file, "/bodies/kind", 1, kinds, "0 static, 1 kinematic, 2 dynamic");
  write_table(file, "/bodies/mass", 1, masses, "kg");
  write_table(file, "/bodies/com", 3, coms, "m", "x,y,z");
  write_table(file, "/shapes/body", 1, shapes.body, "row of /bodies/name");
  write_table(file, "/shapes/kind", 1, shapes.kind, "0 box, 1 capsule, 2 hull, 3 cylinder");
  write_table(file, "/shapes/pose", 7, shapes.pose, "m, -", kPoseColumns);
  write_table(file, "/shapes/half", 3, shapes.half, "m", "x,y,z");
  write_table(file, "/shapes/radius", 1, shapes.radius, "m");
  write_table(file, "/shapes/half_length", 1, shapes.half_length, "m");
  write_table(file, "/shapes/vertex_first", 1, shapes.vertex_first, "row of /shapes/vertex");
  write_table(file, "/shapes/vertex_count", 1, shapes.vertex_count, "rows of /shapes/vertex");
  write_table(file, "/shapes/vertex", 3, shapes.vertex, "m", "x,y,z");
}

void require_rows(std::size_t rows, std::size_t expected, const char* path) {
  if (rows != expected) throw H5Error(std::string(path) + " has the wrong number of rows");
}

template <class T>
std::vector<T> read_rows_of(Source& source, const char* path, std::size_t rows, std::size_t width = 1) {
  std::vector<T> values = read_all<T>(source, path, width);
  require_rows(values.size(), rows * width, path);
  return values;
}

template <class Enum>
Enum enum_from(std::uint8_t value, Enum last, const char* path) {
  if (value > static_cast<std::uint8_t>(last)) throw H5Error(std::string(path) + " holds an unknown kind");
  return static_cast<Enum>(value);
}

void read_shapes(Source& source, std::vector<BodyInfo>& bodies) {
  const std::vector<std::int32_t> body = read_all<std::int32_t>(source, "/shapes/body");
  const std::size_t rows = body.size();
  const auto kind = read_rows_of<std::uint8_t>(source, "/shapes/kind", rows);
  const auto pose = read_rows_of<double>(source, "/shapes/pose", rows, 7);
  const auto half = read_rows_of<double>(source, "/shapes/half", rows, 3);
  const auto radius = read_rows_of<double>(source, "/shapes/radius", rows);
  const auto half_length = read_rows_of<double>(source, "/shapes/half_length", rows);
  const auto first = read_rows_of<std::int32_t>(source, "/shapes/vertex_first", rows);
  const auto count = read_rows_of<std::int32_t>(source, "/shapes/vertex_count", rows);
  const auto vertex = read_all<double>(source, "/shapes/vertex", 3);
  auto unused = static_cast<std::int64_t>(vertex.size() / 3);  // no vertex belongs to two shapes
  for (std::size_t i = 0; i < rows; ++i) {
    const std::int64_t end = std::int64_t{first[i]} + count[i];
    unused -= std::max(0, count[i]);
    if (body[i] < 0 || static_cast<std::size_t>(body[i]) >= bodies.size() || first[i] < 0 || count[i] < 0 ||
        end > static_cast<std::int64_t>(vertex.size() / 3) || unused < 0)
      throw H5Error("/shapes refers to rows that do not exist");
    ShapeInfo shape;
    shape.kind = enum_from(kind[i], ShapeKind::Cylinder, "/shapes/kind");
    shape.X_BG = pose_at(pose, i);
    shape.half = vector_at(half, i);
    shape.radius = radius[i];
    shape.half_length = half_length[i];
    for (std::int64_t v = first[i]; v < end; ++v)
      shape.vertices.push_back(vector_at(vertex, static_cast<std::size_t>(v)));
    bodies[static_cast<std::size_t>(body[i])].shapes.push_back(std::move(shape));
  }
}

std::vector<BodyInfo> read_bodies(Source& source) {
  const std::vector<std::string> names = read_texts(source, "/bodies/name");
  const std::vector<std::string> types = read_texts(source, "/bodies/type");
  require_rows(types.size(), names.size(), "/bodies/type");
  if (names.size() > kMostBodies) throw H5Error("/bodies/name has more than " + std::to_string(kMostBodies) + " rows");
  const auto kinds = read_rows_of<std::uint8_t>(source, "/bodies/kind", names.size());
  const auto masses = read_rows_of<double>(source, "/bodies/mass", names.size());
  const auto coms = read_rows_of<double>(source, "/bodies/com", names.size(), 3);
  std::vector<BodyInfo> bodies(names.size());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    bodies[i].name = names[i];
    bodies[i].type = types[i];
    bodies[i].kind = enum_from(kinds[i], BodyKind::Dynamic, "/bodies/kind");
    bodies[i].mass = masses[i];
    bodies[i].com = vector_at(coms, i);
  }
  read_shapes(source, bodies);
  return bodies;
}

/// Whole lines of it: the run was killed, or goes on.
std::string read_program_so_far(Source& source) {
  if (!has_link(source.file(), kProgramSoFar)) throw H5Error(std::string(kProgram) + " is missing");
  const auto bytes = read_all<std::uint8_t>(source, kProgramSoFar);
  const std::string text(bytes.begin(), bytes.end());
  if (!is_utf8(text)) throw H5Error(std::string(kProgramSoFar) + " holds text that is not UTF-8");
  return text.substr(0, text.rfind('\n') + 1);
}

}  // namespace

void write_header(hid_t file, const RecordingHeader& header) {
  const std::int32_t version = kFormatVersion;
  const std::uint8_t complete = 0;  // nor interrupted: until it is closed
  write_attribute(file, "format", kFormatName);
  write_attribute(file, "format_version", H5T_NATIVE_INT32, &version);
  write_attribute(file, "complete", H5T_NATIVE_UINT8, &complete);
  write_attribute(file, "interrupted", H5T_NATIVE_UINT8, &complete);
  write_attribute(file, "snug_version", header.version);
  write_attribute(file, "program_name", header.program_name);
  write_attribute(file, "sequence", header.sequence);
  write_attribute(file, "seed", H5T_NATIVE_UINT64, &header.seed);
  write_attribute(file, "dt", H5T_NATIVE_DOUBLE, &header.dt);
  write_attribute(file, "record_period", H5T_NATIVE_DOUBLE, &header.record_period);
  write_text(file, "/scenario", header.scenario_text);
  write_text(file, "/settings", header.settings);
  write_bodies(file, header.bodies);
  if (!header.joints.empty()) write_texts(file, kJointName, header.joints);
  write_texts(file, "/container/name", {header.container.name});
  std::vector<double> poses;
  push(poses, header.container.X_WT);
  push(poses, header.container.X_TI);
  write_table(file, "/container/pose", 7, poses, "m, -", kPoseColumns);
  const Vector3& size = header.container.inner_size;
  write_table(file, "/container/inner_size", 3, std::vector<double>{size.x(), size.y(), size.z()}, "m", "x,y,z");
}

RecordingHeader read_header(Source& source) {
  const hid_t file = source.file();
  RecordingHeader header;
  header.version = read_text_attribute(file, "snug_version");
  header.program_name = read_text_attribute(file, "program_name");
  header.sequence = read_text_attribute(file, "sequence");
  read_attribute(file, "seed", H5T_NATIVE_UINT64, &header.seed);
  read_attribute(file, "dt", H5T_NATIVE_DOUBLE, &header.dt);
  read_attribute(file, "record_period", H5T_NATIVE_DOUBLE, &header.record_period);
  header.scenario_text = read_text(source, "/scenario");
  header.program_text = has_link(file, kProgram) ? read_text(source, kProgram) : read_program_so_far(source);
  header.settings = read_text(source, "/settings");
  header.bodies = read_bodies(source);
  if (has_link(file, kJointName)) header.joints = read_texts(source, kJointName);
  if (header.joints.size() > kMostJoints) throw H5Error("more than " + std::to_string(kMostJoints) + " joints");
  header.container.name = read_text(source, "/container/name");
  const auto poses = read_rows_of<double>(source, "/container/pose", 2, 7);
  header.container.X_WT = pose_at(poses, 0);
  header.container.X_TI = pose_at(poses, 1);
  header.container.inner_size = vector_at(read_rows_of<double>(source, "/container/inner_size", 1, 3), 0);
  return header;
}

bool is_recording(hid_t file) {
  if (!has_attribute(file, "format")) return false;
  try {
    return read_text_attribute(file, "format") == kFormatName;
  } catch (const H5Error&) {
    return false;
  }
}

}  // namespace snug::record::internal
