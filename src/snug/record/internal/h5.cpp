// h5: the few things of the HDF5 C library that this module uses, with handles that close and errors that throw.
#include "snug/record/internal/h5.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "snug/core/text.hpp"
#include "snug/record/internal/chunks.hpp"
#include "snug/record/internal/object_guard.hpp"

namespace snug::record::internal {
namespace {

herr_t keep_first_reason(unsigned depth, const H5E_error2_t* error, void* out) {
  if (depth == 0 && error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
  return 0;
}

/// The innermost message on the library's error stack: the cause.
std::string take_reason() {
  std::string reason;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_first_reason, &reason);
  H5Eclear2(H5E_DEFAULT);
  return reason.empty() ? "unknown HDF5 error" : reason;
}

/// What small files may have beyond their size: short texts count as kLeastText.
constexpr std::size_t kSlack = std::size_t{64} << 10U;
constexpr std::size_t kLeastText = 8;

void check_type(hid_t dataset, const char* path) {
  const Handle type(H5Dget_type(dataset), path);
  const H5T_class_t kind = H5Tget_class(type.get());
  const bool is_text = kind == H5T_STRING && H5Tis_variable_str(type.get()) == 0;
  if (!is_number(type.get()) && !is_text)
    throw H5Error(std::string(path) + " holds neither numbers nor texts of fixed length");
}

Handle simple_space(const Dims& dims) {
  if (dims.empty()) return {H5Screate(H5S_SCALAR), "scalar dataspace"};
  return {H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), "dataspace"};
}

/// Properties that create missing parent groups.
Handle with_parents() {
  Handle properties(H5Pcreate(H5P_LINK_CREATE), "link properties");
  check(H5Pset_create_intermediate_group(properties.get(), 1), "link properties");
  return properties;
}

}  // namespace

void check_links(hid_t place, const std::string& path) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    const std::string part = path.substr(0, end);
    H5L_info_t info;
    check(H5Lget_info(place, part.c_str(), &info, H5P_DEFAULT), path);
    if (info.type != H5L_TYPE_HARD) throw H5Error(part + " is a link to something else");
    if (end == std::string::npos) return;
  }
}

void check_storage(hid_t dataset, const char* path) {
  const Handle properties(H5Dget_create_plist(dataset), path);
  const H5D_layout_t layout = H5Pget_layout(properties.get());
  if ((layout != H5D_COMPACT && layout != H5D_CONTIGUOUS && layout != H5D_CHUNKED) ||
      H5Pget_external_count(properties.get()) != 0)
    throw H5Error(std::string(path) + " is kept in another file");
  const Handle space(H5Dget_space(dataset), path), type(H5Dget_type(dataset), path);
  if (layout == H5D_CHUNKED) return check_chunk_layout(properties.get(), type.get(), path);
  // The library reads beyond the end of what is stored. Nothing is stored of what was never written.
  const auto count = static_cast<hsize_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.get())));
  const hsize_t stored = H5Dget_storage_size(dataset);
  const bool may_be_absent = layout == H5D_CONTIGUOUS && stored == 0;
  if (!may_be_absent && count > stored / std::max<std::size_t>(1, H5Tget_size(type.get())))
    throw H5Error(std::string(path) + " is shorter than its extent says");
}

bool is_chunked(hid_t dataset) {
  const Handle properties(H5Dget_create_plist(dataset), "dataset");
  return H5Pget_layout(properties.get()) == H5D_CHUNKED;
}

bool is_number(hid_t type) {
  const hid_t known[] = {H5T_STD_I8LE,  H5T_STD_I8BE,   H5T_STD_I16LE,  H5T_STD_I16BE,  H5T_STD_I32LE,
                         H5T_STD_I32BE, H5T_STD_I64LE,  H5T_STD_I64BE,  H5T_STD_U8LE,   H5T_STD_U8BE,
                         H5T_STD_U16LE, H5T_STD_U16BE,  H5T_STD_U32LE,  H5T_STD_U32BE,  H5T_STD_U64LE,
                         H5T_STD_U64BE, H5T_IEEE_F32LE, H5T_IEEE_F32BE, H5T_IEEE_F64LE, H5T_IEEE_F64BE};
  return std::ranges::any_of(known, [&](hid_t one) { return H5Tequal(type, one) > 0; });
}

}  // namespace snug::record::internal

namespace snug::record {

std::unique_lock<std::recursive_mutex> lock_hdf5() {
  static std::recursive_mutex mutex;
  return std::unique_lock(mutex);
}

}  // namespace snug::record

namespace snug::record::internal {

QuietErrors::QuietErrors() {
  // All files are closed by their handles. The library's own clean-up at exit is switched off because it prints an
  // endless chain of names when a damaged file was refused. Does nothing when HDF5 is in use already.
  H5dont_atexit();
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietErrors::~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

Handle::Handle(hid_t id, const char* what) : id_(id) {
  if (id < 0) throw H5Error(std::string(what) + ": " + take_reason());
}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = std::exchange(other.id_, H5I_INVALID_HID);
  }
  return *this;
}

void Handle::reset() noexcept {
  if (id_ >= 0) H5Idec_ref(id_);
  id_ = H5I_INVALID_HID;
}

void check(herr_t status, const std::string& what) {
  if (status < 0) throw H5Error(what + ": " + take_reason());
}

Handle string_type(std::size_t size) {
  Handle type(H5Tcopy(H5T_C_S1), "string type");
  check(H5Tset_size(type.get(), size), "string type");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "string type");
  check(H5Tset_strpad(type.get(), H5T_STR_NULLPAD), "string type");
  return type;
}

void write_attribute(hid_t object, const char* name, hid_t type, const void* value) {
  const Handle space(H5Screate(H5S_SCALAR), "scalar dataspace");
  const Handle attribute(H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT), name);
  check(H5Awrite(attribute.get(), type, value), name);
}

void write_attribute(hid_t object, const char* name, const std::string& text) {
  const Handle type = string_type(std::max<std::size_t>(1, text.size()));
  write_attribute(object, name, type.get(), text.c_str());
}

void update_attribute(hid_t object, const char* name, hid_t type, const void* value) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), name);
  check(H5Awrite(attribute.get(), type, value), name);
}

bool has_attribute(hid_t object, const char* name) {
  check_header(object, ".");
  return H5Aexists(object, name) > 0;
}

std::string read_text_attribute(hid_t object, const char* name) {
  check_header(object, ".");
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), name);
  const Handle type(H5Aget_type(attribute.get()), name);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0)
    throw H5Error(std::string("attribute ") + name + " is not a text of fixed length");
  const Handle space(H5Aget_space(attribute.get()), name);
  if (H5Sget_simple_extent_npoints(space.get()) != 1)
    throw H5Error(std::string("attribute ") + name + " is not a single text");
  std::string text(H5Tget_size(type.get()), '\0');
  check(H5Aread(attribute.get(), type.get(), text.data()), name);
  text.resize(std::strlen(text.c_str()));
  if (!is_utf8(text)) throw H5Error(std::string("attribute ") + name + " is not UTF-8");
  return text;
}

void read_attribute(hid_t object, const char* name, hid_t type, void* value) {
  check_header(object, ".");
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), name);
  const Handle space(H5Aget_space(attribute.get()), name);
  const Handle stored(H5Aget_type(attribute.get()), name);
  if (H5Sget_simple_extent_npoints(space.get()) != 1 || !is_number(stored.get()))
    throw H5Error(std::string("attribute ") + name + " is not a single number");
  check(H5Aread(attribute.get(), type, value), name);
}

Handle write_dataset(hid_t file, const char* path, hid_t type, const Dims& dims, const void* data) {
  const Handle space = simple_space(dims);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), path);
  check(H5Pset_obj_track_times(properties.get(), false), path);  // same content, same bytes, whenever it is written
  Handle dataset(H5Dcreate2(file, path, type, space.get(), with_parents().get(), properties.get(), H5P_DEFAULT), path);
  const bool is_empty = std::find(dims.begin(), dims.end(), hsize_t{0}) != dims.end();
  if (!is_empty) check(H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), path);
  return dataset;
}

void write_text(hid_t file, const char* path, const std::string& text) {
  const Handle type = string_type(std::max<std::size_t>(1, text.size()));
  write_dataset(file, path, type.get(), {}, text.c_str());
}

void write_texts(hid_t file, const char* path, const std::vector<std::string>& texts) {
  std::size_t size = 1;
  for (const std::string& text : texts) size = std::max(size, text.size());
  std::string padded(size * texts.size(), '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(padded.data() + i * size, texts[i].size());
  write_dataset(file, path, string_type(size).get(), {texts.size()}, padded.data());
}

Source::Source(hid_t file) : file_(file) {
  hsize_t size = 0;
  check(H5Fget_filesize(file, &size), "size of the file");
  size_ = static_cast<std::size_t>(size);
  left_ = size_ + kSlack;
}

void Source::take_texts(const char* path, hsize_t rows, std::size_t row_bytes) {
  take(path, rows, std::max(row_bytes, kLeastText), 1);
}

void Source::take(const char* path, hsize_t rows, std::size_t row_bytes, std::size_t shrink) {
  if (rows > shrink * left_ / row_bytes)
    throw H5Error(std::string(path) + " has more rows than a file of this size can hold");
  left_ -= rows * row_bytes / shrink;
}

std::vector<std::string> read_texts(Source& source, const char* path) {
  const Handle dataset = open_dataset(source.file(), path);
  const Handle type(H5Dget_type(dataset.get()), path);
  if (H5Tget_class(type.get()) != H5T_STRING) throw H5Error(std::string(path) + " is not text of fixed length");
  const std::size_t size = H5Tget_size(type.get());
  const Handle space(H5Dget_space(dataset.get()), path);
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.get())));
  source.take_texts(path, count, size);
  std::string padded(size * count, '\0');
  if (count > 0) read_whole(dataset.get(), type.get(), padded.data());
  std::vector<std::string> texts;
  texts.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::string_view text = std::string_view(padded).substr(i * size, size);
    text = text.substr(0, text.find_last_not_of('\0') + 1);
    if (!is_utf8(text)) throw H5Error(std::string(path) + " holds text that is not UTF-8");
    texts.emplace_back(text);
  }
  return texts;
}

std::string read_text(Source& source, const char* path) {
  const std::vector<std::string> texts = read_texts(source, path);
  if (texts.size() != 1) throw H5Error(std::string(path) + " is not a single text");
  return texts[0];
}

bool has_link(hid_t file, const char* path) { return H5Lexists(file, path, H5P_DEFAULT) > 0; }

Handle open_dataset(hid_t file, const char* path) {
  check_links(file, path);
  check_header(file, path);
  Handle dataset(H5Dopen2(file, path, H5P_DEFAULT), path);
  check_type(dataset.get(), path);
  check_storage(dataset.get(), path);
  return dataset;
}

Dims dims_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), "dataspace");
  const int rank = H5Sget_simple_extent_ndims(space.get());
  Dims dims(static_cast<std::size_t>(std::max(0, rank)));
  if (!dims.empty()) check(H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr), "dataspace");
  return dims;
}

void read_whole(hid_t dataset, hid_t type, void* out) {
  const Dims dims = dims_of(dataset);
  if (is_chunked(dataset)) return read_chunked_rows(dataset, type, dims, 0, dims.empty() ? 1 : dims[0], out);
  check(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, out), "read");
}

void read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* out) {
  Dims size = dims_of(dataset);
  if (size.empty() || count > size[0] || first > size[0] - count) throw H5Error("dataset is shorter than expected");
  if (is_chunked(dataset)) return read_chunked_rows(dataset, type, size, first, count, out);
  size[0] = count;
  Dims start(size.size(), 0);
  start[0] = first;
  const Handle file_space(H5Dget_space(dataset), "dataspace");
  check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr), "rows");
  const Handle memory_space = simple_space(size);
  check(H5Dread(dataset, type, memory_space.get(), file_space.get(), H5P_DEFAULT, out), "read");
}

}  // namespace snug::record::internal
