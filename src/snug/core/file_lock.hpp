// FileLock: locks by which the writers and readers of one file respect each other, in this process and in others.
#pragma once

#include <cstdint>

namespace snug {

/// Single bytes far behind every end are locked instead of whole files, so that programs which lock those (HDF5) are
/// not disturbed. docs/formats.md tells other programs about them.
enum class LockByte : std::int64_t {
  Writer = 0x4000000000000000,  ///< exclusive: as long as somebody writes the file
  Commit,                       ///< exclusive: while it is not whole; shared: while somebody reads it
};
enum class LockKind { Shared, Exclusive };

/// Takes a lock that lasts until `descriptor` and its copies are closed (also by a kill), without waiting. A shared
/// lock needs a descriptor open for reading, an exclusive one for writing. False when another open file has it; true
/// where the file system knows no locks, or for any other reason not to have one.
[[nodiscard]] bool try_lock(int descriptor, LockByte byte, LockKind kind);
void unlock(int descriptor, LockByte byte);
/// Does another open file hold the byte? False where the file system knows no locks.
[[nodiscard]] bool is_locked(int descriptor, LockByte byte);

}  // namespace snug
