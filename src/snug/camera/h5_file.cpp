// HDF5: a frame with everything that is known of it.
#include <hdf5.h>

#include <utility>

#include "snug/camera/internal/file_parts.hpp"
#include "snug/record/grid_file.hpp"

namespace snug::camera {
namespace {

/// Owns an HDF5 identifier of any kind.
class Id {
 public:
  explicit Id(hid_t id) : id_(id) {}
  ~Id() {
    if (id_ >= 0) H5Idec_ref(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool is_open() const { return id_ >= 0; }

 private:
  hid_t id_;
};

/// Keeps HDF5 from printing on stderr.
class Quiet {
 public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

void expect(bool is_fine, const std::filesystem::path& path) {
  if (!is_fine) throw OutputError(path.string(), "HDF5 could not write it");
}

template <class T>
void write_grid(hid_t group, const char* name, const Grid2<T>& grid, hid_t file_type, hid_t type,
                const std::filesystem::path& path) {
  const hsize_t sides[2] = {static_cast<hsize_t>(grid.rows()), static_cast<hsize_t>(grid.cols())};
  const Id space(H5Screate_simple(2, sides, nullptr)), settings(H5Pcreate(H5P_DATASET_CREATE));
  const hsize_t chunk[2] = {std::min<hsize_t>(64, sides[0]), sides[1]};
  H5Pset_chunk(settings.get(), 2, chunk);
  H5Pset_shuffle(settings.get());
  H5Pset_deflate(settings.get(), 3);
  H5Pset_obj_track_times(settings.get(), false);
  const Id set(H5Dcreate2(group, name, file_type, space.get(), H5P_DEFAULT, settings.get(), H5P_DEFAULT));
  expect(set.is_open() && H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, grid.values().data()) >= 0, path);
}

void write_text(hid_t place, const char* name, const std::string& text, const std::filesystem::path& path) {
  const Id type(H5Tcopy(H5T_C_S1)), space(H5Screate(H5S_SCALAR));
  H5Tset_size(type.get(), text.size() + 1);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const Id attribute(H5Acreate2(place, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT));
  expect(attribute.is_open() && H5Awrite(attribute.get(), type.get(), text.c_str()) >= 0, path);
}

void write_poses(hid_t group, const FrameTruth& truth, const std::filesystem::path& path) {
  Grid2<double> poses(static_cast<int>(truth.X_WB.size()), 7);
  for (int i = 0; i < poses.rows(); ++i) {
    const Pose& X_WB = truth.X_WB[static_cast<std::size_t>(i)];
    const Quaternion quat(X_WB.R);
    const double values[7] = {X_WB.p.x(), X_WB.p.y(), X_WB.p.z(), quat.w(), quat.x(), quat.y(), quat.z()};
    std::copy(values, values + 7, poses.row(i));
  }
  if (poses.rows() > 0) write_grid(group, "poses", poses, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, path);
}

template <class T>
Grid2<T> read_grid(const record::GridFile& file, const char* name) {
  std::vector<T> values;
  const record::GridFile::Size size = file.read(name, internal::kLargestSide, values);
  return {size.rows, size.cols, std::move(values)};
}

}  // namespace

void write_h5(OutputFile& output, const Frame& frame, const FrameTruth* truth) {
  const std::filesystem::path& path = output.path();
  const Quiet quiet;
  const Id access(H5Pcreate(H5P_FILE_ACCESS));
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_LATEST);
  const Id file(H5Fcreate(output.location().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.get()));
  expect(file.is_open(), path);
  write_text(file.get(), "camera", format_camera(frame.camera), path);
  write_grid(file.get(), "depth", frame.depth, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, path);
  if (!frame.intensity.values().empty())
    write_grid(file.get(), "intensity", frame.intensity, H5T_STD_U8LE, H5T_NATIVE_UINT8, path);
  if (truth == nullptr) return;
  const Id group(H5Gcreate2(file.get(), "truth", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  expect(group.is_open(), path);
  model::CameraParams where = frame.camera;
  where.X_WC = truth->X_WC;
  write_text(group.get(), "camera", format_camera(where), path);
  std::string names;
  for (const std::string& name : truth->names) names += name + "\n";
  write_text(group.get(), "names", names, path);
  write_grid(group.get(), "depth", truth->depth, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, path);
  write_grid(group.get(), "label", truth->label, H5T_STD_I16LE, H5T_NATIVE_INT16, path);
  write_poses(group.get(), *truth, path);
}

Frame internal::read_h5(const std::filesystem::path& path, const FrameHints& hints) {
  const record::GridFile file(path);
  Frame frame;
  frame.camera = hints.camera;
  if (!hints.camera_is_given) parse_camera(file.read_text("camera"), path.string(), frame.camera);
  frame.depth = read_grid<float>(file, "depth");
  expect_size(frame.camera, frame.depth.cols(), frame.depth.rows(), path.string());
  std::vector<double> depths;
  for (float& depth : frame.depth.values()) {
    if (depth > 0.0F) depths.push_back(depth);
    depth = usable(frame.camera, depth);
  }
  expect_in_range(frame.camera, std::move(depths), 1.0, path.string());
  if (file.has("intensity")) frame.intensity = read_grid<std::uint8_t>(file, "intensity");
  return frame;
}

}  // namespace snug::camera
