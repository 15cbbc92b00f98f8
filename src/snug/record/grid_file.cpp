// GridFile: pictures and texts in an HDF5 file that others may have made; nothing that it says of itself is believed.
#include "snug/record/grid_file.hpp"

#include "snug/core/input_error.hpp"
#include "snug/core/input_log.hpp"
#include "snug/record/internal/h5.hpp"

namespace snug::record {
using namespace internal;

struct GridFile::Impl {
  explicit Impl(const std::filesystem::path& file_path) : path(file_path) {
    guarded("", [&] {
      const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
      check(H5Pset_file_locking(access.get(), false, true), "file access");
      note_input_file(path);
      file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), "an HDF5 file");
    });
  }

  template <class Work>
  void guarded(const char* name, Work work) const {
    const QuietErrors quiet;
    try {
      work();
    } catch (const H5Error& error) {
      throw InputError(path.string(), name, error.what(), "an HDF5 file that was not cut or changed");
    }
  }

  template <class T>
  Size read(const char* name, int most, hid_t type, std::vector<T>& values) const {
    Size size;
    guarded(name, [&] {
      const Handle dataset = open_dataset(file.get(), name);
      const Handle stored(H5Dget_type(dataset.get()), name);
      const Dims dims = dims_of(dataset.get());
      const auto is_side = [&](hsize_t side) { return side >= 1 && side <= static_cast<hsize_t>(most); };
      if (!is_number(stored.get()) || dims.size() != 2 || !is_side(dims[0]) || !is_side(dims[1]))
        throw H5Error("no picture of at most " + std::to_string(most) + " x " + std::to_string(most));
      const hsize_t count = dims[0] * dims[1];
      if (count * sizeof(T) > most_unpacked(std::filesystem::file_size(path)))
        throw H5Error("more values than a file of this size can hold");
      values.resize(count);
      read_whole(dataset.get(), type, values.data());
      size = {static_cast<int>(dims[0]), static_cast<int>(dims[1])};
    });
    return size;
  }

  std::filesystem::path path;
  Handle file;
};

GridFile::GridFile(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}
GridFile::~GridFile() = default;

bool GridFile::has(const char* name) const { return has_link(impl_->file.get(), name); }

GridFile::Size GridFile::read(const char* name, int most, std::vector<float>& values) const {
  return impl_->read(name, most, H5T_NATIVE_FLOAT, values);
}

GridFile::Size GridFile::read(const char* name, int most, std::vector<std::uint8_t>& values) const {
  return impl_->read(name, most, H5T_NATIVE_UINT8, values);
}

std::string GridFile::read_text(const char* name) const {
  std::string text;
  impl_->guarded(name, [&] { text = read_text_attribute(impl_->file.get(), name); });
  return text;
}

}  // namespace snug::record
