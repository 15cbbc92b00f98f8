// live_file: opens a recording for reading, also while somebody writes it.
#pragma once

#include <filesystem>

#include "snug/record/internal/h5.hpp"

namespace snug::record::internal {

/// A file that nobody writes is opened where it is. One that is being written is read into memory between two
/// commits, so that the handle shows the run as it was at that moment, whole.
///
/// Throws H5Error for a file that cannot be opened, or that is too big to be read between commits.
[[nodiscard]] Handle open_for_reading(const std::filesystem::path& path);

}  // namespace snug::record::internal
