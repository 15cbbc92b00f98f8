// object_guard: what HDF5 1.10 does not ask of an object's header before it uses it.
//
// Object headers: HDF5 file format specification, sections IV.A.1 and IV.A.2; messages: dataspace IV.A.2.b, datatype
// IV.A.2.d, data layout IV.A.2.i, attribute IV.A.2.m, continuation IV.A.2.q. All numbers are little endian, offsets and
// lengths have 8 bytes.
#include "snug/record/internal/object_guard.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "snug/record/internal/h5.hpp"

namespace snug::record::internal {
namespace {

constexpr std::size_t kLargestBlock = std::size_t{1} << 24U;  // of a header; messages have at most 64 kB
constexpr std::size_t kMostBlocks = 1000;
constexpr std::uint64_t kDataspace = 0x01, kLayout = 0x08, kAttribute = 0x0c, kContinuation = 0x10;
constexpr std::uint64_t kShared = 0x02;  // flag of a message: it is elsewhere

[[noreturn]] void fail() { throw H5Error("an attribute or a layout that is larger than what holds it"); }

/// Reads numbers from bytes; beyond them there is nothing.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : left_(bytes) {}
  [[nodiscard]] std::size_t size() const { return left_.size(); }
  std::string_view take(std::uint64_t count) {
    if (count > left_.size()) fail();
    const std::string_view taken = left_.substr(0, count);
    left_.remove_prefix(count);
    return taken;
  }
  std::uint64_t number(std::size_t bytes) {
    std::uint64_t value = 0;
    const std::string_view taken = take(bytes);
    for (std::size_t i = bytes; i-- > 0;) value = value << 8U | static_cast<unsigned char>(taken[i]);
    return value;
  }

 private:
  std::string_view left_;
};

/// Product that stays at the most when it would be larger.
std::uint64_t multiply(std::uint64_t a, std::uint64_t b) {
  std::uint64_t product = 0;
  return __builtin_mul_overflow(a, b, &product) ? UINT64_MAX : product;
}

std::uint64_t count_values(Bytes dataspace) {
  constexpr std::uint64_t kNothing = 2;  // a kind of dataspace without values
  const std::uint64_t version = dataspace.number(1), rank = dataspace.number(1);
  dataspace.take(1);  // what else it has, behind the extents
  if (dataspace.number(1) == kNothing && version > 1) return 0;
  if (version == 1) dataspace.take(4);
  std::uint64_t count = 1;
  for (std::uint64_t i = 0; i < rank; ++i) count = multiply(count, dataspace.number(8));
  return count;
}

void check_attribute(Bytes message) {
  const std::uint64_t version = message.number(1), flags = message.number(1);
  const std::uint64_t name = message.number(2), type = message.number(2), space = message.number(2);
  if (version == 3) message.take(1);
  if (version < 1 || version > 3) throw H5Error("an attribute of an unknown version");
  const auto padded = [&](std::uint64_t size) { return version == 1 ? (size + 7) / 8 * 8 : size; };
  message.take(padded(name));
  Bytes type_bytes(message.take(padded(type)).substr(0, type)),
      space_bytes(message.take(padded(space)).substr(0, space));
  if (version > 1 && (flags & 3U) != 0) return;  // type or space are elsewhere: not read from here
  type_bytes.take(4);
  if (multiply(type_bytes.number(4), count_values(space_bytes)) > message.size()) fail();
}

/// What the messages of a header say of a dataset; empty where they say nothing.
struct Shape {
  std::optional<std::uint64_t> rank, chunk_rank;
};

/// Chunks without extent: the library divides by it as it opens the dataset. Returns their rank.
std::optional<std::uint64_t> check_layout(Bytes message) {
  constexpr std::uint64_t kChunked = 2;
  const std::uint64_t version = message.number(1);
  std::uint64_t rank = version < 3 ? message.number(1) : 0, bytes = 4;
  if (message.number(1) != kChunked) return std::nullopt;
  if (version < 3) {
    message.take(5 + 8);  // reserved, address
  } else if (version == 3) {
    rank = message.number(1);
    message.take(8);  // address
  } else {
    message.take(1);  // flags
    rank = message.number(1);
    bytes = message.number(1);
    if (bytes < 1 || bytes > 8) throw H5Error("chunks of an unknown shape");
  }
  for (std::uint64_t i = 0; i < rank; ++i) {
    if (message.number(bytes) == 0) throw H5Error("chunks that hold nothing");
  }
  return rank;
}

struct Place {
  std::uint64_t address = 0, size = 0;
};

/// The bytes of a file.
class File {
 public:
  File(int descriptor, std::uint64_t base) : descriptor_(descriptor), base_(base) {}
  [[nodiscard]] std::string read(Place place) const {
    std::string bytes(std::min<std::uint64_t>(place.size, kLargestBlock), '\0');
    const ssize_t got = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(base_ + place.address));
    bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(0, got)));
    return bytes;
  }

 private:
  int descriptor_;
  std::uint64_t base_;
};

/// What tells how messages are laid out.
struct Layout {
  bool is_second = false;  ///< version of the header
  bool has_order = false;  ///< second: messages have their order of creation
  std::size_t prefix() const { return is_second ? (has_order ? 6 : 4) : 8; }
};

/// Checks the messages of a block, collects where the header goes on.
void check_block(Bytes block, const Layout& layout, std::vector<Place>& more, Shape& shape) {
  while (block.size() >= layout.prefix()) {
    const std::uint64_t type = block.number(layout.is_second ? 1 : 2), size = block.number(2), flags = block.number(1);
    block.take(layout.prefix() - (layout.is_second ? 4 : 5));
    if (size > block.size()) return;  // the library refuses such a header, or it is the gap at the end of a block
    Bytes message(block.take(size));
    if (type == kAttribute && (flags & kShared) == 0) check_attribute(message);
    if (type == kLayout && (flags & kShared) == 0) shape.chunk_rank = check_layout(message);
    if (type == kDataspace && (flags & kShared) == 0 && size >= 2) {
      message.take(1);  // version
      shape.rank = message.number(1);
    }
    if (type == kContinuation && size >= 16) {
      const std::uint64_t address = message.number(8);
      more.push_back({address, message.number(8)});
    }
  }
}

/// The first block of a header, without what stands around it.
std::optional<std::string> read_first(const File& file, std::uint64_t address, Layout& layout) {
  constexpr std::size_t kLongestPrefix = 34;
  const std::string start = file.read({address, kLongestPrefix});
  if (start.size() < 16) return std::nullopt;
  if (!start.starts_with("OHDR")) {
    Bytes prefix(start);
    prefix.take(8);  // version, number of messages, references
    return file.read({address + 16, prefix.number(4)});
  }
  layout.is_second = true;
  Bytes prefix(start);
  prefix.take(5);
  const std::uint64_t flags = prefix.number(1);
  layout.has_order = (flags & 4U) != 0;
  prefix.take(((flags & 0x20U) != 0 ? 16 : 0) + ((flags & 0x10U) != 0 ? 4 : 0));
  const std::uint64_t size = prefix.number(std::size_t{1} << (flags & 3U));
  return file.read({address + start.size() - prefix.size(), size});
}

#if H5_VERSION_GE(1, 12, 0)
using ObjectInfo = H5O_info1_t;  // with the address, which later structures hide
#else
using ObjectInfo = H5O_info_t;
#endif

}  // namespace

void check_header(hid_t place, const char* path) {
  ObjectInfo info;
  check(H5Oget_info_by_name2(place, path, &info, H5O_INFO_BASIC, H5P_DEFAULT), path);
  const Handle file(H5Iget_file_id(place), "file of an object");
  const Handle access(H5Fget_access_plist(file.get()), "file access");
  void* descriptor = nullptr;
  if (H5Pget_driver(access.get()) != H5FD_SEC2 || H5Fget_vfd_handle(file.get(), access.get(), &descriptor) < 0) return;
  const Handle creation(H5Fget_create_plist(file.get()), "file creation");
  hsize_t base = 0;
  std::size_t offset_bytes = 0, length_bytes = 0;
  check(H5Pget_userblock(creation.get(), &base), "file creation");
  check(H5Pget_sizes(creation.get(), &offset_bytes, &length_bytes), "file creation");
  if (offset_bytes != 8 || length_bytes != 8) throw H5Error("a file with offsets of an unusual size");
  const File bytes(*static_cast<int*>(descriptor), base);
  Layout layout;
  Shape shape;
  std::vector<Place> more;
  if (const std::optional<std::string> first = read_first(bytes, info.addr, layout))
    check_block(Bytes(*first), layout, more, shape);
  for (std::size_t i = 0; i < more.size(); ++i) {
    if (i == kMostBlocks) throw H5Error("a header in too many pieces");
    std::string block = bytes.read(more[i]);
    if (layout.is_second) {  // a signature before, a checksum behind
      if (block.size() < 8) continue;
      block = block.substr(4, block.size() - 8);
    }
    check_block(Bytes(block), layout, more, shape);
  }
  // The last extent of a chunk is the size of an element.
  if (shape.chunk_rank && shape.rank && *shape.chunk_rank != *shape.rank + 1)
    throw H5Error("chunks of another shape than the dataset");
}

}  // namespace snug::record::internal
