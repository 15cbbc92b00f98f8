// object_guard: what HDF5 1.10 does not ask of an object's header before it uses it.
#pragma once

#include <hdf5.h>

namespace snug::record::internal {

/// Looks through the header of the object at `path` in the file, without the library, which copies an attribute of as
/// many bytes as that says it has from a buffer that may have fewer (https://github.com/HDFGroup/hdf5/issues/1368,
/// mended in 1.14.1), and divides by the extents of chunks as it opens a dataset. To be called before an object is
/// opened, and with "." for one that is open. Throws H5Error. Looks at files on disk only, and not at attributes that
/// are kept outside of the header, as those of objects with very many.
void check_header(hid_t place, const char* path);

}  // namespace snug::record::internal
