// chunks: unpacked one by one, converted, and copied to where they belong.
#include "snug/record/internal/chunks.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace snug::record::internal {
namespace {

/// Bytes of a chunk when it is unpacked. The largest of ours holds a second of one byte for each body.
constexpr hsize_t kLargestChunk = hsize_t{32} << 20U;

using Buffer = std::vector<unsigned char>;

Dims chunk_of(hid_t properties) {
  Dims chunk(H5S_MAX_RANK, 0);
  chunk.resize(static_cast<std::size_t>(std::max(0, H5Pget_chunk(properties, H5S_MAX_RANK, chunk.data()))));
  return chunk;
}

/// At most one more than the largest.
hsize_t bytes_of(const Dims& chunk, std::size_t element) {
  hsize_t bytes = element;
  for (const hsize_t extent : chunk)
    bytes = extent > kLargestChunk ? kLargestChunk + 1 : std::min(bytes, kLargestChunk + 1) * extent;
  return bytes;
}

/// What chunks pass through when they are written, in that order.
std::vector<H5Z_filter_t> filters_of(hid_t properties) {
  std::vector<H5Z_filter_t> filters(static_cast<std::size_t>(std::max(0, H5Pget_nfilters(properties))));
  for (std::size_t i = 0; i < filters.size(); ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    filters[i] = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
  }
  return filters;
}

/// Byte k of all elements lies together when it is shuffled; what is left over at the end is as it was.
void unshuffle(const Buffer& from, std::size_t element, Buffer& to) {
  const std::size_t count = from.size() / element;
  to = from;
  for (std::size_t k = 0; k < element; ++k) {
    const unsigned char* const lane = from.data() + k * count;
    for (std::size_t i = 0; i < count; ++i) to[i * element + k] = lane[i];
  }
}

class ChunkReader {
 public:
  ChunkReader(hid_t dataset, hid_t type)
      : dataset_(dataset),
        type_(type),
        stored_type_(H5Dget_type(dataset), "type"),
        properties_(H5Dget_create_plist(dataset), "dataset"),
        chunk_(chunk_of(properties_.get())),
        filters_(filters_of(properties_.get())),
        stored_element_(H5Tget_size(stored_type_.get())),
        element_(H5Tget_size(type)),
        size_(bytes_of(chunk_, stored_element_)) {}

  [[nodiscard]] const Dims& chunk() const { return chunk_; }
  [[nodiscard]] std::size_t element() const { return element_; }

  /// The elements of the chunk with this corner, as `type`; of one that was never written, what the dataset says. Valid
  /// until the next.
  const unsigned char* read(const Dims& corner) {
    const hsize_t stored = stored_size(corner);
    if (stored == 0) return fill();
    constexpr hsize_t kOverhead = 1024;
    if (stored > size_ + size_ / 1000 + kOverhead) fail();
    packed_.resize(stored);
    std::uint32_t skipped = 0;
    check(H5Dread_chunk(dataset_, H5P_DEFAULT, corner.data(), &skipped, packed_.data()), "chunk");
    bytes_.swap(packed_);
    for (std::size_t i = filters_.size(); i-- > 0;) {
      if ((skipped >> i & 1U) == 0) undo(filters_[i]);
    }
    if (bytes_.size() != size_) fail();
    if (H5Tequal(stored_type_.get(), type_) <= 0) convert();
    return bytes_.data();
  }

 private:
  /// 0 of a chunk that was never written.
  [[nodiscard]] hsize_t stored_size(const Dims& corner) const {
    hsize_t size = 0;
    if (filters_
            .empty()) {  // the other function would tell the size that the dataset says; this one visits every chunk
      unsigned skipped = 0;
      haddr_t address = HADDR_UNDEF;
      check(H5Dget_chunk_info_by_coord(dataset_, corner.data(), &skipped, &address, &size), "chunk");
      if (address != HADDR_UNDEF && size != size_) fail();
      return address == HADDR_UNDEF ? 0 : size;
    }
    if (H5Dget_chunk_storage_size(dataset_, corner.data(), &size) < 0) {
      H5Eclear2(H5E_DEFAULT);
      return 0;
    }
    return size;
  }

  [[noreturn]] static void fail() { throw H5Error("a chunk of another size than it says"); }

  const unsigned char* fill() {
    const std::size_t count = size_ / stored_element_;
    Buffer value(element_, 0);
    check(H5Pget_fill_value(properties_.get(), type_, value.data()), "fill value");
    bytes_.resize(count * element_);
    for (std::size_t i = 0; i < count; ++i)
      std::copy(value.begin(), value.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(i * element_));
    return bytes_.data();
  }

  void undo(H5Z_filter_t filter) {
    bytes_.swap(packed_);
    if (filter == H5Z_FILTER_SHUFFLE) {
      unshuffle(packed_, stored_element_, bytes_);
      return;
    }
    bytes_.resize(size_);
    uLongf got = static_cast<uLongf>(size_);
    if (uncompress(bytes_.data(), &got, packed_.data(), static_cast<uLong>(packed_.size())) != Z_OK) fail();
    bytes_.resize(got);
  }

  void convert() {
    const std::size_t count = size_ / stored_element_;
    bytes_.resize(count * std::max(stored_element_, element_));
    check(H5Tconvert(stored_type_.get(), type_, count, bytes_.data(), nullptr, H5P_DEFAULT), "conversion");
  }

  const hid_t dataset_, type_;
  const Handle stored_type_, properties_;
  const Dims chunk_;
  const std::vector<H5Z_filter_t> filters_;
  const std::size_t stored_element_, element_;
  const hsize_t size_;  ///< bytes of a chunk, unpacked
  Buffer packed_, bytes_;
};

/// Moves on to the next place of the box low .. high in steps, the last dimension fastest; false at its end.
bool advance(Dims& at, const Dims& low, const Dims& high, const Dims& step) {
  for (std::size_t d = at.size(); d-- > 0;) {
    at[d] += step[d];
    if (at[d] < high[d]) return true;
    at[d] = low[d];
  }
  return false;
}

/// Where an element lies in a box with this corner and these extents, row by row.
std::size_t offset_of(const Dims& at, const Dims& corner, const Dims& extent) {
  hsize_t offset = 0;
  for (std::size_t d = 0; d < at.size(); ++d) offset = offset * extent[d] + (at[d] - corner[d]);
  return offset;
}

}  // namespace

void check_chunk_layout(hid_t properties, hid_t type, const char* path) {
  if (bytes_of(chunk_of(properties), H5Tget_size(type)) > kLargestChunk)
    throw H5Error(std::string(path) + " is kept in chunks that are too large");
  const std::vector<H5Z_filter_t> filters = filters_of(properties);
  const bool is_known = std::ranges::all_of(
      filters, [](H5Z_filter_t one) { return one == H5Z_FILTER_DEFLATE || one == H5Z_FILTER_SHUFFLE; });
  unsigned options = 0;  // chunks at the edge may be left unpacked, without a word in the chunk
  check(H5Pget_chunk_opts(properties, &options), path);
  if (!is_known || options != 0 || std::ranges::count(filters, H5Z_FILTER_DEFLATE) > 1)
    throw H5Error(std::string(path) + " is packed in an unknown way");
}

void read_chunked_rows(hid_t dataset, hid_t type, const Dims& dims, hsize_t first, hsize_t count, void* out) {
  if (count == 0 || std::ranges::find(dims, hsize_t{0}) != dims.end()) return;
  ChunkReader reader(dataset, type);
  const Dims& chunk = reader.chunk();
  if (chunk.size() != dims.size() || std::ranges::find(chunk, hsize_t{0}) != chunk.end())
    throw H5Error("chunks of another shape than the dataset");
  const std::size_t element = reader.element();
  auto* const bytes = static_cast<unsigned char*>(out);
  Dims begin(dims.size(), 0), extent = dims, end = dims;  // of what is asked for
  begin[0] = first, extent[0] = count, end[0] = first + count;
  Dims corner = begin, first_corner = begin;
  corner[0] = first_corner[0] = first - first % chunk[0];
  do {
    const unsigned char* const from = reader.read(corner);
    Dims low = corner, high = corner, step(dims.size(), 1);
    for (std::size_t d = 0; d < dims.size(); ++d) {
      low[d] = std::max(corner[d], begin[d]);
      high[d] = std::min(corner[d] + chunk[d], end[d]);
    }
    const hsize_t run = high.back() - low.back();
    step.back() = run;
    Dims at = low;
    do {
      std::memcpy(bytes + element * offset_of(at, begin, extent), from + element * offset_of(at, corner, chunk),
                  element * run);
    } while (advance(at, low, high, step));
  } while (advance(corner, first_corner, end, chunk));
}

}  // namespace snug::record::internal
