// Hdf5Lock: HDF5 is not thread-safe: one thread of the process at a time.
#pragma once

#include <mutex>

namespace snug::record {

/// Held by writers while they write. Whoever reads beside a writer in another thread holds it as long as a reader is
/// used. One thread may hold it several times.
[[nodiscard]] std::unique_lock<std::recursive_mutex> lock_hdf5();

}  // namespace snug::record
