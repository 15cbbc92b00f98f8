// attribute_guard: are the attributes of an object within the bytes that hold them? HDF5 before 1.14.1 does not ask.
#pragma once

#include <hdf5.h>

namespace snug::record::internal {

/// Looks through the object's header in the file, without the library: it copies an attribute of as many bytes as that
/// says it has from a buffer that may have fewer (https://github.com/HDFGroup/hdf5/issues/1368). Throws H5Error. Looks
/// at files on disk only, and not at attributes that are kept outside of the header, as those of objects with very
/// many.
void check_attributes(hid_t object);

}  // namespace snug::record::internal
