// h5: the few things of the HDF5 C library that this module uses, with handles that close and errors that throw.
#include "snug/record/internal/h5.hpp"

#include <algorithm>
#include <cstring>

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

bool has_attribute(hid_t object, const char* name) { return H5Aexists(object, name) > 0; }

std::string read_text_attribute(hid_t object, const char* name) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), name);
  const Handle type(H5Aget_type(attribute.get()), name);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0)
    throw H5Error(std::string("attribute ") + name + " is not a text of fixed length");
  std::string text(H5Tget_size(type.get()), '\0');
  check(H5Aread(attribute.get(), type.get(), text.data()), name);
  text.resize(std::strlen(text.c_str()));
  return text;
}

void read_attribute(hid_t object, const char* name, hid_t type, void* value) {
  const Handle attribute(H5Aopen(object, name, H5P_DEFAULT), name);
  const Handle space(H5Aget_space(attribute.get()), name);
  if (H5Sget_simple_extent_npoints(space.get()) != 1)
    throw H5Error(std::string("attribute ") + name + " is not a single value");
  check(H5Aread(attribute.get(), type, value), name);
}

Handle write_dataset(hid_t file, const char* path, hid_t type, const Dims& dims, const void* data) {
  const Handle space = simple_space(dims);
  Handle dataset(H5Dcreate2(file, path, type, space.get(), with_parents().get(), H5P_DEFAULT, H5P_DEFAULT), path);
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

std::vector<std::string> read_texts(hid_t file, const char* path) {
  const Handle dataset = open_dataset(file, path);
  const Handle type(H5Dget_type(dataset.get()), path);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) > 0)
    throw H5Error(std::string(path) + " is not text of fixed length");
  const std::size_t size = H5Tget_size(type.get());
  const Handle space(H5Dget_space(dataset.get()), path);
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space.get())));
  std::string padded(size * count, '\0');
  if (count > 0) check(H5Dread(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()), path);
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < count; ++i) {
    std::string text = padded.substr(i * size, size);
    text.resize(text.find_last_not_of('\0') + 1);
    texts.push_back(std::move(text));
  }
  return texts;
}

std::string read_text(hid_t file, const char* path) {
  const std::vector<std::string> texts = read_texts(file, path);
  if (texts.size() != 1) throw H5Error(std::string(path) + " is not a single text");
  return texts[0];
}

bool has_link(hid_t file, const char* path) { return H5Lexists(file, path, H5P_DEFAULT) > 0; }

Handle open_dataset(hid_t file, const char* path) { return {H5Dopen2(file, path, H5P_DEFAULT), path}; }

Dims dims_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), "dataspace");
  const int rank = H5Sget_simple_extent_ndims(space.get());
  Dims dims(static_cast<std::size_t>(std::max(0, rank)));
  if (!dims.empty()) check(H5Sget_simple_extent_dims(space.get(), dims.data(), nullptr), "dataspace");
  return dims;
}

void read_rows(hid_t dataset, hid_t type, hsize_t first, hsize_t count, void* out) {
  Dims size = dims_of(dataset);
  if (size.empty() || first + count > size[0]) throw H5Error("dataset is shorter than expected");
  size[0] = count;
  Dims start(size.size(), 0);
  start[0] = first;
  const Handle file_space(H5Dget_space(dataset), "dataspace");
  check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr), "rows");
  const Handle memory_space = simple_space(size);
  check(H5Dread(dataset, type, memory_space.get(), file_space.get(), H5P_DEFAULT, out), "read");
}

}  // namespace snug::record::internal
