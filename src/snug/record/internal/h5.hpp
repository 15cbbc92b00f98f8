// h5: the few things of the HDF5 C library that this module uses, with handles that close and errors that throw.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "snug/record/hdf5_lock.hpp"

namespace snug::record::internal {

/// What HDF5 complained about; turned into InputError where the path is known.
struct H5Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Keeps HDF5 from printing on stderr, and other threads from HDF5 (lock_hdf5), while it lives; the caller gets H5Error
/// instead.
class QuietErrors {
 public:
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  std::unique_lock<std::recursive_mutex> lock_ = lock_hdf5();
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

/// A file that is read, and how much of it may still be taken into memory at once. Counts in a file may be anything;
/// all that is read whole is together no larger than the file, as its writer does not compress it (numbers a third so
/// large, for files that others compressed).
class Source {
 public:
  explicit Source(hid_t file);
  [[nodiscard]] hid_t file() const { return file_; }
  /// Bytes of the file.
  [[nodiscard]] std::size_t size() const { return size_; }
  /// Throws H5Error when `path` has more rows of so many bytes than are left.
  void take_numbers(const char* path, hsize_t rows, std::size_t row_bytes) { take(path, rows, row_bytes, 3); }
  void take_texts(const char* path, hsize_t rows, std::size_t row_bytes);

 private:
  void take(const char* path, hsize_t rows, std::size_t row_bytes, std::size_t shrink);
  hid_t file_;
  std::size_t size_, left_;
};

/// Creates a dataset of fixed size and writes it.
Handle write_dataset(hid_t file, const char* path, hid_t type, const Dims& dims, const void* data);
/// One text as a scalar dataset; strings as an array padded with zero bytes to the longest.
void write_text(hid_t file, const char* path, const std::string& text);
void write_texts(hid_t file, const char* path, const std::vector<std::string>& texts);
/// Throw H5Error for what is not UTF-8 too.
[[nodiscard]] std::string read_text(Source& source, const char* path);
[[nodiscard]] std::vector<std::string> read_texts(Source& source, const char* path);

/// Is there anything at this path of the root group?
[[nodiscard]] bool has_link(hid_t file, const char* path);
/// Opens what lies in this file as numbers of up to 8 bytes or texts of fixed length, in chunks of sensible size that
/// are deflated at most. Links to other files, and data kept in them, are refused: a recording from elsewhere must not
/// show what else is on this machine.
[[nodiscard]] Handle open_dataset(hid_t file, const char* path);
/// Throws H5Error unless each group on the way from `place`, and what is there, lie in this file.
void check_links(hid_t place, const std::string& path);
/// Throws H5Error unless the data lie in this file, in chunks of sensible size that are deflated at most.
void check_storage(hid_t dataset, const char* path);
/// Is it a whole number or one of IEEE 754, of 1 to 8 bytes, all of whose bits count? The library converts others
/// without asking whether their bits are there.
[[nodiscard]] bool is_number(hid_t type);
/// Throws H5Error for chunks that unpack to more than they say. Before rows [first, first + count) are read.
void check_chunks(hid_t dataset, const Dims& dims, hsize_t first, hsize_t count);
/// The whole dataset, into as many values as its dimensions say.
void read_whole(hid_t dataset, hid_t type, void* out);
[[nodiscard]] Dims dims_of(hid_t dataset);
/// Bytes that the numbers of one dataset may take when they are read whole: counts in a damaged file may be anything,
/// and files of others are deflated.
[[nodiscard]] constexpr std::size_t most_unpacked(std::size_t file_bytes) { return 16 * file_bytes + 32'000'000; }
/// Rows [first, first + count) of the outermost dimension.
void read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* out);

/// All of a dataset, which must have `width` values in each row.
template <class T>
std::vector<T> read_all(Source& source, const char* path, std::size_t width = 1) {
  const Handle dataset = open_dataset(source.file(), path);
  const Dims dims = dims_of(dataset.get());
  const bool is_flat = width == 1 && dims.size() == 1;
  if (!is_flat && (dims.size() != 2 || dims[1] != width)) throw H5Error(std::string("unexpected shape of ") + path);
  source.take_numbers(path, dims[0], width * sizeof(T));
  std::vector<T> values(dims[0] * width);
  if (!values.empty()) read_rows(dataset.get(), file_type<T>(), 0, dims[0], values.data());
  return values;
}

}  // namespace snug::record::internal
