// Column: one dataset that grows by a row per frame, buffered for one chunk.
#pragma once

#include <cstddef>
#include <cstring>
#include <vector>

#include "snug/record/internal/h5.hpp"

namespace snug::record::internal {

/// What a dataset holds. Strings must outlive the call that uses them.
struct ColumnSpec {
  const char* path = "";
  hid_t type = H5I_INVALID_HID;
  std::size_t value_bytes = 0;
  std::size_t width = 1;  ///< values in a row
  std::size_t lanes = 0;  ///< > 0: dataset [rows, lanes, width] with a chunk of its own for each lane
  const char* unit = "";  ///< written as attributes, like the next two
  const char* frame = "";
  const char* columns = "";
  bool is_table = false;  ///< two-dimensional even when width is 1
};

template <class T>
ColumnSpec column_of(const char* path, std::size_t width, const char* unit, const char* frame, const char* columns) {
  return {path, file_type<T>(), sizeof(T), width, 0, unit, frame, columns, false};
}

/// Chunks in which all rows are equal (a body at rest) are deflated, the others stored as they are: any HDF5 reader
/// sees an ordinary dataset, and the compressor never works on data that it would hardly shrink.
class Column {
 public:
  Column(hid_t file, const ColumnSpec& spec, std::size_t chunk_rows);

  /// Copies one row of `width` values to position `row` of the chunk being filled.
  void put(std::size_t row, const void* values, std::size_t lane = 0) {
    std::memcpy(buffer_.data() + (lane * chunk_rows_ + row) * row_bytes_, values, row_bytes_);
  }
  /// Writes the chunk that starts at `first`, of which `rows` are filled, and ends the dataset there.
  void write(hsize_t first, std::size_t rows);

 private:
  struct Packed {
    std::vector<unsigned char> row;    ///< the row that all rows of the chunk equal
    std::vector<unsigned char> bytes;  ///< the deflated chunk
  };
  void write_chunk(const hsize_t* offset, std::size_t lane, std::size_t rows);
  const std::vector<unsigned char>& pack(std::size_t lane);

  Handle dataset_;
  Dims dims_;
  std::size_t chunk_rows_;
  std::size_t row_bytes_;
  std::size_t lanes_;
  std::vector<unsigned char> buffer_;
  bool is_begun_ = false;       ///< the chunk being filled is in the file already, as far as it was filled then
  std::vector<Packed> packed_;  ///< of each lane: a body that stays at rest is deflated once
};

/// A flat dataset that grows by any number of rows at a time.
class FlatColumn {
 public:
  FlatColumn(hid_t file, const ColumnSpec& spec);
  /// Appends `count` rows to the buffer.
  void put(const void* values, std::size_t count) {
    const auto* bytes = static_cast<const unsigned char*>(values);
    buffer_.insert(buffer_.end(), bytes, bytes + count * row_bytes_);
  }
  /// Writes the buffer behind what is in the file.
  void write();

 private:
  Handle dataset_;
  hid_t type_;
  Dims dims_;
  std::size_t row_bytes_;
  std::vector<unsigned char> buffer_;
};

}  // namespace snug::record::internal
