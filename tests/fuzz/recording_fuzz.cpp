// Recordings (HDF5). The input is a list of changes to a small good recording, as bytes alone would hardly ever get
// past the checksums of the format: other numbers and texts, other extents, other bytes, an earlier end.
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <vector>

#include "fuzz.hpp"
#include "scratch_file.hpp"
#include "snug/core/read_file.hpp"
#include "snug/record/reader.hpp"
#include "snug/record/test/random_recording.hpp"
#include "snug/record/writer.hpp"
#include "snug/replay/replay.hpp"

namespace {

using namespace snug;

/// An identifier of the library, given back at the end. A change that the format does not allow fails, and is none.
class Id {
 public:
  explicit Id(hid_t id) : id_(id) {}
  ~Id() {
    if (id_ >= 0) H5Idec_ref(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: read as what it is

 private:
  hid_t id_;
};

std::vector<hsize_t> dims_of(hid_t dataset) {
  const Id space(H5Dget_space(dataset));
  std::vector<hsize_t> dims(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  if (!dims.empty()) H5Sget_simple_extent_dims(space, dims.data(), nullptr);
  return dims;
}

constexpr std::array kNumbers = {"/time",
                                 "/program_row",
                                 "/cup/attached_body",
                                 "/cup/pose",
                                 "/solver/status",
                                 "/contacts/frame_first",
                                 "/contacts/frame_count",
                                 "/contacts/frame_block",
                                 "/contacts/block_body",
                                 "/contacts/block_first",
                                 "/contacts/block_count",
                                 "/contacts/point",
                                 "/contacts/state",
                                 "/bodies/present",
                                 "/bodies/pose",
                                 "/bodies/kind",
                                 "/bodies/mass",
                                 "/shapes/body",
                                 "/shapes/kind",
                                 "/shapes/half",
                                 "/shapes/vertex",
                                 "/shapes/vertex_first",
                                 "/shapes/vertex_count",
                                 "/events/time",
                                 "/events/number_first",
                                 "/events/number_count",
                                 "/container/pose"};
constexpr std::array kTexts = {"/scenario",       "/program",     "/settings",          "/result",
                               "/container/name", "/bodies/name", "/bodies/type",       "/events/kind",
                               "/events/body",    "/events/text", "/events/number_name"};

/// Takes the input apart, byte by byte; zero when there is none left.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}
  [[nodiscard]] bool is_empty() const { return left_ == 0; }
  std::uint8_t next() {
    if (left_ == 0) return 0;
    --left_;
    return *data_++;
  }
  std::uint64_t number(int bytes) {
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) value = value << 8U | next();
    return value;
  }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// In memory where the system offers it; of this process alone.
const fuzz::ScratchFile& scratch() {
  static const fuzz::ScratchFile file(".h5");
  return file;
}

const std::string& good_recording() {
  static const std::string bytes = [] {
    Rng rng = Rng(3).split("fuzz");
    record::Recording recording = record::test::random_recording(rng, 3, 8, 4);
    recording.header.record_period = 0.25;  // chunks of four frames
    recording.result = R"({"boxes": [{"id": "a", "state": "packed", "events": []}], "wall_s": 1.0})";
    record::save_recording(scratch().path(), recording);
    return read_file(scratch().path(), "a recording");
  }();
  return bytes;
}

/// One number of a dataset becomes another.
void change_number(hid_t file, const char* path, Bytes& bytes) {
  const Id dataset(H5Dopen2(file, path, H5P_DEFAULT));
  const Id type(H5Dget_type(dataset));
  constexpr std::size_t kMost = 100'000;  // an extent may have been changed before
  std::size_t count = dataset < 0 ? 0 : 1;
  for (const hsize_t extent : dims_of(dataset)) count = extent > kMost || count > kMost ? 0 : count * extent;
  if (count == 0 || count > kMost) return;
  const std::size_t size = H5Tget_size(type);
  std::vector<unsigned char> values(count * size);
  if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) return;
  const std::size_t at = bytes.number(2) % count;
  for (std::size_t i = 0; i < size; ++i) values[at * size + i] = bytes.next();
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

/// A growing dataset gets another extent.
void change_extent(hid_t file, const char* path, Bytes& bytes) {
  const Id dataset(H5Dopen2(file, path, H5P_DEFAULT));
  std::vector<hsize_t> dims = dims_of(dataset);
  if (dataset < 0 || dims.empty()) return;
  // Not more: the library visits each chunk that an extent has less or more.
  dims[bytes.next() % dims.size()] = bytes.number(1 + bytes.next() % 2);
  H5Dset_extent(dataset, dims.data());
}

/// A dataset of texts, with as many of as much as the input says.
void change_texts(hid_t file, const char* path, Bytes& bytes) {
  const hsize_t count = bytes.next() % 8, size = 1 + bytes.next();
  const std::size_t written = bytes.next();
  std::string padded(count * size, '\0');
  for (std::size_t i = 0; i < std::min(written, padded.size()); ++i) padded[i] = static_cast<char>(bytes.next());
  H5Ldelete(file, path, H5P_DEFAULT);
  const Id type(H5Tcopy(H5T_C_S1)), space(H5Screate_simple(1, &count, nullptr));
  H5Tset_size(type, size);
  const Id dataset(H5Dcreate2(file, path, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  if (count > 0) H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data());
}

void apply_changes(Bytes& bytes) {
  const int changes = bytes.next() % 8;
  if (changes == 0) return;
  const Id file(H5Fopen(scratch().path().c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
  for (int i = 0; i < changes; ++i) {
    switch (bytes.next() % 4) {
      case 0:
      case 1:
        change_number(file, kNumbers[bytes.next() % kNumbers.size()], bytes);
        break;
      case 2:
        change_extent(file, kNumbers[bytes.next() % kNumbers.size()], bytes);
        break;
      default:
        change_texts(file, kTexts[bytes.next() % kTexts.size()], bytes);
    }
  }
}

/// Bytes here and there, wherever they lie.
void poke(Bytes& bytes) {
  std::string text = read_file(scratch().path(), "a recording");
  for (int i = bytes.next() % 16; i > 0 && !text.empty(); --i)
    text[bytes.number(3) % text.size()] = static_cast<char>(bytes.next());
  if (bytes.next() % 4 == 1) text.resize(bytes.number(3) % (text.size() + 1));
  scratch().write(text);
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  H5dont_atexit();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Bytes bytes(data, size);
  scratch().write(good_recording());
  apply_changes(bytes);
  if (!bytes.is_empty()) poke(bytes);
  fuzz::expect_answer([] {
    record::RecordingReader reader(scratch().path());
    (void)replay::encode_recording(reader, "x.h5");
  });
  ::unlink(scratch().path().c_str());
  return 0;
}
