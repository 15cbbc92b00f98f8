// Column: one dataset that grows by a row per frame, buffered for one chunk.
#include "snug/record/internal/column.hpp"

#include <zlib.h>

#include <algorithm>
#include <limits>

#include "snug/core/check.hpp"
#include "snug/record/internal/dimension_scales.hpp"

namespace snug::record::internal {
namespace {

/// Rows never written read as NaN (0 for integers).
void set_fill(hid_t properties, hid_t type) {
  if (H5Tget_class(type) != H5T_FLOAT) return;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  check(H5Pset_fill_value(properties, H5T_NATIVE_DOUBLE, &nan), "fill value");
}

Handle create(hid_t file, const ColumnSpec& spec, const Dims& dims, const Dims& chunk, bool with_deflate) {
  Dims limit = dims;
  limit[0] = H5S_UNLIMITED;
  const Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), limit.data()), spec.path);
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), spec.path);
  check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()), spec.path);
  check(H5Pset_obj_track_times(properties.get(), false),
        spec.path);  // same content, same bytes, whenever it is written
  if (with_deflate) check(H5Pset_deflate(properties.get(), 1), spec.path);
  set_fill(properties.get(), spec.type);
  const Handle links(H5Pcreate(H5P_LINK_CREATE), spec.path);
  check(H5Pset_create_intermediate_group(links.get(), 1), spec.path);
  Handle dataset(H5Dcreate2(file, spec.path, spec.type, space.get(), links.get(), properties.get(), H5P_DEFAULT),
                 spec.path);
  write_units(dataset.get(), spec.unit);
  if (*spec.frame != '\0') write_attribute(dataset.get(), "frame", spec.frame);
  if (*spec.columns != '\0') write_attribute(dataset.get(), "columns", spec.columns);
  return dataset;
}

/// Size of the first dimension; the others are those of the spec.
Dims shape(const ColumnSpec& spec, hsize_t rows) {
  if (spec.lanes > 0) return {rows, spec.lanes, spec.width};
  if (spec.width > 1 || spec.is_table) return {rows, spec.width};
  return {rows};
}

}  // namespace

Column::Column(hid_t file, const ColumnSpec& spec, std::size_t chunk_rows)
    : dims_(shape(spec, 0)),
      chunk_rows_(chunk_rows),
      row_bytes_(spec.width * spec.value_bytes),
      lanes_(std::max<std::size_t>(1, spec.lanes)),
      buffer_(lanes_ * chunk_rows * row_bytes_),
      packed_(lanes_) {
  Dims chunk = shape(spec, chunk_rows);
  if (spec.lanes > 0) chunk[1] = 1;
  dataset_ = create(file, spec, dims_, chunk, true);
}

void Column::write(hsize_t first, std::size_t rows) {
  dims_[0] = first + rows;
  check(H5Dset_extent(dataset_.get(), dims_.data()), "extend dataset");
  for (std::size_t lane = 0; lane < lanes_; ++lane) {
    const hsize_t offset[3] = {first, lane, 0};
    const hsize_t plain_offset[2] = {first, 0};
    write_chunk(dims_.size() == 3 ? offset : plain_offset, lane, rows);
  }
  is_begun_ = rows < chunk_rows_;
}

void Column::write_chunk(const hsize_t* offset, std::size_t lane, std::size_t rows) {
  const std::size_t bytes = chunk_rows_ * row_bytes_;
  const unsigned char* data = buffer_.data() + lane * bytes;
  // A chunk that was begun keeps its size, so that it is completed in place and never misread.
  const bool is_constant =
      rows == chunk_rows_ && !is_begun_ && std::memcmp(data, data + row_bytes_, bytes - row_bytes_) == 0;
  constexpr std::uint32_t kSkipDeflate = 1;
  if (is_constant) {
    const std::vector<unsigned char>& packed = pack(lane);
    check(H5Dwrite_chunk(dataset_.get(), H5P_DEFAULT, 0, offset, packed.size(), packed.data()), "write chunk");
  } else {
    check(H5Dwrite_chunk(dataset_.get(), H5P_DEFAULT, kSkipDeflate, offset, bytes, data), "write chunk");
  }
}

const std::vector<unsigned char>& Column::pack(std::size_t lane) {
  const std::size_t bytes = chunk_rows_ * row_bytes_;
  const unsigned char* data = buffer_.data() + lane * bytes;
  Packed& packed = packed_[lane];
  if (!packed.row.empty() && std::memcmp(packed.row.data(), data, row_bytes_) == 0) return packed.bytes;
  uLongf size = compressBound(static_cast<uLong>(bytes));
  packed.bytes.resize(size);
  const int status = compress2(packed.bytes.data(), &size, data, static_cast<uLong>(bytes), 1);
  SNUG_CHECK(status == Z_OK, "deflate into a buffer of the stated bound");
  packed.bytes.resize(size);
  packed.row.assign(data, data + row_bytes_);
  return packed.bytes;
}

FlatColumn::FlatColumn(hid_t file, const ColumnSpec& spec)
    : type_(spec.type), dims_(shape(spec, 0)), row_bytes_(spec.width * spec.value_bytes) {
  constexpr std::size_t kChunkBytes = 24576;  // small files stay small, and a run needs some hundred chunks
  dataset_ = create(file, spec, dims_, shape(spec, std::clamp<std::size_t>(kChunkBytes / row_bytes_, 16, 2048)), false);
}

void FlatColumn::write() {
  const hsize_t rows = buffer_.size() / row_bytes_;
  if (rows == 0) return;
  Dims start(dims_.size(), 0);
  start[0] = dims_[0];
  Dims size = dims_;
  size[0] = rows;
  dims_[0] += rows;
  check(H5Dset_extent(dataset_.get(), dims_.data()), "extend dataset");
  const Handle file_space(H5Dget_space(dataset_.get()), "dataspace");
  check(H5Sselect_hyperslab(file_space.get(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr), "rows");
  const Handle memory_space(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr), "dataspace");
  check(H5Dwrite(dataset_.get(), type_, memory_space.get(), file_space.get(), H5P_DEFAULT, buffer_.data()), "write");
  buffer_.clear();
}

}  // namespace snug::record::internal
