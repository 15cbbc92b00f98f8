// FileLock: locks by which the writers and readers of one file respect each other, in this process and in others.
#include "snug/core/file_lock.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>

namespace snug {
namespace {

/// Locks of open file descriptions: unlike those of processes they also keep two files of one process apart, and stay
/// when the process closes another descriptor of the same file.
struct flock range_of(LockByte byte, short type) {
  struct flock range = {};
  range.l_type = type;
  range.l_whence = SEEK_SET;
  range.l_start = static_cast<off_t>(byte);
  range.l_len = 1;
  return range;
}

}  // namespace

bool try_lock(int descriptor, LockByte byte, LockKind kind) {
  struct flock range = range_of(byte, kind == LockKind::Shared ? F_RDLCK : F_WRLCK);
  return ::fcntl(descriptor, F_OFD_SETLK, &range) == 0 || (errno != EAGAIN && errno != EACCES);
}

void unlock(int descriptor, LockByte byte) {
  struct flock range = range_of(byte, F_UNLCK);
  (void)::fcntl(descriptor, F_OFD_SETLK, &range);
}

bool is_locked(int descriptor, LockByte byte) {
  struct flock range = range_of(byte, F_WRLCK);
  return ::fcntl(descriptor, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
}

}  // namespace snug
