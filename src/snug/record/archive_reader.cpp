// ArchiveReader: reads archives strictly; every complaint names the file, the path inside it and the index.
#include <algorithm>
#include <cmath>
#include <functional>
#include <new>
#include <optional>
#include <stdexcept>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/input_log.hpp"
#include "snug/core/text.hpp"
#include "snug/record/archive.hpp"
#include "snug/record/internal/archive_layout.hpp"
#include "snug/record/internal/h5.hpp"
#include "snug/record/internal/header_file.hpp"
#include "snug/record/internal/object_guard.hpp"

namespace snug::record {
namespace {

using namespace internal;

constexpr double kFarthest = 1000.0;  ///< m: beyond it, a length is taken for millimetres

herr_t keep_name(hid_t, const char* name, const H5L_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

/// Names go into JSON, tables and onto terminals.
void check_name(const std::string& name) {
  if (!is_printable(name)) throw H5Error("a name that is not UTF-8, or has control characters");
}

/// Names of what is in a group, sorted.
std::vector<std::string> entries_of(hid_t group) {
  std::vector<std::string> names;
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_name, &names), "list a group");
  for (const std::string& name : names) check_name(name);
  return names;
}

herr_t keep_attribute(hid_t, const char* name, const H5A_info_t*, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}

/// Text attributes of an object; those of other kinds are left out.
std::vector<std::pair<std::string, std::string>> texts_of(hid_t object) {
  std::vector<std::string> names;
  check_header(object, ".");
  check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, nullptr, keep_attribute, &names), "attributes");
  for (const std::string& name : names) check_name(name);
  std::vector<std::pair<std::string, std::string>> texts;
  for (const std::string& name : names) {
    const Handle attribute(H5Aopen(object, name.c_str(), H5P_DEFAULT), name.c_str());
    const Handle type(H5Aget_type(attribute.get()), name.c_str());
    if (H5Tget_class(type.get()) != H5T_STRING) continue;
    if (H5Tis_variable_str(type.get()) <= 0) {
      texts.emplace_back(name, read_text_attribute(object, name.c_str()));
      continue;
    }
    const Handle space(H5Aget_space(attribute.get()), name.c_str());
    if (H5Sget_simple_extent_npoints(space.get()) != 1) continue;
    char* text = nullptr;
    check(H5Aread(attribute.get(), type.get(), static_cast<void*>(&text)), name);
    texts.emplace_back(name, text == nullptr ? "" : text);
    H5free_memory(text);
    if (!is_utf8(texts.back().second)) throw H5Error("attribute " + name + " is not UTF-8");
  }
  return texts;
}

/// True when every part of the path is there, and the last one is a group or a dataset.
bool exists(hid_t group, const std::string& path) {
  for (std::size_t end = path.find('/');; end = path.find('/', end + 1)) {
    if (!has_link(group, path.substr(0, end).c_str())) return false;
    if (end == std::string::npos) return H5Oexists_by_name(group, path.c_str(), H5P_DEFAULT) > 0;
  }
}

std::string dims_text(const Dims& dims) {
  std::string text;
  for (const hsize_t size : dims) text += (text.empty() ? "" : "x") + std::to_string(size);
  return text.empty() ? "a single value" : text;
}

}  // namespace

struct ArchiveReader::Impl {
  explicit Impl(const std::filesystem::path& file_path) : path(file_path) {
    const QuietErrors quiet;
    try {
      open();
    } catch (const H5Error& error) {
      throw InputError(path.string(), "", std::string("a damaged or truncated archive (") + error.what() + ")",
                       "an archive that was not cut or changed");
    }
  }

  void open() {
    std::error_code error;
    const char* expected = "an archive of measurements (docs/formats.md)";
    if (!std::filesystem::exists(path, error)) throw InputError(path.string(), "", "no such file", expected);
    if (!std::filesystem::is_regular_file(path, error)) throw InputError(path.string(), "", "not a file", expected);
    if (H5Fis_hdf5(path.c_str()) <= 0)
      throw InputError(path.string(), "", "a file that is not HDF5, or one that lost its beginning", expected);
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
    check(H5Pset_file_locking(access.get(), false, true), "file access");
    note_input_file(path);
    file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), "cannot open");
    if (is_recording(file.get()))
      throw InputError(path.string(), "", "a recording of a simulation",
                       "an archive of measurements; `snug measure` makes one of it");
    for (const std::string& name : entries_of(file.get())) {
      check_links(file.get(), name);
      if (exists(file.get(), name + '/' + kSensorGroup)) {
        names.push_back(name);
        continue;
      }
      if (name.starts_with("Rec_"))
        throw InputError(path.string(), '/' + name, std::string("no group ") + kSensorGroup,
                         "recordings with the groups of docs/formats.md");
    }
    if (names.empty())
      throw InputError(path.string(), "/", std::string("no group with ") + kSensorGroup,
                       "a group for each recording, as in docs/formats.md");
  }

  /// Runs `work`; what it finds wrong is thrown, or kept when there is somewhere to keep it.
  template <class Work>
  void guarded(std::size_t index, const std::string& part, std::vector<InputError>* found, Work work) const {
    const QuietErrors quiet;
    const auto refuse = [&](const InputError& error) {
      if (found == nullptr) throw error;
      found->push_back(error);
    };
    try {
      work();
    } catch (const InputError& error) {
      refuse(error);
    } catch (const H5Error& error) {
      refuse(InputError(path.string(), '/' + names[index] + '/' + part, error.what(),
                        "a dataset that can be read: not cut, not changed"));
    } catch (const std::bad_alloc&) {  // a damaged size: far more than the file can hold
      refuse(InputError(path.string(), '/' + names[index] + '/' + part, "more values than fit into memory",
                        "a dataset that can be read: not cut, not changed"));
    } catch (const std::length_error&) {
      refuse(InputError(path.string(), '/' + names[index] + '/' + part, "more values than fit into memory",
                        "a dataset that can be read: not cut, not changed"));
    }
  }

  [[noreturn]] void fail(std::size_t index, const std::string& part, const std::string& got,
                         const std::string& expected) const {
    throw InputError(path.string(), '/' + names[index] + '/' + part, got, expected);
  }

  Handle open_part(std::size_t index, const Handle& group, const std::string& part, H5O_type_t kind) const {
    if (!exists(group.get(), part)) fail(index, part, "nothing", kind == H5O_TYPE_GROUP ? "a group" : "a dataset");
    check_links(group.get(), part);
    check_header(group.get(), part.c_str());
    Handle object(H5Oopen(group.get(), part.c_str(), H5P_DEFAULT), part.c_str());
    const bool is_group = H5Iget_type(object.get()) == H5I_GROUP;
    if (is_group != (kind == H5O_TYPE_GROUP))
      fail(index, part, is_group ? "a group" : "a dataset", is_group ? "a dataset" : "a group");
    if (!is_group) check_storage(object.get(), part.c_str());
    return object;
  }

  /// A dataset of numbers whose first dimensions are `rows` and whose last is the time; rows one after the other.
  std::vector<double> read_rows_of(std::size_t index, const Handle& group, const std::string& part, const Dims& rows,
                                   std::optional<std::size_t> count) const {
    const Handle dataset = open_part(index, group, part, H5O_TYPE_DATASET);
    const Dims dims = dims_of(dataset.get());
    const std::string wanted = dims_text(rows) + 'x' + (count ? std::to_string(*count) : "N");
    const bool fits = dims.size() == rows.size() + 1 && std::equal(rows.begin(), rows.end(), dims.begin()) &&
                      (!count || dims.back() == *count);
    if (!fits) {
      const bool is_reversed =
          dims.size() == rows.size() + 1 && std::equal(rows.rbegin(), rows.rend(), dims.begin() + 1);
      fail(index, part, dims_text(dims), wanted + (is_reversed ? ": the order of dimensions is reversed" : ""));
    }
    require_number_type(index, dataset, part);
    require_room(index, part, dims);
    std::size_t size = 1;
    for (const hsize_t n : dims) size *= n;
    std::vector<double> values(size);
    if (size > 0) read_whole(dataset.get(), H5T_NATIVE_DOUBLE, values.data());
    return values;
  }

  void require_room(std::size_t index, const std::string& part, const Dims& dims) const {
    double bytes = sizeof(double);
    for (const hsize_t n : dims) bytes *= static_cast<double>(n);
    if (bytes > static_cast<double>(most_unpacked(std::filesystem::file_size(path))))
      fail(index, part, dims_text(dims), "no more values than a file of this size can hold");
  }

  void require_number_type(std::size_t index, const Handle& dataset, const std::string& part) const {
    const Handle type(H5Dget_type(dataset.get()), part.c_str());
    if (!is_number(type.get())) fail(index, part, "values that are no numbers", "numbers");
  }

  /// `count` vectors of a dataset with three rows for each, from row `first`.
  std::vector<Vector3> vectors_from(std::size_t index, const std::string& part, const std::vector<double>& rows,
                                    std::size_t first, std::size_t count) const {
    std::vector<Vector3> vectors(count);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t k = 0; k < 3; ++k) vectors[i][static_cast<int>(k)] = rows[(first + k) * count + i];
      if (!vectors[i].allFinite())
        fail(index, part, "a value that is no number at index " + std::to_string(i), "numbers");
    }
    return vectors;
  }

  Complain complain_of(std::size_t index) const {
    return [this, index](const std::string& part, const std::string& got, const std::string& expected) {
      fail(index, part, got, expected);
    };
  }

  std::vector<PoseSample> read_transforms(std::size_t index, const Handle& group, const std::string& part,
                                          std::size_t count) const {
    const std::vector<double> values = read_rows_of(index, group, part, {4, 4}, count);
    std::vector<PoseSample> poses(count, lost_pose());
    for (std::size_t i = 0; i < count; ++i) {
      Eigen::Matrix4d H;
      for (int k = 0; k < 16; ++k) H(k / 4, k % 4) = values[static_cast<std::size_t>(k) * count + i];
      if (H.array().isNaN().all()) continue;  // lost
      const auto refuse = [&](const std::string& got, const std::string& expected) {
        fail(index, part, got + " at index " + std::to_string(i), expected);
      };
      if (!H.allFinite()) refuse("some values that are no numbers", "all 16 numbers, or none where the body is lost");
      const Matrix3 R = H.topLeftCorner<3, 3>();
      const double skewness = (R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff();
      if (skewness > kRotationTolerance || R.determinant() < 0.0)
        refuse(R.determinant() < 0.0 ? "a mirror image" : "a matrix " + std::to_string(skewness) + " off orthonormal",
               "a rotation");
      if ((H.row(3) - Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)).cwiseAbs().maxCoeff() > 1e-6)
        refuse("a last row that is not 0 0 0 1", "a transform: rotation, position, and 0 0 0 1");
      if (H.topRightCorner<3, 1>().cwiseAbs().maxCoeff() > kFarthest) refuse("a position of more than 1 km", "metres");
      poses[i] = Pose{R, H.topRightCorner<3, 1>()};
    }
    return poses;
  }

  /// All columns of numbers of a compound table; the time must be among them.
  struct Table {
    std::vector<double> times;
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;
  };
  Table read_table(std::size_t index, const Handle& group, const std::string& part) const {
    const Handle dataset = open_part(index, group, part, H5O_TYPE_DATASET);
    const Handle type(H5Dget_type(dataset.get()), part.c_str());
    const Dims dims = dims_of(dataset.get());
    if (H5Tget_class(type.get()) != H5T_COMPOUND || dims.size() != 1)
      fail(index, part, "something else than rows of named columns", "a compound table with a column Time(s)");
    Table table;
    bool has_time = false;
    const int members = H5Tget_nmembers(type.get());
    require_room(index, part, {dims[0], static_cast<hsize_t>(std::max(0, members))});
    for (int member = 0; member < members; ++member) {
      char* text = H5Tget_member_name(type.get(), static_cast<unsigned>(member));
      const std::string name = text == nullptr ? "" : text;
      H5free_memory(text);
      check_name(name);
      const Handle stored(H5Tget_member_type(type.get(), static_cast<unsigned>(member)), "column");
      if (!is_number(stored.get())) continue;
      if (H5Tget_member_offset(type.get(), static_cast<unsigned>(member)) + H5Tget_size(stored.get()) >
          H5Tget_size(type.get()))
        throw H5Error("a column beyond its row");
      const Handle one(H5Tcreate(H5T_COMPOUND, sizeof(double)), "column");
      check(H5Tinsert(one.get(), name.c_str(), 0, H5T_NATIVE_DOUBLE), name);
      std::vector<double> values(dims[0]);
      if (!values.empty()) read_whole(dataset.get(), one.get(), values.data());
      if (name == kTimeColumn) {
        table.times = std::move(values);
        has_time = true;
      } else if (name != "Frame") {
        table.names.push_back(name);
        table.columns.push_back(std::move(values));
      }
    }
    if (!has_time) fail(index, part, "no column Time(s)", "a compound table with a column Time(s)");
    require_times(table.times, part, complain_of(index));
    return table;
  }

  void read_forces(std::size_t index, const Handle& group, WrenchLog& log) const {
    const std::string folder = std::string(kForceGroup) + '/';
    WrenchLog whole;
    whole.times = read_rows_of(index, group, folder + "time", {1}, std::nullopt);
    require_times(whole.times, folder + "time", complain_of(index));
    const std::size_t count = whole.times.size();
    const std::vector<double> rows = read_rows_of(index, group, folder + "wrench", {6}, count);
    const std::vector<Vector3> forces = vectors_from(index, folder + "wrench", rows, 0, count);
    const std::vector<Vector3> torques = vectors_from(index, folder + "wrench", rows, 3, count);
    for (std::size_t i = 0; i < count; ++i) whole.wrenches.push_back({forces[i], torques[i]});
    if (exists(group.get(), folder + "imu"))
      whole.accelerations =
          vectors_from(index, folder + "imu", read_rows_of(index, group, folder + "imu", {3}, count), 0, count);
    log = std::move(whole);
  }

  void read_motion_capture(std::size_t index, const Handle& group, MotionCaptureLog& log,
                           std::vector<InputError>* found) const {
    guarded(index, kMocapTable, found, [&] {
      log.times = read_table(index, group, kMocapTable).times;
      const Handle table = open_part(index, group, kMocapTable, H5O_TYPE_DATASET);
      if (!has_attribute(table.get(), "sample_frequency"))
        fail(index, kMocapTable, "no attribute sample_frequency", "the rate in Hz");
      read_attribute(table.get(), "sample_frequency", H5T_NATIVE_DOUBLE, &log.sample_frequency);
      require_frequency(log.times, log.sample_frequency, kMocapTable, complain_of(index));
    });
    guarded(index, kMocapBodies, found, [&] {
      const Handle bodies = open_part(index, group, kMocapBodies, H5O_TYPE_GROUP);
      for (const std::string& name : entries_of(bodies.get())) {
        const std::string part = std::string(kMocapBodies) + '/' + name + "/transforms";
        guarded(index, part, found, [&] {
          log.bodies.push_back({name, read_transforms(index, group, part, log.times.size())});
        });
      }
    });
  }

  void read_robot(std::size_t index, const Handle& group, RobotLog& log, std::vector<InputError>* found) const {
    guarded(index, kRobotTable, found, [&] {
      Table table = read_table(index, group, kRobotTable);
      log.times = std::move(table.times);
      log.names = std::move(table.names);
      log.columns = std::move(table.columns);
    });
    const std::string part = std::string(kRobotTool) + "/transforms";
    if (!exists(group.get(), kRobotTool)) return;
    guarded(index, part, found, [&] { log.tool = read_transforms(index, group, part, log.times.size()); });
  }

  ArchiveObject read_object(std::size_t index, const Handle& group, const std::string& name) const {
    const std::string folder = std::string(kObjectGroup) + '/' + name + '/';
    ArchiveObject object;
    object.name = name;
    const auto values_of = [&](const std::string& part, std::size_t size) {
      const Handle dataset = open_part(index, group, part, H5O_TYPE_DATASET);
      require_number_type(index, dataset, part);
      const Handle space(H5Dget_space(dataset.get()), part.c_str());
      const hssize_t points = H5Sget_simple_extent_npoints(space.get());
      if (points != static_cast<hssize_t>(size))
        fail(index, part, std::to_string(points) + " values", std::to_string(size) + " of them");
      std::vector<double> values(size);
      read_whole(dataset.get(), H5T_NATIVE_DOUBLE, values.data());
      for (std::size_t i = 0; i < size; ++i)
        if (!std::isfinite(values[i])) fail(index, part, "no number at index " + std::to_string(i), "numbers");
      return values;
    };
    object.mass = values_of(folder + "mass", 1)[0];
    if (!(object.mass > 0.0)) fail(index, folder + "mass", std::to_string(object.mass), "kg, above 0");
    if (exists(group.get(), folder + "dimensions"))
      object.dimensions = Vector3(values_of(folder + "dimensions", 3).data());
    if (exists(group.get(), folder + "inertia")) {
      const std::vector<double> rows = values_of(folder + "inertia", 9);
      for (int k = 0; k < 9; ++k) object.inertia(k / 3, k % 3) = rows[static_cast<std::size_t>(k)];
    }
    if (exists(group.get(), folder + "vertices")) {
      const std::vector<double> rows = read_rows_of(index, group, folder + "vertices", {3}, std::nullopt);
      object.vertices = vectors_from(index, folder + "vertices", rows, 0, rows.size() / 3);
    }
    return object;
  }

  ArchiveRecording read(std::size_t index, std::vector<InputError>* found) const {
    SNUG_CHECK(index < names.size(), "a recording that the archive has");
    ArchiveRecording recording;
    recording.name = names[index];
    guarded(index, "", found, [&] {
      const Handle group(H5Gopen2(file.get(), names[index].c_str(), H5P_DEFAULT), names[index].c_str());
      recording.remarks = texts_of(group.get());
      const auto has = [&](const char* source) {
        return exists(group.get(), std::string(kSensorGroup) + '/' + source);
      };
      if (has("ft_data"))
        guarded(index, kForceGroup, found, [&] { read_forces(index, group, recording.force_torque); });
      if (has("Mocap")) read_motion_capture(index, group, recording.motion_capture, found);
      if (has("UR10_sensor")) read_robot(index, group, recording.robot, found);
      // A camera's recording, say, is one without anything that is read.
      if (!exists(group.get(), kSensorGroup) ||
          entries_of(Handle(H5Gopen2(group.get(), kSensorGroup, H5P_DEFAULT), kSensorGroup).get()).empty())
        fail(index, kSensorGroup, "no group in it",
             "ft_data, Mocap, UR10_sensor, or another source, which is passed over");
      if (!exists(group.get(), kObjectGroup)) return;
      const Handle objects = open_part(index, group, kObjectGroup, H5O_TYPE_GROUP);
      for (const std::string& name : entries_of(objects.get()))
        guarded(index, std::string(kObjectGroup) + '/' + name, found,
                [&] { recording.objects.push_back(read_object(index, group, name)); });
    });
    return recording;
  }

  std::filesystem::path path;
  Handle file;
  std::vector<std::string> names;
};

ArchiveReader::ArchiveReader(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}
ArchiveReader::~ArchiveReader() = default;
ArchiveReader::ArchiveReader(ArchiveReader&&) noexcept = default;
ArchiveReader& ArchiveReader::operator=(ArchiveReader&&) noexcept = default;

const std::vector<std::string>& ArchiveReader::names() const { return impl_->names; }
ArchiveRecording ArchiveReader::read(std::size_t index) const { return impl_->read(index, nullptr); }
std::vector<InputError> ArchiveReader::find_defects(std::size_t index) const {
  std::vector<InputError> found;
  (void)impl_->read(index, &found);
  return found;
}

}  // namespace snug::record
