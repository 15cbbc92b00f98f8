// h5: the few things of the HDF5 C library that this module uses, with handles that close and errors that throw.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace snug::record::internal {

/// What HDF5 complained about; turned into InputError where the path is known.
struct H5Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Keeps HDF5 from printing on stderr while it lives; the caller gets H5Error instead.
class QuietErrors {
 public:
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Owns an HDF5 identifier of any kind.
class Handle {
 public:
  Handle() = default;
  /// Throws H5Error saying that `what` failed when `id` is negative.
  Handle(hid_t id, const char* what);
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)) {}
  Handle& operator=(Handle&& other) noexcept;
  [[nodiscard]] hid_t get() const { return id_; }
  void reset() noexcept;

 private:
  hid_t id_ = H5I_INVALID_HID;
};

/// Throws H5Error with the library's own reason when `status` is negative.
void check(herr_t status, const std::string& what);

template <class T>
hid_t file_type();
template <>
inline hid_t file_type<double>() {
  return H5T_IEEE_F64LE;
}
template <>
inline hid_t file_type<float>() {
  return H5T_IEEE_F32LE;
}
template <>
inline hid_t file_type<std::int64_t>() {
  return H5T_STD_I64LE;
}
template <>
inline hid_t file_type<std::uint64_t>() {
  return H5T_STD_U64LE;
}
template <>
inline hid_t file_type<std::int32_t>() {
  return H5T_STD_I32LE;
}
template <>
inline hid_t file_type<std::uint8_t>() {
  return H5T_STD_U8LE;
}

using Dims = std::vector<hsize_t>;

/// UTF-8 text of `size` bytes, padded with zeros.
[[nodiscard]] Handle string_type(std::size_t size);

void write_attribute(hid_t object, const char* name, const std::string& text);
void write_attribute(hid_t object, const char* name, hid_t type, const void* value);
/// Overwrites a value that is already there.
void update_attribute(hid_t object, const char* name, hid_t type, const void* value);
[[nodiscard]] bool has_attribute(hid_t object, const char* name);
[[nodiscard]] std::string read_text_attribute(hid_t object, const char* name);
void read_attribute(hid_t object, const char* name, hid_t type, void* value);

/// Creates a dataset of fixed size and writes it.
Handle write_dataset(hid_t file, const char* path, hid_t type, const Dims& dims, const void* data);
/// One text as a scalar dataset; strings as an array padded with zero bytes to the longest.
void write_text(hid_t file, const char* path, const std::string& text);
void write_texts(hid_t file, const char* path, const std::vector<std::string>& texts);
[[nodiscard]] std::string read_text(hid_t file, const char* path);
[[nodiscard]] std::vector<std::string> read_texts(hid_t file, const char* path);

/// Is there anything at this path of the root group?
[[nodiscard]] bool has_link(hid_t file, const char* path);
[[nodiscard]] Handle open_dataset(hid_t file, const char* path);
[[nodiscard]] Dims dims_of(hid_t dataset);
/// Rows [first, first + count) of the outermost dimension.
void read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* out);

/// All of a dataset, which must have `width` values in each row.
template <class T>
std::vector<T> read_all(hid_t file, const char* path, std::size_t width = 1) {
  const Handle dataset = open_dataset(file, path);
  const Dims dims = dims_of(dataset.get());
  hsize_t row = 1;
  for (std::size_t i = 1; i < dims.size(); ++i) row *= dims[i];
  if (dims.empty() || row != width) throw H5Error(std::string("unexpected shape of ") + path);
  std::vector<T> values(dims[0] * width);
  if (!values.empty()) read_rows(dataset.get(), file_type<T>(), 0, dims[0], values.data());
  return values;
}

}  // namespace snug::record::internal
