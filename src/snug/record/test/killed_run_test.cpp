// A run that is killed leaves a file that opens.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>

#include <atomic>
#include <cstdlib>

#include "snug/record/reader.hpp"
#include "snug/record/test/random_recording.hpp"
#include "snug/record/writer.hpp"

namespace snug::record {
namespace {

using test::ScratchFolder;

constexpr int kFramesPerSecond = 125;

/// A number that a child process writes and its parent reads.
class SharedCounter {
 public:
  SharedCounter()
      : value_(new (::mmap(nullptr, sizeof(std::atomic<int>), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1,
                           0)) std::atomic<int>(0)) {}
  ~SharedCounter() { ::munmap(value_, sizeof(std::atomic<int>)); }
  SharedCounter(const SharedCounter&) = delete;
  SharedCounter& operator=(const SharedCounter&) = delete;
  std::atomic<int>& operator*() { return *value_; }

 private:
  std::atomic<int>* value_;
};

/// Writes `recording` again and again behind itself, as fast as it can, until killed.
[[noreturn]] void write_forever(const std::filesystem::path& path, const Recording& recording,
                                std::atomic<int>& appended) {
  RecordingWriter writer(path, recording.header);
  appended = 1;
  for (int i = 0;; ++i) {
    Frame frame = recording.frames[static_cast<std::size_t>(i) % recording.frames.size()];
    frame.time = i * recording.header.record_period;
    writer.append(frame);
    if (i % 40 == 0) {
      Event event = recording.events[static_cast<std::size_t>(i / 40) % recording.events.size()];
      event.time = frame.time;
      writer.append(event);
    }
    appended = i + 2;
  }
}

/// Frames appended when the writing child was killed, `delay_us` after it had appended so many.
int write_and_kill(const std::filesystem::path& path, const Recording& recording, int frames, int delay_us) {
  SharedCounter appended;
  const pid_t child = ::fork();
  if (child == 0) write_forever(path, recording, *appended);
  while (*appended <= frames) ::usleep(100);
  ::usleep(static_cast<useconds_t>(delay_us));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  return *appended - 1;
}

TEST(KilledRun, LeavesAFileWithAllButTheLastSecond) {
  const ScratchFolder folder;
  Rng rng = Rng(31).split("killed");
  const Recording recording = test::random_recording(rng, 8, 1000, 20);
  const char* rounds_text = std::getenv("SNUG_KILL_ROUNDS");
  const int rounds = rounds_text == nullptr ? 25 : std::atoi(rounds_text);
  for (int round = 0; round < rounds; ++round) {
    SCOPED_TRACE(round);
    std::filesystem::remove(folder / "run.h5");
    const int appended = write_and_kill(folder / "run.h5", recording, rng.index(400), rng.index(20000));
    if (!std::filesystem::exists(folder / "run.h5")) {
      EXPECT_LE(appended, kFramesPerSecond) << "it appears with the first second";
      continue;
    }
    const Recording read = load_recording(folder / "run.h5");
    EXPECT_FALSE(read.is_complete);
    const int kept = static_cast<int>(read.frames.size());
    // A chunk is a second. It may be that it was full but not yet written.
    EXPECT_GE(kept, appended - kFramesPerSecond) << appended;
    EXPECT_LE(kept, appended + 1);
    for (int i = 0; i < kept; ++i) {
      Frame expected = recording.frames[static_cast<std::size_t>(i) % recording.frames.size()];
      expected.time = i * recording.header.record_period;
      ASSERT_TRUE(read.frames[static_cast<std::size_t>(i)] == expected) << i << " of " << kept;
    }
    for (std::size_t i = 0; i < read.events.size(); ++i) {
      Event written = recording.events[i % recording.events.size()];
      written.time = static_cast<double>(40 * i) * recording.header.record_period;
      EXPECT_TRUE(read.events[i] == written) << i;
    }
    EXPECT_GE(static_cast<int>(read.events.size()), (kept - 1) / 40);
  }
}

TEST(KilledRun, OpensWithTheToolsOfHdf5) {
  if (std::system("h5ls --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "h5ls is not installed (hdf5-tools)";
  const ScratchFolder folder;
  Rng rng = Rng(32).split("tools");
  const Recording recording = test::random_recording(rng, 4, 500, 20);
  write_and_kill(folder / "run.h5", recording, 2 * kFramesPerSecond, 20000);
  const std::string path = (folder / "run.h5").string();
  EXPECT_EQ(std::system(("h5ls -r " + path + " > /dev/null").c_str()), 0);
  EXPECT_EQ(std::system(("h5dump -H " + path + " > /dev/null").c_str()), 0);
  EXPECT_EQ(std::system(("h5dump -d /bodies/pose -d /events/text " + path + " > /dev/null").c_str()), 0);
}

}  // namespace
}  // namespace snug::record
