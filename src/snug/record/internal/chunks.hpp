// Datasets that are kept in chunks, as they are read from files of anybody. Internal to the module.
//
// HDF5 1.10 takes a chunk for whatever it unpacks to: what comes to more than the dataset says fills the memory, and
// what comes to less is read beyond its end. So chunks are unpacked here, to exactly what they say.
#pragma once

#include "snug/record/internal/h5.hpp"

namespace snug::record::internal {

/// Throws H5Error for chunks that are too large, or packed by anything but shuffle and one deflate.
void check_chunk_layout(hid_t properties, hid_t type, const char* path);

/// Rows first .. first + count - 1 of a dataset that is kept in chunks and holds `dims` numbers or texts, as `type`.
/// Throws H5Error where a chunk is not what it says.
void read_chunked_rows(hid_t dataset, hid_t type, const Dims& dims, hsize_t first, hsize_t count, void* out);

}  // namespace snug::record::internal
