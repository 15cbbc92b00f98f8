// live_file: opens a recording for reading, also while somebody writes it.
#include "snug/record/internal/live_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "snug/core/descriptor.hpp"
#include "snug/core/file_lock.hpp"
#include "snug/core/input_log.hpp"
#include "snug/record/internal/commit_driver.hpp"

namespace snug::record::internal {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::seconds kPatience(30);             ///< for a copy that was made between two commits
constexpr auto kLongestCopy = (kWriterPatience * 3) / 4;  ///< well before the writer stops waiting

std::vector<unsigned char> read_whole(int descriptor) {
  struct stat status = {};
  if (::fstat(descriptor, &status) != 0) throw H5Error(std::strerror(errno));
  std::vector<unsigned char> bytes(static_cast<std::size_t>(status.st_size));
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t got = ::pread(descriptor, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) throw H5Error(got < 0 ? std::strerror(errno) : "the file became shorter while it was read");
    done += static_cast<std::size_t>(got);
  }
  return bytes;
}

/// The file as one commit left it.
std::vector<unsigned char> copy_between_commits(int descriptor) {
  const Clock::time_point deadline = Clock::now() + kPatience;
  do {
    if (!try_lock(descriptor, LockByte::Commit, LockKind::Shared)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      continue;
    }
    const Clock::time_point start = Clock::now();
    std::vector<unsigned char> bytes = read_whole(descriptor);
    unlock(descriptor, LockByte::Commit);
    if (Clock::now() - start < kLongestCopy) return bytes;
  } while (Clock::now() < deadline);
  throw H5Error("it is being written, and too large to copy between two writes: wait until it is finished");
}

/// A file in memory. HDF5 tells files in memory apart by their names alone.
Handle open_image(std::vector<unsigned char> bytes) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
  check(H5Pset_fapl_core(access.get(), std::size_t{1} << 20U, false), "file access");
  check(H5Pset_file_image(access.get(), bytes.data(), bytes.size()), "file access");
  const std::string name = "copy of a recording " + std::to_string(Clock::now().time_since_epoch().count());
  return {H5Fopen(name.c_str(), H5F_ACC_RDONLY, access.get()), "cannot open"};
}

}  // namespace

Handle open_for_reading(const std::filesystem::path& path) {
  // The name may lead to another file at any time: look at, and open, one and the same.
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!file.is_open()) throw H5Error(std::string("cannot open: ") + std::strerror(errno));
  if (is_locked(file.get(), LockByte::Writer)) return open_image(copy_between_commits(file.get()));
  note_input_file(path);
  const std::string same = "/proc/self/fd/" + std::to_string(file.get());
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), "file access");
  check(H5Pset_file_locking(access.get(), false, true), "file access");
  return {H5Fopen(same.c_str(), H5F_ACC_RDONLY, access.get()), "cannot open"};
}

}  // namespace snug::record::internal
