// Recordings made to harm: counts that the file does not hold, chunks that unpack to more than they say, data that lies
// in other files. They are refused, and reading them takes little memory.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/test/peak_memory.hpp"
#include "snug/record/grid_file.hpp"
#include "snug/record/internal/h5.hpp"
#include "snug/record/reader.hpp"
#include "snug/record/test/random_recording.hpp"
#include "snug/record/writer.hpp"

namespace snug::record {
namespace {

using internal::Handle;
using ::snug::test::allowed_memory;
using ::snug::test::peak_memory;
using test::ScratchFolder;
using Edit = std::function<void(hid_t file)>;

constexpr int kBodies = 3, kFrames = 300;

/// Reads everything a frame at a time; what was complained about, or "read".
std::string read_through(const std::filesystem::path& path) {
  try {
    RecordingReader reader(path);
    Frame frame;
    for (std::size_t i = 0; i < reader.frame_count(); ++i) reader.read_frame(i, frame);
  } catch (const InputError& error) {
    return error.what();
  }
  return "read";
}

class HostileRecording : public ::testing::Test {
 protected:
  void SetUp() override {
    Rng rng = Rng(5).split("hostile");
    save_recording(path_, test::random_recording(rng, kBodies, kFrames, 10));
  }
  void edit(const Edit& change) const {
    const Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), "open");
    change(file.get());
  }
  /// In a child: what the library takes and leaves is not the next test's. The message goes into a file.
  void expect_refused_in_little_memory(const std::string& part) const {
    const std::filesystem::path said = folder_ / "said.txt";
    const auto peak = peak_memory([&] { std::ofstream(said) << read_through(path_); });
    ASSERT_TRUE(peak.has_value()) << "the reader crashed";
    std::ifstream file(said);
    const std::string message{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    EXPECT_NE(message.find(part), std::string::npos) << message;
    EXPECT_LE(*peak, allowed_memory(std::filesystem::file_size(path_)));
  }

  ScratchFolder folder_;
  std::filesystem::path path_ = folder_ / "run.h5";
};

/// A growing dataset says that it has so many rows.
void extend(hid_t file, const char* path, hsize_t rows) {
  const Handle dataset(H5Dopen2(file, path, H5P_DEFAULT), path);
  internal::Dims dims = internal::dims_of(dataset.get());
  dims[0] = rows;
  internal::check(H5Dset_extent(dataset.get(), dims.data()), path);
}

/// Takes a dataset away and puts one of this shape in its place, in which nothing was written.
Handle replace(hid_t file, const char* path, hid_t type, const internal::Dims& dims, const Handle& properties) {
  internal::check(H5Ldelete(file, path, H5P_DEFAULT), path);
  // Chunks may be larger than what grows only.
  const internal::Dims most(dims.size(), H5S_UNLIMITED);
  const bool grows = H5Pget_layout(properties.get()) == H5D_CHUNKED;
  const Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), grows ? most.data() : nullptr), path);
  return {H5Dcreate2(file, path, type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), path};
}

Handle in_chunks(const internal::Dims& chunk, bool is_deflated) {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), "properties");
  internal::check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()), "chunk");
  if (is_deflated) internal::check(H5Pset_deflate(properties.get(), 9), "deflate");
  return properties;
}

Handle plain() { return {H5Pcreate(H5P_DATASET_CREATE), "properties"}; }

TEST_F(HostileRecording, IsReadBeforeItIsTamperedWith) { EXPECT_EQ(read_through(path_), "read"); }

TEST_F(HostileRecording, FramesThatTheFileCannotHoldAreRefused) {
  for (const hsize_t rows : {hsize_t{1'000'000}, hsize_t{1} << 40U, hsize_t{1} << 62U}) {
    SetUp();
    edit([&](hid_t file) {
      for (const char* path : {"/time",
                               "/step",
                               "/program_row",
                               "/tool/pose",
                               "/tool/twist",
                               "/tool/pose_command",
                               "/cup/vacuum_command",
                               "/cup/blow_off_command",
                               "/cup/pressure_gauge",
                               "/cup/attached_body",
                               "/cup/pose",
                               "/cup/length",
                               "/cup/bend",
                               "/cup/wrench",
                               "/flange/wrench",
                               "/solver/residual",
                               "/solver/iterations",
                               "/solver/status",
                               "/contacts/frame_first",
                               "/contacts/frame_count",
                               "/bodies/present",
                               "/bodies/pose",
                               "/bodies/twist",
                               "/joints/position",
                               "/joints/velocity",
                               "/joints/torque"})
        if (internal::has_link(file, path)) extend(file, path, rows);
    });
    expect_refused_in_little_memory("/time has more rows than a file of this size can hold");
  }
}

TEST_F(HostileRecording, TablesThatTheFileCannotHoldAreRefused) {
  for (const char* path :
       {"/contacts/point", "/contacts/normal", "/contacts/force", "/contacts/gap", "/contacts/state",
        "/contacts/block_body", "/contacts/block_first", "/contacts/block_count", "/contacts/frame_block",
        "/events/time", "/events/kind", "/events/text", "/events/number_name", "/events/number_value"}) {
    SCOPED_TRACE(path);
    SetUp();
    edit([&](hid_t file) { extend(file, path, hsize_t{1} << 31U); });
    expect_refused_in_little_memory(std::string(path) + " has more rows than a file of this size can hold");
  }
}

TEST_F(HostileRecording, TextsAndBodiesThatTheFileCannotHoldAreRefused) {
  edit([](hid_t file) { replace(file, "/scenario", internal::string_type(2'000'000'000).get(), {1}, plain()); });
  expect_refused_in_little_memory("/scenario has more rows than a file of this size can hold");
  SetUp();
  edit([](hid_t file) {
    const Handle name = internal::string_type(1);
    replace(file, "/bodies/name", name.get(), {100'000'000}, in_chunks({1'000'000}, true));
  });
  expect_refused_in_little_memory("/bodies/name has more rows than a file of this size can hold");
  SetUp();
  edit([](hid_t file) {
    replace(file, "/shapes/vertex", H5T_IEEE_F64LE, {50'000'000, 3}, in_chunks({100'000, 3}, true));
  });
  expect_refused_in_little_memory("/shapes/vertex has more rows than a file of this size can hold");
  SetUp();  // the product of the other extents is 3 modulo 2^64
  edit([](hid_t file) { replace(file, "/shapes/vertex", H5T_IEEE_F64LE, {1, 3, 1}, in_chunks({1, 3, 1}, false)); });
  expect_refused_in_little_memory("unexpected shape of /shapes/vertex");
}

TEST_F(HostileRecording, ChunksThatUnpackToMoreThanTheySayAreRefused) {
  // A chunk of a second of body poses says 7000 bytes; this one unpacks to 300 MB.
  std::vector<unsigned char> zeros(300'000'000), packed(compressBound(300'000'000));
  uLongf size = packed.size();
  ASSERT_EQ(compress2(packed.data(), &size, zeros.data(), zeros.size(), 1), Z_OK);
  edit([&](hid_t file) {
    const Handle dataset(H5Dopen2(file, "/bodies/pose", H5P_DEFAULT), "pose");
    const hsize_t at[3] = {0, 0, 0};
    internal::check(H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 0, at, size, packed.data()), "chunk");
  });
  expect_refused_in_little_memory("a chunk of another size than it says");
  SetUp();  // and one within a chunk that says 8 MB: not larger packed than unpacked
  edit([&](hid_t file) {
    const Handle dataset =
        replace(file, "/bodies/present", H5T_STD_U8LE, {kFrames, kBodies}, in_chunks({3'000'000, 3}, true));
  });
  expect_refused_in_little_memory("");
  SetUp();
  edit([&](hid_t file) {
    const Handle properties = in_chunks({kFrames}, true);
    const Handle dataset = replace(file, "/solver/residual", H5T_IEEE_F64LE, {kFrames}, properties);
    const hsize_t at[1] = {0};
    internal::check(H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 0, at, size, packed.data()), "chunk");
  });
  expect_refused_in_little_memory("a chunk of another size than it says");
  SetUp();
  edit([&](hid_t file) {
    replace(file, "/solver/residual", H5T_IEEE_F64LE, {kFrames}, in_chunks({100'000'000}, true));
  });
  expect_refused_in_little_memory("chunks that are too large");
}

// The library would read beyond the end of what it unpacked, or found.
TEST_F(HostileRecording, ChunksThatUnpackToLessThanTheySayAreRefused) {
  const std::array<double, kFrames / 2> half{};
  std::vector<unsigned char> packed(compressBound(sizeof half));
  uLongf size = packed.size();
  ASSERT_EQ(compress(packed.data(), &size, reinterpret_cast<const Bytef*>(half.data()), sizeof half), Z_OK);
  const auto write = [&](bool is_deflated, std::uint32_t skipped, std::size_t bytes, const void* data) {
    SetUp();
    edit([&](hid_t file) {
      const Handle dataset =
          replace(file, "/solver/residual", H5T_IEEE_F64LE, {kFrames}, in_chunks({kFrames}, is_deflated));
      const hsize_t at[1] = {0};
      internal::check(H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, skipped, at, bytes, data), "chunk");
    });
    expect_refused_in_little_memory("a chunk of another size than it says");
  };
  write(true, 0, size, packed.data());
  write(true, 1, sizeof half, half.data());  // not packed, though others of the dataset are
  write(false, 0, sizeof half, half.data());
}

TEST_F(HostileRecording, WhatLiesInOtherFilesIsNotShown) {
  const std::filesystem::path secret = folder_ / "secret";
  std::ofstream(secret) << std::string(100, 's');
  edit([&](hid_t file) {
    Handle properties(H5Pcreate(H5P_DATASET_CREATE), "properties");
    internal::check(H5Pset_external(properties.get(), secret.c_str(), 0, 100), "external");
    replace(file, "/program", internal::string_type(100).get(), {1}, properties);
  });
  expect_refused_in_little_memory("/program is kept in another file");
  const auto link = [&](const std::function<herr_t(hid_t)>& make) {
    SetUp();
    edit([&](hid_t file) {
      internal::check(H5Ldelete(file, "/program", H5P_DEFAULT), "delete");
      internal::check(make(file), "link");
    });
    expect_refused_in_little_memory("/program is a link to something else");
  };
  const std::filesystem::path other = folder_ / "other.h5";
  std::filesystem::copy_file(path_, other, std::filesystem::copy_options::overwrite_existing);
  link([&](hid_t file) {
    return H5Lcreate_external(other.c_str(), "/scenario", file, "/program", H5P_DEFAULT, H5P_DEFAULT);
  });
  link([&](hid_t file) { return H5Lcreate_soft("/scenario", file, "/program", H5P_DEFAULT, H5P_DEFAULT); });
  SetUp();  // a group on the way
  edit([&](hid_t file) {
    internal::check(H5Lmove(file, "/tool", file, "/away", H5P_DEFAULT, H5P_DEFAULT), "move");
    internal::check(H5Lcreate_soft("/away", file, "/tool", H5P_DEFAULT, H5P_DEFAULT), "link");
  });
  expect_refused_in_little_memory("/tool is a link to something else");
}

/// The file with a byte after a text in it changed.
void change_byte(const std::filesystem::path& path, const std::string& bytes, std::size_t at, char value) {
  std::string changed = bytes;
  changed[at] = value;
  std::ofstream(path, std::ios::binary) << changed;
}

// HDF5 1.10 copies as many bytes as an attribute says it has.
TEST_F(HostileRecording, AttributesThatSayTheyAreLargerAreRefused) {
  const std::string bytes = read_file(path_, "a recording");
  // Behind the name: the size of the type (a text), or the number of values (of numbers).
  for (const auto& [name, behind] : {std::pair("format", 8 + 4), std::pair("snug_version", 16 + 4)}) {
    const std::size_t at = bytes.find(std::string(name) + '\0');
    ASSERT_NE(at, std::string::npos) << name;
    for (const std::size_t byte : {2U, 3U}) {
      change_byte(path_, bytes, at + static_cast<std::size_t>(behind) + byte, '\x7f');
      expect_refused_in_little_memory("an attribute or a layout that is larger than what holds it");
    }
  }
}

TEST_F(HostileRecording, ReadersSurviveEveryChangedByteOfTheHeaderOfTheFile) {
  Rng rng = Rng(5).split("hostile header");
  save_recording(path_, test::random_recording(rng, 1, 2, 1));
  const std::string bytes = read_file(path_, "a recording");
  const std::size_t first = bytes.find("format") - 100, last = bytes.find("record_period") + 100;
  ASSERT_LT(first, last);
  for (std::size_t at = first; at < last; ++at) {
    for (const char value : {'\x7f', '\xff'}) {
      change_byte(path_, bytes, at, value);
      (void)read_through(path_);
    }
  }
}

// Frames of cameras.
TEST(HostileGridFile, WhatTheFileCannotHoldOrDoesNotHoldIsRefused) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "frame.h5", secret = folder / "secret";
  std::ofstream(secret) << std::string(100, 's');
  const auto complaint = [&](const Edit& change, int most = 8192) {
    {
      const Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), "create");
      internal::write_attribute(file.get(), "camera", std::string("one"));
      change(file.get());
    }
    std::string said = "read";
    const std::filesystem::path answer = folder / "said.txt";
    const auto peak = peak_memory([&] {
      std::vector<float> values;
      try {
        const GridFile file(path);
        (void)file.read("depth", most, values);
      } catch (const InputError& error) {
        said = error.what();
      }
      std::ofstream(answer) << said;
    });
    EXPECT_TRUE(peak && *peak <= allowed_memory(std::filesystem::file_size(path)))
        << "the reader crashed, or takes more";
    return read_file(answer, "an answer");
  };
  const auto grid = [](hid_t type, const internal::Dims& dims, std::size_t chunk = 0) {
    return [=](hid_t file) {
      const Handle space(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr), "space");
      const Handle properties(H5Pcreate(H5P_DATASET_CREATE), "properties");
      const internal::Dims chunks(dims.size(), chunk);
      if (chunk > 0)
        internal::check(H5Pset_chunk(properties.get(), static_cast<int>(dims.size()), chunks.data()), "chunk");
      const Handle set(H5Dcreate2(file, "depth", type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT), "set");
    };
  };
  EXPECT_EQ(complaint(grid(H5T_IEEE_F32LE, {4, 5})), "read");
  EXPECT_EQ(complaint(grid(H5T_STD_I16BE, {4, 5}, 4)), "read");
  EXPECT_NE(complaint(grid(H5T_IEEE_F32LE, {4, 5}), 4).find("depth: got no picture of at most 4 x 4"),
            std::string::npos);
  EXPECT_NE(complaint(grid(H5T_IEEE_F32LE, {8192, 8192})).find("more values than"), std::string::npos);
  EXPECT_NE(complaint(grid(H5T_IEEE_F32LE, {8192, 8192}, 8000)).find("chunks that are too large"), std::string::npos);
  EXPECT_NE(complaint(grid(H5T_IEEE_F32LE, {4, 5, 6})).find("no picture"), std::string::npos);
  EXPECT_NE(complaint(grid(internal::string_type(3).get(), {4, 5})).find("no picture"), std::string::npos);
  EXPECT_NE(complaint([](hid_t) {}).find("depth"), std::string::npos);
  EXPECT_NE(complaint([&](hid_t file) {
              const Handle properties(H5Pcreate(H5P_DATASET_CREATE), "properties");
              internal::check(H5Pset_external(properties.get(), secret.c_str(), 0, 100), "external");
              const hsize_t sides[2] = {5, 5};
              const Handle space(H5Screate_simple(2, sides, nullptr), "space");
              const Handle set(
                  H5Dcreate2(file, "depth", H5T_IEEE_F32LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                  "set");
            }).find("kept in another file"),
            std::string::npos);
  const GridFile file(path);
  EXPECT_EQ(file.read_text("camera"), "one");
  EXPECT_THROW((void)file.read_text("none"), InputError);
  EXPECT_THROW(GridFile(folder / "none.h5"), InputError);
  EXPECT_THROW(GridFile{secret}, InputError);
}

TEST_F(HostileRecording, AttributesOfManyTextsDoNotOverflow) {
  edit([](hid_t file) {
    internal::check(H5Adelete(file, "sequence"), "delete");
    const hsize_t count = 900;
    const Handle space(H5Screate_simple(1, &count, nullptr), "space");
    const Handle type = internal::string_type(64);
    const Handle attribute(H5Acreate2(file, "sequence", type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), "sequence");
    const std::string texts(64 * 900, 'x');
    internal::check(H5Awrite(attribute.get(), type.get(), texts.data()), "write");
  });
  expect_refused_in_little_memory("attribute sequence is not a single text");
}

TEST_F(HostileRecording, TextsThatAreNotUtf8AreRefused) {
  const auto write_text = [&](const char* path) {
    const internal::Dims one = {1};
    const Handle type = internal::string_type(4);
    edit([&](hid_t file) {
      const Handle dataset = replace(file, path, type.get(), one, plain());
      internal::check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                               "a\xff"
                               "b"),
                      "write");
    });
  };
  for (const char* path : {"/scenario", "/program", "/settings", "/container/name"}) {
    SetUp();
    write_text(path);
    expect_refused_in_little_memory(std::string(path) + " holds text that is not UTF-8");
  }
}

/// Overwrites all of a dataset of numbers.
template <class T>
void fill(hid_t file, const char* path, T value) {
  const Handle dataset(H5Dopen2(file, path, H5P_DEFAULT), path);
  hsize_t count = 1;
  for (const hsize_t extent : internal::dims_of(dataset.get())) count *= extent;
  const std::vector<T> values(count, value);
  internal::check(H5Dwrite(dataset.get(), internal::file_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
                  path);
}

TEST_F(HostileRecording, RowsThatAreReferredToAgainAndAgainAreRefused) {
  Rng rng = Rng(6).split("references");
  Recording recording = test::random_recording(rng, kBodies, kFrames, 200);
  save_recording(path_, recording);
  edit([](hid_t file) {  // each event has all numbers
    fill<std::int64_t>(file, "/events/number_first", 0);
    const Handle numbers(H5Dopen2(file, "/events/number_value", H5P_DEFAULT), "numbers");
    fill<std::int32_t>(file, "/events/number_count", static_cast<std::int32_t>(internal::dims_of(numbers.get())[0]));
  });
  expect_refused_in_little_memory("/events refers to numbers that do not exist");
  save_recording(path_, recording);
  edit([](hid_t file) {  // each frame has all blocks, and each block all points
    const Handle points(H5Dopen2(file, "/contacts/gap", H5P_DEFAULT), "points");
    const Handle blocks(H5Dopen2(file, "/contacts/frame_block", H5P_DEFAULT), "blocks");
    fill<std::int64_t>(file, "/contacts/block_first", 0);
    fill<std::int32_t>(file, "/contacts/block_count", static_cast<std::int32_t>(internal::dims_of(points.get())[0]));
    fill<std::int64_t>(file, "/contacts/frame_first", 0);
    fill<std::int32_t>(file, "/contacts/frame_count", static_cast<std::int32_t>(internal::dims_of(blocks.get())[0]));
  });
  expect_refused_in_little_memory("a frame has more contacts than /contacts has points");
}

}  // namespace
}  // namespace snug::record
