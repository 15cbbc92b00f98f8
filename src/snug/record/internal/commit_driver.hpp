// Commit driver: an HDF5 file that on disk only ever steps from one whole state to the next.
#pragma once

#include <chrono>

#include "snug/record/internal/h5.hpp"

namespace snug::record::internal {

/// A commit waits so long for readers that hold the lock, and then goes on without it: they must hold it for less.
inline constexpr std::chrono::milliseconds kWriterPatience(2000);

/// Makes `access` write through the commit driver, and returns the driver: keep it longer than the file.
///
/// HDF5 writes its tables in an order of its own, so that a process killed meanwhile leaves a file that does not
/// open. This driver keeps what would change the committed part of the file in memory until H5Fflush, and then
/// writes it so that what is referred to is there before what refers to it: first everything new behind the old end,
/// then the superblock with the new end, then changed data, then chunk indices from their roots down, last the object
/// headers with the lengths of the datasets. Killed at any time, the file shows the old or the new state of
/// each dataset. It is a plain HDF5 file. Who reads while it is being written may get parts of both states: meanwhile
/// the lock LockByte::Commit is held. docs/formats.md tells what that means for readers.
[[nodiscard]] Handle use_commit_driver(hid_t access);

}  // namespace snug::record::internal
