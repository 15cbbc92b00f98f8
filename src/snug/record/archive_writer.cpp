// ArchiveWriter: writes archives beside their place, chunk by chunk, and renames them when they are whole.
#include <algorithm>
#include <array>
#include <set>
#include <system_error>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/units.hpp"
#include "snug/record/archive.hpp"
#include "snug/record/internal/archive_layout.hpp"
#include "snug/record/internal/h5.hpp"

namespace snug::record {
namespace {

using namespace internal;

constexpr auto kNothing = static_cast<float>(kNaN);

/// Properties of datasets: no times of writing, so that the same contents make the same bytes.
Handle untimed_dataset() {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), "dataset properties");
  check(H5Pset_obj_track_times(properties.get(), false), "dataset properties");
  return properties;
}

Handle create_dataset(hid_t group, const char* name, hid_t type, const Dims& dims, const Handle& properties) {
  const Handle links(H5Pcreate(H5P_LINK_CREATE), "link properties");
  check(H5Pset_create_intermediate_group(links.get(), 1), "link properties");
  const Handle space(
      dims.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr),
      "dataspace");
  return {H5Dcreate2(group, name, type, space.get(), links.get(), properties.get(), H5P_DEFAULT), name};
}

Handle write_numbers(hid_t group, const std::string& name, const Dims& dims, const std::vector<double>& values) {
  Handle dataset = create_dataset(group, name.c_str(), H5T_IEEE_F64LE, dims, untimed_dataset());
  if (!values.empty())
    check(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), name);
  return dataset;
}

void write_unit(const Handle& dataset, const char* unit) { write_attribute(dataset.get(), "unit", unit); }

/// 4 x 4 x N, the time running fastest; chunks of instants at which the body is lost are left out and read as NaN.
void write_transforms(hid_t group, const std::string& name, const std::vector<PoseSample>& poses) {
  const Handle properties = untimed_dataset();
  const hsize_t count = poses.size();
  const Dims chunk = {4, 4, std::max<hsize_t>(1, std::min<hsize_t>(count, kPoseChunk))};
  check(H5Pset_chunk(properties.get(), 3, chunk.data()), "chunks");
  check(H5Pset_fill_value(properties.get(), H5T_NATIVE_FLOAT, &kNothing), "fill value");
  const Handle dataset = create_dataset(group, name.c_str(), H5T_IEEE_F32LE, {4, 4, count}, properties);
  write_unit(dataset, "m");
  const Handle space(H5Dget_space(dataset.get()), "dataspace");
  std::vector<float> values;
  for (std::size_t first = 0; first < poses.size(); first += kPoseChunk) {
    const std::size_t size = std::min(kPoseChunk, poses.size() - first);
    const auto begin = poses.begin() + static_cast<std::ptrdiff_t>(first);
    if (std::none_of(begin, begin + static_cast<std::ptrdiff_t>(size), is_tracked)) continue;
    values.assign(16 * size, kNothing);
    for (std::size_t i = 0; i < size; ++i) {
      const PoseSample& pose = poses[first + i];
      if (!is_tracked(pose)) continue;
      Eigen::Matrix4d H = Eigen::Matrix4d::Identity();
      H.topLeftCorner<3, 3>() = pose.quat.normalized().toRotationMatrix();
      H.topRightCorner<3, 1>() = pose.p;
      for (int k = 0; k < 16; ++k) values[static_cast<std::size_t>(k) * size + i] = static_cast<float>(H(k / 4, k % 4));
    }
    const Dims start = {0, 0, first}, extent = {4, 4, size};
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr), "chunk");
    const Handle memory(H5Screate_simple(3, extent.data(), nullptr), "dataspace");
    check(H5Dwrite(dataset.get(), H5T_NATIVE_FLOAT, memory.get(), space.get(), H5P_DEFAULT, values.data()), name);
  }
}

/// A compound table: the first column is a count, the second the time, as Motive writes them.
Handle write_table(hid_t group, const std::string& name, const std::vector<double>& times,
                   const std::vector<std::string>& names, const std::vector<std::vector<double>>& columns) {
  const std::size_t width = 2 + names.size();
  const Handle type(H5Tcreate(H5T_COMPOUND, width * sizeof(double)), "table");
  check(H5Tinsert(type.get(), "Frame", 0, H5T_IEEE_F64LE), "table");
  check(H5Tinsert(type.get(), kTimeColumn, sizeof(double), H5T_IEEE_F64LE), "table");
  for (std::size_t k = 0; k < names.size(); ++k)
    check(H5Tinsert(type.get(), names[k].c_str(), (2 + k) * sizeof(double), H5T_IEEE_F64LE), names[k]);
  std::vector<double> rows(times.size() * width);
  for (std::size_t i = 0; i < times.size(); ++i) {
    double* row = rows.data() + i * width;
    row[0] = static_cast<double>(i);
    row[1] = times[i];
    for (std::size_t k = 0; k < names.size(); ++k) row[2 + k] = columns[k][i];
  }
  Handle dataset = create_dataset(group, name.c_str(), type.get(), {times.size()}, untimed_dataset());
  if (!rows.empty()) check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()), name);
  return dataset;
}

/// Rows of vectors, the time running fastest.
std::vector<double> in_rows(const std::vector<Vector3>& first, const std::vector<Vector3>& second) {
  std::vector<double> values;
  for (const std::vector<Vector3>* part : {&first, &second})
    for (int axis = 0; axis < 3 && !part->empty(); ++axis)
      for (const Vector3& v : *part) values.push_back(v[axis]);
  return values;
}

void write_forces(hid_t group, const WrenchLog& log) {
  const hsize_t count = log.times.size();
  const std::string folder = std::string(kForceGroup) + '/';
  std::vector<Vector3> forces, torques;
  for (const Wrench& wrench : log.wrenches) {
    forces.push_back(wrench.force);
    torques.push_back(wrench.torque);
  }
  write_unit(write_numbers(group, folder + "time", {1, count}, log.times), "s");
  write_unit(write_numbers(group, folder + "wrench", {6, count}, in_rows(forces, torques)), "N, Nm");
  if (!log.accelerations.empty())
    write_unit(write_numbers(group, folder + "imu", {3, count}, in_rows(log.accelerations, {})), "m/s^2");
}

void write_motion_capture(hid_t group, const MotionCaptureLog& log) {
  const Handle table = write_table(group, kMocapTable, log.times, {}, {});
  const double duration = log.times.back() - log.times.front();
  write_attribute(table.get(), "sample_frequency", H5T_NATIVE_DOUBLE, &log.sample_frequency);
  write_attribute(table.get(), "duration", H5T_NATIVE_DOUBLE, &duration);
  for (const BodyTrack& body : log.bodies)
    write_transforms(group, std::string(kMocapBodies) + '/' + body.name + "/transforms", body.poses);
}

void write_robot(hid_t group, const RobotLog& log) {
  write_table(group, kRobotTable, log.times, log.names, log.columns);
  if (!log.tool.empty()) write_transforms(group, std::string(kRobotTool) + "/transforms", log.tool);
}

void write_object(hid_t group, const ArchiveObject& object) {
  const std::string folder = std::string(kObjectGroup) + '/' + object.name + '/';
  const auto three = [](const Vector3& v) { return std::vector<double>{v.x(), v.y(), v.z()}; };
  std::vector<double> inertia;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) inertia.push_back(object.inertia(row, column));
  write_unit(write_numbers(group, folder + "mass", {}, {object.mass}), "kg");
  write_unit(write_numbers(group, folder + "dimensions", {3}, three(object.dimensions)), "m");
  write_unit(write_numbers(group, folder + "inertia", {3, 3}, inertia), "kg m^2");
  write_unit(write_numbers(group, folder + "vertices", {3, object.vertices.size()}, in_rows(object.vertices, {})), "m");
}

}  // namespace

struct ArchiveWriter::Impl {
  explicit Impl(OutputFile file) : output(std::move(file)) {
    refuse_foreign_file();
    guarded([&] {
      const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
      check(H5Pset_file_locking(access.get(), false, true), "file access");  // OutputFile has a lock of its own
      archive = Handle(H5Fcreate(output.location().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), "create file");
    });
  }

  template <class Work>
  void guarded(Work work) {
    const QuietErrors quiet;
    try {
      work();
    } catch (const H5Error& error) {
      throw OutputError(output.path().string(), error.what());
    }
  }

  /// Replaces nothing but an earlier archive or an empty file.
  void refuse_foreign_file() const {
    const std::filesystem::path& path = output.path();
    std::error_code error;
    if (!std::filesystem::exists(path, error) || std::filesystem::file_size(path, error) == 0) return;
    try {
      (void)ArchiveReader(path);
    } catch (const InputError&) {
      throw InputError(path.string(), "", "a file that is no archive: not overwritten",
                       "a path that is free or holds an earlier archive");
    }
  }

  void require_whole(const ArchiveRecording& recording) const {
    const Complain complain = [&](const std::string& part, const std::string& got, const std::string& expected) {
      throw InputError(output.path().string(), '/' + recording.name + '/' + part, got, expected);
    };
    const auto has_slash = [](const std::string& name) { return name.empty() || name.find('/') != std::string::npos; };
    if (has_slash(recording.name)) complain("", "'" + recording.name + "'", "a name without '/' for the recording");
    if (names.contains(recording.name)) complain("", "two recordings of this name", "each name once");
    const MotionCaptureLog& mocap = recording.motion_capture;
    require_times(mocap.times, kMocapTable, complain);
    if (!mocap.times.empty()) require_frequency(mocap.times, mocap.sample_frequency, kMocapTable, complain);
    for (const BodyTrack& body : mocap.bodies) {
      if (has_slash(body.name)) complain(kMocapBodies, "'" + body.name + "'", "a name without '/' for each body");
      require_length(body.poses.size(), mocap.times.size(), std::string(kMocapBodies) + '/' + body.name, complain);
    }
    const WrenchLog& forces = recording.force_torque;
    require_times(forces.times, std::string(kForceGroup) + "/time", complain);
    require_length(forces.wrenches.size(), forces.times.size(), std::string(kForceGroup) + "/wrench", complain);
    if (!forces.accelerations.empty())
      require_length(forces.accelerations.size(), forces.times.size(), std::string(kForceGroup) + "/imu", complain);
    const RobotLog& robot = recording.robot;
    require_times(robot.times, kRobotTable, complain);
    SNUG_CHECK(robot.columns.size() == robot.names.size(), "each column of the robot's table has a name");
    for (std::size_t k = 0; k < robot.columns.size(); ++k)
      require_length(robot.columns[k].size(), robot.times.size(), std::string(kRobotTable) + '/' + robot.names[k],
                     complain);
    if (!robot.tool.empty()) require_length(robot.tool.size(), robot.times.size(), kRobotTool, complain);
  }

  void add(const ArchiveRecording& recording) {
    require_whole(recording);
    guarded([&] {
      const Handle group(H5Gcreate2(archive.get(), recording.name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         recording.name.c_str());
      for (const auto& [key, text] : recording.remarks) write_attribute(group.get(), key.c_str(), text);
      const Handle sensors(H5Gcreate2(group.get(), kSensorGroup, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), kSensorGroup);
      if (!recording.force_torque.times.empty()) write_forces(group.get(), recording.force_torque);
      if (!recording.motion_capture.times.empty()) write_motion_capture(group.get(), recording.motion_capture);
      if (!recording.robot.times.empty()) write_robot(group.get(), recording.robot);
      for (const ArchiveObject& object : recording.objects) write_object(group.get(), object);
    });
    names.insert(recording.name);
  }

  void close() {
    guarded([&] {
      check(H5Fflush(archive.get(), H5F_SCOPE_LOCAL), "flush");
      archive.reset();
    });
    output.publish();
  }

  OutputFile output;
  Handle archive;
  std::set<std::string> names;
};

ArchiveWriter::ArchiveWriter(OutputFile file) : impl_(std::make_unique<Impl>(std::move(file))) {}
ArchiveWriter::~ArchiveWriter() {
  const QuietErrors quiet;
  impl_.reset();
}
ArchiveWriter::ArchiveWriter(ArchiveWriter&&) noexcept = default;
ArchiveWriter& ArchiveWriter::operator=(ArchiveWriter&&) noexcept = default;

void ArchiveWriter::add(const ArchiveRecording& recording) {
  SNUG_CHECK(impl_ != nullptr, "the archive is closed");
  impl_->add(recording);
}

void ArchiveWriter::close() {
  SNUG_CHECK(impl_ != nullptr, "the archive is closed");
  const std::unique_ptr<Impl> impl = std::move(impl_);
  impl->close();
}

}  // namespace snug::record
