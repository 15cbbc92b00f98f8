// Recordings: what is written is read, bit by bit, and files that are not right are refused with a reason.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bit>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <thread>

#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"
#include "snug/record/test/random_recording.hpp"
#include "snug/record/writer.hpp"

namespace snug::record {
namespace {

using test::ScratchFolder;

/// The message of the InputError that `work` throws, or "" if it throws none.
template <class Work>
std::string complaint(Work work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string load_complaint(const std::filesystem::path& path) {
  return complaint([&] { (void)load_recording(path); });
}

/// Runs `work` in a child process (HDF5 itself leaks on some damaged files); false if it crashes.
template <class Work>
bool ends_in_order(Work work) {
  const pid_t child = ::fork();
  if (child == 0) {
    work();
    ::_exit(0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST(Recording, IsReadAsItWasWrittenBitByBit) {
  const ScratchFolder folder;
  Rng rng = Rng(11).split("round trip");
  // Frame counts around the chunk of 125 and the reader's block of 1000.
  for (const int frames : {0, 1, 124, 125, 126, 1000, 1251}) {
    for (const int bodies : {0, 1, 7}) {
      SCOPED_TRACE(std::to_string(frames) + " frames, " + std::to_string(bodies) + " bodies");
      const Recording written = test::random_recording(rng, bodies, frames, frames / 10);
      save_recording(folder / "run.h5", written);
      const Recording read = load_recording(folder / "run.h5");
      EXPECT_EQ(read.header, written.header);
      EXPECT_EQ(read.events, written.events);
      EXPECT_EQ(read.frames.size(), written.frames.size());
      EXPECT_TRUE(read == written);
    }
  }
}

TEST(Recording, KeepsFramesWhenFlushedAtAnyMoment) {
  const ScratchFolder folder;
  Rng rng = Rng(12).split("flush");
  const Recording written = test::random_recording(rng, 5, 400, 20);
  RecordingWriter writer(folder / "run.h5", written.header);
  for (std::size_t i = 0; i < written.frames.size(); ++i) {
    writer.append(written.frames[i]);
    if (i % 20 == 0) writer.append(written.events[i / 20]);
    if (rng.index(30) != 0) continue;
    writer.flush();
    const Recording so_far = load_recording(folder / "run.h5");
    EXPECT_FALSE(so_far.is_complete);
    ASSERT_EQ(so_far.frames.size(), i + 1);
    EXPECT_TRUE(std::equal(so_far.frames.begin(), so_far.frames.end(), written.frames.begin()));
  }
  writer.close();
  EXPECT_TRUE(load_recording(folder / "run.h5") == written);
}

TEST(Recording, RoundsContactsToTheStatedQuanta) {
  const ScratchFolder folder;
  Rng rng = Rng(13).split("quanta");
  Recording written = test::random_recording(rng, 3, 1, 0);
  written.frames[0].contacts.clear();
  for (int i = 0; i < 1000; ++i) {
    ContactSample contact = test::random_contact(rng, 3);
    contact.p_WQ = test::random_vector(rng, 15.0);
    contact.force_B_W = test::random_vector(rng, 2000.0);
    contact.phi = rng.uniform(-0.1, 0.1);
    written.frames[0].contacts.push_back(contact);
  }
  save_recording(folder / "run.h5", written);
  const Recording read = load_recording(folder / "run.h5");
  ASSERT_EQ(read.frames[0].contacts.size(), 1000u);
  for (std::size_t i = 0; i < 1000; ++i) {
    const ContactSample& a = written.frames[0].contacts[i];
    const ContactSample& b = read.frames[0].contacts[i];
    EXPECT_EQ(a.body_a, b.body_a);
    EXPECT_EQ(a.body_b, b.body_b);
    // Half a quantum, by rounding to nearest; all values are below 2^24 quanta.
    EXPECT_LE((a.p_WQ - b.p_WQ).cwiseAbs().maxCoeff(), 0.5 * kPointQuantum);
    EXPECT_LE((a.force_B_W - b.force_B_W).cwiseAbs().maxCoeff(), 0.5 * kForceQuantum);
    EXPECT_LE(std::abs(a.phi - b.phi), 0.5 * kGapQuantum);
  }
}

TEST(Recording, NamesItsAxesAndItsUnitsForReadersOfNetcdf) {
  const ScratchFolder folder;
  Rng rng = Rng(14).split("scales");
  const Recording written = test::random_recording(rng, 3, 40, 2);
  save_recording(folder / "run.h5", written);
  const hid_t file = H5Fopen((folder / "run.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  struct Axis {
    const char* path;
    std::vector<const char*> scales;
  };
  const Axis axes[] = {{"/cup/bend", {"/time"}},
                       {"/events/kind", {"/events/time"}},
                       {"/tool/twist", {"/time", "/twist_part"}},
                       {"/flange/wrench", {"/time", "/wrench_part"}},
                       {"/bodies/pose", {"/time", "/bodies/name", "/pose_part"}},
                       {"/bodies/com", {"/bodies/name", "/xyz"}}};
  for (const auto& [path, scales] : axes) {
    const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
    for (unsigned axis = 0; axis < scales.size(); ++axis) {
      const hid_t scale = H5Dopen2(file, scales[axis], H5P_DEFAULT);
      EXPECT_GT(H5DSis_scale(scale), 0) << scales[axis];
      EXPECT_GT(H5DSis_attached(dataset, scale, axis), 0) << path << " " << axis;
      char name[32] = "";
      EXPECT_GT(H5DSget_scale_name(scale, name, sizeof name), 0);
      EXPECT_EQ(name, std::filesystem::path(scales[axis]).filename().string());
      H5Dclose(scale);
    }
    H5Dclose(dataset);
  }
  const auto has_units = [&](const char* path) { return H5Aexists_by_name(file, path, "units", H5P_DEFAULT) > 0; };
  EXPECT_TRUE(has_units("/time") && has_units("/bodies/mass") && has_units("/tool/pose"));
  EXPECT_FALSE(has_units("/bodies/kind") || has_units("/contacts/frame_first") || has_units("/step"));
  H5Fclose(file);
}

TEST(Recording, HasTheSameBytesWhateverMemoryAndClocksHold) {
  const ScratchFolder folder;
  Rng rng = Rng(15).split("bytes");
  const Recording written = test::random_recording(rng, 3, 300, 20);
  const auto bytes_of = [&](int perturb) {
    const std::filesystem::path path = folder / ("run" + std::to_string(perturb) + ".h5");
    EXPECT_TRUE(ends_in_order([&] {
      ::mallopt(M_PERTURB, perturb);
      save_recording(path, written);
    }));
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  const std::string bytes = bytes_of(1);
  EXPECT_GT(bytes.size(), 100'000U);
  // Of the next second: datasets tell no time.
  std::this_thread::sleep_until(std::chrono::ceil<std::chrono::seconds>(std::chrono::system_clock::now()));
  EXPECT_TRUE(bytes_of(0x5a) == bytes);
}

TEST(Recording, KeepsTheResultOfARunThatClosedAndHasNoneOtherwise) {
  const ScratchFolder folder;
  Rng rng = Rng(21).split("result");
  Recording written = test::random_recording(rng, 2, 3, 1);
  save_recording(folder / "without.h5", written);
  EXPECT_EQ(RecordingReader(folder / "without.h5").result(), "");
  written.result = R"({"boxes": [], "failure": "Käse"})";
  save_recording(folder / "with.h5", written);
  EXPECT_EQ(RecordingReader(folder / "with.h5").result(), written.result);
  EXPECT_EQ(load_recording(folder / "with.h5"), written);
}

TEST(Recording, KeepsNaNAndHugeValuesWhereTheyStood) {
  const ScratchFolder folder;
  Rng rng = Rng(14).split("attack");
  Recording written = test::random_recording(rng, 2, 3, 0);
  const double nan = std::bit_cast<double>(0x7ff8dead0000beefULL);
  const double huge = std::numeric_limits<double>::max();
  const double infinity = std::numeric_limits<double>::infinity();
  Frame& frame = written.frames[1];
  frame.bodies[0].X_WB.p = {nan, -infinity, huge};
  frame.cup.F_PSo_S.force = {std::numeric_limits<double>::denorm_min(), -0.0, nan};
  frame.contacts.assign(1, ContactSample{0, 1, {nan, 1e300, -1e30}, {0, 0, 1}, {-infinity, 1e6, 0.0}, nan});
  save_recording(folder / "run.h5", written);
  const Recording read = load_recording(folder / "run.h5");
  ASSERT_EQ(read.frames.size(), 3u);
  const auto bits = [](double value) { return std::bit_cast<std::uint64_t>(value); };
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(bits(read.frames[1].bodies[0].X_WB.p[i]), bits(frame.bodies[0].X_WB.p[i]));
    EXPECT_EQ(bits(read.frames[1].cup.F_PSo_S.force[i]), bits(frame.cup.F_PSo_S.force[i]));
  }
  const ContactSample& contact = read.frames[1].contacts.at(0);
  EXPECT_TRUE(std::isnan(contact.p_WQ.x()) && std::isnan(contact.phi));
  EXPECT_EQ(contact.p_WQ.y(), infinity);  // beyond single precision
  EXPECT_FLOAT_EQ(static_cast<float>(contact.p_WQ.z()), -1e30f);
  EXPECT_EQ(contact.force_B_W.x(), -infinity);
  EXPECT_EQ(contact.force_B_W.y(), 1e6);  // beyond 2^24 quanta, but exact in single precision
  EXPECT_TRUE(read.frames[2] == written.frames[2]);
}

TEST(Recording, StoresAbsentBodiesAsNaN) {
  const ScratchFolder folder;
  Rng rng = Rng(15).split("absent");
  Recording written = test::random_recording(rng, 2, 200, 0);
  for (std::size_t i = 0; i < 150; ++i) written.frames[i].bodies[1].present = false;
  save_recording(folder / "run.h5", written);
  const Recording read = load_recording(folder / "run.h5");
  for (std::size_t i = 0; i < 200; ++i) {
    EXPECT_EQ(read.frames[i].bodies[1].present, i >= 150);
    EXPECT_EQ(read.frames[i].bodies[1].X_WB.p.hasNaN(), i < 150);
    EXPECT_EQ(read.frames[i].bodies[1].V_WB.angular.hasNaN(), i < 150);
    EXPECT_EQ(read.frames[i].bodies[0], written.frames[i].bodies[0]);
  }
}

TEST(Recording, StoresRestingContactsOnce) {
  const ScratchFolder folder;
  Rng rng = Rng(16).split("resting");
  Recording resting = test::random_recording(rng, 4, 1, 0);
  for (int i = 0; i < 40; ++i) resting.frames[0].contacts.push_back(test::random_contact(rng, 4));
  resting.frames.resize(1000, resting.frames[0]);
  for (std::size_t i = 0; i < 1000; ++i) {
    resting.frames[i].time = 0.008 * static_cast<double>(i);
    for (ContactSample& contact : resting.frames[i].contacts) contact.force_B_W.z() += 1e-9 * rng.uniform(-1.0, 1.0);
  }
  save_recording(folder / "run.h5", resting);
  const Recording read = load_recording(folder / "run.h5");
  for (const Frame& frame : read.frames) EXPECT_TRUE(frame.contacts == read.frames[0].contacts);
  // 1000 frames of 40 contacts would take 1.6 MB; time and step change and need 16 kB, the rest is empty chunks.
  EXPECT_LT(std::filesystem::file_size(folder / "run.h5"), 600'000u);
}

/// Of a run that goes on: what was appended and written is read, whole lines of it; of one that ended all.
TEST(Recording, AProgramThatGrowsIsReadAsFarAsItWasSent) {
  const ScratchFolder folder;
  Rng rng = Rng(13).split("program");
  Recording recording = test::random_recording(rng, 3, 40, 0);
  recording.header.program_text.clear();
  RecordingWriter writer(OutputFile(folder / "run.h5"), recording.header, ProgramText::Grows);
  writer.append_program("# tempo: 1\n");
  std::string sent = "# tempo: 1\n";
  for (const Frame& frame : recording.frames) {
    const std::string line(static_cast<std::size_t>(frame.step % 97 + 1), 'w');
    writer.append_program(line + "\nhalf a li");
    writer.append(frame);
    sent += line + "\n";
    writer.flush();
    EXPECT_EQ(load_recording(folder / "run.h5").header.program_text, sent);
    writer.append_program("ne\n");
    sent += "half a line\n";
  }
  writer.close();
  EXPECT_EQ(load_recording(folder / "run.h5").header.program_text, sent);
}

TEST(Recording, EventsAreReadInTheOrderOfTimeHoweverTheyWereWritten) {
  const ScratchFolder folder;
  Rng rng = Rng(14).split("events");
  Recording recording = test::random_recording(rng, 4, 10, 0);
  recording.events = {
      {3.0, "c", "", "", {}}, {1.0, "a", "", "", {{"n", 1.0}}}, {3.0, "d", "", "", {}}, {2.0, "b", "", "", {}}};
  save_recording(folder / "run.h5", recording);
  std::string kinds;
  for (const Event& event : load_recording(folder / "run.h5").events) kinds += event.kind;
  EXPECT_EQ(kinds, "abcd");
}

TEST(Recording, CutsLongTextsOfEventsBetweenCharacters) {
  const ScratchFolder folder;
  Rng rng(26);
  Recording written = test::random_recording(rng, 1, 1, 0);
  const std::string text = std::string(1023, 'x') + "\xC2\xB5m";
  written.events.push_back({0.0, std::string(70, 'k'), std::string(64, 'b'), text, {}});
  save_recording(folder / "run.h5", written);
  const Event event = load_recording(folder / "run.h5").events.at(0);
  EXPECT_EQ(event.kind, std::string(64, 'k'));
  EXPECT_EQ(event.body, std::string(64, 'b'));
  EXPECT_EQ(event.text, std::string(1023, 'x'));
}

TEST(RecordingReader, FetchesAnyFrameAndFindsItByTime) {
  const ScratchFolder folder;
  Rng rng = Rng(17).split("random access");
  const Recording written = test::random_recording(rng, 6, 2300, 3);
  save_recording(folder / "run.h5", written);
  RecordingReader reader(folder / "run.h5");
  ASSERT_EQ(reader.frame_count(), 2300u);
  EXPECT_TRUE(reader.is_complete());
  Frame frame;
  for (int i = 0; i < 60; ++i) {
    const auto index = static_cast<std::size_t>(rng.index(2300));
    reader.read_frame(index, frame);
    EXPECT_TRUE(frame == written.frames[index]) << index;
    EXPECT_EQ(reader.find_frame(frame.time), index);
    EXPECT_EQ(reader.find_frame(frame.time + 0.004), index);
  }
  EXPECT_EQ(reader.find_frame(-5.0), 0u);
  EXPECT_EQ(reader.find_frame(1e9), 2299u);
}

TEST(RecordingReader, SaysWhatIsWrongWithAFile) {
  const ScratchFolder folder;
  EXPECT_TRUE(has(load_complaint(folder / "none.h5"), "no such file"));
  EXPECT_TRUE(has(load_complaint(folder / ""), "not a file"));
  std::ofstream(folder / "text.h5") << "t;x\n0;1\n";
  EXPECT_TRUE(has(load_complaint(folder / "text.h5"), "not HDF5"));
  std::ofstream(folder / "empty.h5").close();
  EXPECT_TRUE(has(load_complaint(folder / "empty.h5"), "not HDF5"));
  H5Fclose(H5Fcreate((folder / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_TRUE(has(load_complaint(folder / "other.h5"), "HDF5 file of another kind"));
}

TEST(RecordingReader, RefusesARecordingOfANewerVersion) {
  const ScratchFolder folder;
  Rng rng(18);
  save_recording(folder / "run.h5", test::random_recording(rng, 1, 3, 0));
  const hid_t file = H5Fopen((folder / "run.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t attribute = H5Aopen(file, "format_version", H5P_DEFAULT);
  const int newer = kFormatVersion + 1;
  H5Awrite(attribute, H5T_NATIVE_INT, &newer);
  H5Aclose(attribute);
  H5Fclose(file);
  EXPECT_TRUE(has(load_complaint(folder / "run.h5"), "newer snug"));
}

TEST(RecordingReader, NeverReturnsATruncatedRecordingAsWhole) {
  const ScratchFolder folder;
  Rng rng = Rng(19).split("truncated");
  const Recording written = test::random_recording(rng, 3, 300, 5);
  save_recording(folder / "run.h5", written);
  const auto size = std::filesystem::file_size(folder / "run.h5");
  for (int i = 0; i < 40; ++i) {
    const auto cut = static_cast<std::uintmax_t>(static_cast<double>(size) * rng.uniform());
    std::filesystem::copy_file(folder / "run.h5", folder / "cut.h5", std::filesystem::copy_options::overwrite_existing);
    std::filesystem::resize_file(folder / "cut.h5", cut);
    EXPECT_NE(load_complaint(folder / "cut.h5"), "") << cut << " of " << size;
  }
}

TEST(RecordingReader, SurvivesFilesWithDamagedBytes) {
  const ScratchFolder folder;
  Rng rng = Rng(20).split("damaged");
  save_recording(folder / "run.h5", test::random_recording(rng, 3, 200, 5));
  const auto size = static_cast<int>(std::filesystem::file_size(folder / "run.h5"));
  const char* rounds_text = std::getenv("SNUG_DAMAGE_ROUNDS");
  const int rounds = rounds_text == nullptr ? 100 : std::atoi(rounds_text);
  for (int i = 0; i < rounds; ++i) {
    std::filesystem::copy_file(folder / "run.h5", folder / "bad.h5", std::filesystem::copy_options::overwrite_existing);
    std::fstream file(folder / "bad.h5", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(rng.index(size));
    for (int k = 0; k < 16; ++k) file.put(static_cast<char>(rng.next()));
    file.close();
    EXPECT_TRUE(ends_in_order([&] { (void)load_complaint(folder / "bad.h5"); })) << "data may change unseen";
  }
}

TEST(RecordingWriter, ReplacesAnEarlierRecordingButNoOtherFile) {
  const ScratchFolder folder;
  Rng rng(21);
  const Recording first = test::random_recording(rng, 2, 300, 2);
  const Recording second = test::random_recording(rng, 3, 10, 1);
  save_recording(folder / "run.h5", first);
  save_recording(folder / "run.h5", second);
  EXPECT_TRUE(load_recording(folder / "run.h5") == second);
  std::ofstream(folder / "thesis.txt") << "months of work";
  EXPECT_TRUE(has(complaint([&] { save_recording(folder / "thesis.txt", first); }), "not overwritten"));
  EXPECT_EQ(std::filesystem::file_size(folder / "thesis.txt"), 14u);
  H5Fclose(H5Fcreate((folder / "other.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_TRUE(has(complaint([&] { save_recording(folder / "other.h5", first); }), "not overwritten"));
  EXPECT_TRUE(has(complaint([&] { save_recording(folder / "no/such/run.h5", first); }), "No such file"));
  EXPECT_TRUE(has(complaint([&] { save_recording(folder / "", first); }), "not a regular file"));
}

TEST(RecordingWriter, RefusesAHeaderThatCannotBeRead) {
  const ScratchFolder folder;
  Rng rng(22);
  const RecordingHeader good = test::random_header(rng, 2);
  const auto complain = [&](const RecordingHeader& header) {
    return complaint([&] { RecordingWriter(folder / "run.h5", header); });
  };
  RecordingHeader header = good;
  header.record_period = std::nan("");
  EXPECT_TRUE(has(complain(header), "record_period"));
  header = good;
  header.bodies[1].name = header.bodies[0].name;
  EXPECT_TRUE(has(complain(header), "twice"));
  header = good;
  header.bodies[1].name.clear();
  EXPECT_TRUE(has(complain(header), "without a name"));
  EXPECT_EQ(complain(good), "");
}

TEST(RecordingWriter, MarksARunThatEndedInAnErrorAsIncomplete) {
  const ScratchFolder folder;
  Rng rng(23);
  const Recording written = test::random_recording(rng, 2, 130, 1);
  {
    RecordingWriter writer(folder / "run.h5", written.header);
    for (const Frame& frame : written.frames) writer.append(frame);
    for (const Event& event : written.events) writer.append(event);
  }
  const Recording read = load_recording(folder / "run.h5");
  EXPECT_FALSE(read.is_complete);
  EXPECT_TRUE(read.frames == written.frames);
  EXPECT_EQ(read.events, written.events);
}

TEST(RecordingWriterDeathTest, StopsOnFramesThatBreakTheRules) {
  const ScratchFolder folder;
  Rng rng(24);
  const Recording written = test::random_recording(rng, 2, 2, 0);
  const auto append = [&](const Frame& second) {
    RecordingWriter writer(folder / "run.h5", written.header);
    writer.append(written.frames[0]);
    writer.append(second);
  };
  Frame frame = written.frames[1];
  frame.time = 0.0;
  EXPECT_DEATH(append(frame), "time of a frame");
  frame.time = std::nan("");
  EXPECT_DEATH(append(frame), "time of a frame");
  frame = written.frames[1];
  frame.bodies.pop_back();
  EXPECT_DEATH(append(frame), "bodies of the header");
  frame = written.frames[1];
  frame.contacts.assign(1, ContactSample{});
  EXPECT_DEATH(append(frame), "bodies of a contact");
}

}  // namespace
}  // namespace snug::record
