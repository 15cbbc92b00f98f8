// Commit driver: an HDF5 file that on disk only ever steps from one whole state to the next.
#include "snug/record/internal/commit_driver.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <map>
#include <memory>
#include <new>
#include <thread>

#include "snug/core/file_lock.hpp"

namespace snug::record::internal {
namespace {

struct PendingWrite {
  H5FD_mem_t type = H5FD_MEM_DEFAULT;
  std::vector<unsigned char> bytes;
};

struct CommitFile {
  H5FD_t base = {};  ///< must be first: HDF5 sees only this
  int descriptor = -1;
  haddr_t end_of_allocation = 0;
  haddr_t end_of_file = 0;                  ///< of the file on disk
  haddr_t committed_end = 0;                ///< nothing in the file refers to what lies behind
  bool has_failed = false;                  ///< reported once; then writes are dropped so that HDF5 can close
  std::map<haddr_t, PendingWrite> pending;  ///< changes of the committed part, by address
  std::vector<unsigned char> tail;          ///< what follows the committed part
};

CommitFile& self(H5FD_t* file) { return *reinterpret_cast<CommitFile*>(file); }
const CommitFile& self(const H5FD_t* file) { return *reinterpret_cast<const CommitFile*>(file); }

/// Puts the reason of the system on HDF5's error stack.
herr_t fail(CommitFile& file) {
  file.has_failed = true;
  H5Epush2(H5E_DEFAULT, __FILE__, __func__, __LINE__, H5E_ERR_CLS, H5E_IO, H5E_WRITEERROR, "%s", std::strerror(errno));
  return -1;
}

bool write_at(CommitFile& file, haddr_t address, const unsigned char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = ::pwrite(file.descriptor, bytes, size, static_cast<off_t>(address));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    address += static_cast<haddr_t>(written);
    bytes += written;
    size -= static_cast<std::size_t>(written);
    file.end_of_file = std::max(file.end_of_file, address);
  }
  return true;
}

/// Order in which changes are committed; see the header. Roots of chunk indices before their children, because a
/// child that was split gives up entries which only the new root finds elsewhere.
int rank_of(const PendingWrite& write) {
  constexpr int kIndexRank = 300;
  switch (write.type) {
    case H5FD_MEM_SUPER:
      return 0;
    case H5FD_MEM_DRAW:
      return 1;
    case H5FD_MEM_GHEAP:
      return 2;
    case H5FD_MEM_LHEAP:
      return 3;
    case H5FD_MEM_BTREE: {
      const bool is_node = write.bytes.size() > 5 && std::memcmp(write.bytes.data(), "TREE", 4) == 0;
      return is_node ? kIndexRank - write.bytes[5] : kIndexRank;  // byte 5: level above the leaves, 0..255
    }
    default:
      return kIndexRank + 1;
  }
}

/// Held while the file is not whole. Readers hold the lock for the time that it takes to copy the file
/// (live_file.cpp); one that does not give it back must not hold up the run.
class CommitLock {
 public:
  explicit CommitLock(int descriptor) : descriptor_(descriptor) {
    const auto deadline = std::chrono::steady_clock::now() + kWriterPatience;
    while (!try_lock(descriptor_, LockByte::Commit, LockKind::Exclusive)) {
      if (std::chrono::steady_clock::now() > deadline) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  ~CommitLock() { unlock(descriptor_, LockByte::Commit); }
  CommitLock(const CommitLock&) = delete;
  CommitLock& operator=(const CommitLock&) = delete;

 private:
  int descriptor_;
};

bool commit(CommitFile& file) {
  const CommitLock lock(file.descriptor);
  if (!write_at(file, file.committed_end, file.tail.data(), file.tail.size())) return false;
  file.tail.clear();
  if (file.end_of_file < file.end_of_allocation) {
    if (::ftruncate(file.descriptor, static_cast<off_t>(file.end_of_allocation)) != 0) return false;
    file.end_of_file = file.end_of_allocation;
  }
  std::vector<std::pair<int, haddr_t>> order;
  for (const auto& [address, write] : file.pending) order.emplace_back(rank_of(write), address);
  std::sort(order.begin(), order.end());
  for (const auto& [rank, address] : order) {
    const std::vector<unsigned char>& bytes = file.pending.at(address).bytes;
    if (!write_at(file, address, bytes.data(), bytes.size())) return false;
  }
  file.pending.clear();
  file.committed_end = file.end_of_allocation;
  return true;
}

H5FD_t* open_file(const char* name, unsigned flags, hid_t /*access*/, haddr_t /*max_address*/) {
  int mode = (flags & H5F_ACC_RDWR) != 0 ? O_RDWR : O_RDONLY;
  if ((flags & H5F_ACC_CREAT) != 0) mode |= O_CREAT;
  if ((flags & H5F_ACC_TRUNC) != 0) mode |= O_TRUNC;
  if ((flags & H5F_ACC_EXCL) != 0) mode |= O_EXCL;
  auto file = std::make_unique<CommitFile>();
  file->descriptor = ::open(name, mode | O_CLOEXEC, 0666);
  struct stat status = {};
  if (file->descriptor < 0 || ::fstat(file->descriptor, &status) != 0) {
    fail(*file);
    if (file->descriptor >= 0) ::close(file->descriptor);
    return nullptr;
  }
  file->end_of_file = static_cast<haddr_t>(status.st_size);
  file->committed_end = file->end_of_file;
  return &file.release()->base;
}

herr_t close_file(H5FD_t* base) {
  const std::unique_ptr<CommitFile> file(&self(base));
  if (!file->has_failed && !commit(*file)) fail(*file);
  ::close(file->descriptor);
  return 0;
}

herr_t query(const H5FD_t* /*file*/, unsigned long* flags) {
  // No accumulation: each table arrives alone, with its kind. No aggregation: new tables lie behind the old end.
  *flags = H5FD_FEAT_DEFAULT_VFD_COMPATIBLE;
  return 0;
}

/// Places tables so that none crosses a page of the system: a write within a page is whole or not there when the
/// process is killed, one across pages may be half there.
haddr_t allocate(H5FD_t* base, H5FD_mem_t type, hid_t /*transfer*/, hsize_t size) {
  constexpr haddr_t kPage = 4096;
  CommitFile& file = self(base);
  haddr_t address = file.end_of_allocation;
  const haddr_t left = kPage - address % kPage;
  if (type != H5FD_MEM_DRAW && size <= kPage && size > left) address += left;
  file.end_of_allocation = address + size;
  return address;
}

haddr_t get_eoa(const H5FD_t* file, H5FD_mem_t /*type*/) { return self(file).end_of_allocation; }

herr_t set_eoa(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t address) {
  self(file).end_of_allocation = address;
  return 0;
}

haddr_t get_eof(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return std::max(self(file).end_of_file, self(file).end_of_allocation);
}

/// Copies the part of `from` at `from_address` that lies within the `size` bytes at `address`.
void overlay(haddr_t from_address, const std::vector<unsigned char>& from, haddr_t address, std::size_t size,
             unsigned char* out) {
  const haddr_t begin = std::max(from_address, address);
  const haddr_t end = std::min(from_address + from.size(), address + size);
  if (begin < end) std::memcpy(out + (begin - address), from.data() + (begin - from_address), end - begin);
}

herr_t read_file(H5FD_t* base, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t address, std::size_t size,
                 void* buffer) {
  CommitFile& file = self(base);
  auto* out = static_cast<unsigned char*>(buffer);
  std::memset(out, 0, size);
  std::size_t done = 0;
  while (done < size) {
    const ssize_t got = ::pread(file.descriptor, out + done, size - done, static_cast<off_t>(address + done));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return fail(file);
    if (got == 0) break;  // behind the end: zeros
    done += static_cast<std::size_t>(got);
  }
  for (const auto& [from, write] : file.pending) overlay(from, write.bytes, address, size, out);
  overlay(file.committed_end, file.tail, address, size, out);
  return 0;
}

/// Drops what pending writes hold of the given range, so that of two writes of one byte the later one counts.
void forget_pending(CommitFile& file, haddr_t address, std::size_t size) {
  auto it = file.pending.lower_bound(address);
  if (it != file.pending.begin()) --it;
  while (it != file.pending.end() && it->first < address + size) {
    const haddr_t first = it->first;
    const haddr_t last = first + it->second.bytes.size();
    if (last <= address) {
      ++it;
      continue;
    }
    PendingWrite old = std::move(it->second);
    it = file.pending.erase(it);
    const auto begin = old.bytes.begin();
    if (first < address) {
      file.pending[first] = {old.type, {begin, begin + static_cast<std::ptrdiff_t>(address - first)}};
    }
    if (last > address + size) {
      const auto rest = static_cast<std::ptrdiff_t>(address + size - first);
      it = file.pending.insert_or_assign(address + size, PendingWrite{old.type, {begin + rest, old.bytes.end()}}).first;
    }
  }
}

herr_t write_file(H5FD_t* base, H5FD_mem_t type, hid_t /*transfer*/, haddr_t address, std::size_t size,
                  const void* buffer) {
  CommitFile& file = self(base);
  if (file.has_failed) return 0;
  const auto* bytes = static_cast<const unsigned char*>(buffer);
  if (address >= file.committed_end) {
    const std::size_t offset = address - file.committed_end;
    if (file.tail.size() < offset + size) file.tail.resize(offset + size);
    std::copy(bytes, bytes + size, file.tail.begin() + static_cast<std::ptrdiff_t>(offset));
    return 0;
  }
  const auto same = file.pending.find(address);
  if (same != file.pending.end() && same->second.bytes.size() == size) {
    same->second.type = type;
    std::copy(bytes, bytes + size, same->second.bytes.begin());
    return 0;
  }
  forget_pending(file, address, size);
  file.pending[address] = {type, {bytes, bytes + size}};
  return 0;
}

herr_t flush_file(H5FD_t* base, hid_t /*transfer*/, hbool_t /*closing*/) {
  CommitFile& file = self(base);
  if (file.has_failed) return 0;
  return commit(file) ? 0 : fail(file);
}

/// Cuts what lies behind the end; the file is made longer by the next commit.
herr_t truncate_file(H5FD_t* base, hid_t /*transfer*/, hbool_t closing) {
  CommitFile& file = self(base);
  if (file.has_failed || !closing || file.end_of_file <= file.end_of_allocation) return 0;
  if (!commit(file)) return fail(file);
  const CommitLock lock(file.descriptor);
  if (::ftruncate(file.descriptor, static_cast<off_t>(file.end_of_allocation)) != 0) return fail(file);
  file.end_of_file = file.end_of_allocation;
  return 0;
}

H5FD_class_t make_class() {
  H5FD_class_t driver = {};
#ifdef H5FD_CLASS_VERSION  // HDF5 1.14
  driver.version = H5FD_CLASS_VERSION;
  driver.value = static_cast<H5FD_class_value_t>(600);  // any number of the range left to users
#endif
  driver.name = "snug_commit";
  driver.maxaddr = HADDR_MAX >> 1;
  driver.fc_degree = H5F_CLOSE_WEAK;
  driver.open = open_file;
  driver.close = close_file;
  driver.query = query;
  driver.alloc = allocate;
  driver.get_eoa = get_eoa;
  driver.set_eoa = set_eoa;
  driver.get_eof = get_eof;
  driver.read = read_file;
  driver.write = write_file;
  driver.flush = flush_file;
  driver.truncate = truncate_file;
  const H5FD_mem_t free_lists[] = H5FD_FLMAP_DICHOTOMY;
  std::copy(std::begin(free_lists), std::end(free_lists), driver.fl_map);
  return driver;
}

}  // namespace

Handle use_commit_driver(hid_t access) {
  const H5FD_class_t driver_class = make_class();
  Handle driver(H5FDregister(&driver_class), "register file driver");
  check(H5Pset_driver(access, driver.get(), nullptr), "set file driver");
  return driver;
}

}  // namespace snug::record::internal
