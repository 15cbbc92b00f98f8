// A recording while it is being written: what is at its path is always whole, for readers and when the run is killed.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <thread>

#include "snug/core/file_lock.hpp"
#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"
#include "snug/record/test/random_recording.hpp"
#include "snug/record/writer.hpp"

namespace snug::record {
namespace {

using test::ScratchFolder;
using Names = std::set<std::string>;

/// Frame `index` of a run that repeats `recording`.
Frame frame_of(const Recording& recording, std::size_t index) {
  Frame frame = recording.frames[index % recording.frames.size()];
  frame.time = static_cast<double>(index) * recording.header.record_period;
  return frame;
}

/// A process that writes a recording until it is killed.
class WritingProcess {
 public:
  WritingProcess(const std::filesystem::path& path, const Recording& recording) : child_(::fork()) {
    if (child_ != 0) return;
    RecordingWriter writer(path, recording.header);
    for (std::size_t i = 0;; ++i) {
      writer.append(frame_of(recording, i));
      if (i % 40 == 0) writer.append(recording.events[(i / 40) % recording.events.size()]);
      if (i % 77 == 0) writer.flush();  // also in the middle of a chunk, which is then written again
    }
  }
  ~WritingProcess() { end(SIGKILL); }
  WritingProcess(const WritingProcess&) = delete;
  WritingProcess& operator=(const WritingProcess&) = delete;

  void end(int signal) {
    if (child_ <= 0) return;
    ::kill(child_, signal);
    ::waitpid(std::exchange(child_, 0), nullptr, 0);
  }
  /// Whether there is a file of this many bytes, within 10 s.
  [[nodiscard]] bool wait_for(const std::filesystem::path& path, std::uintmax_t size = 0) const {
    std::error_code none;
    const auto is_there = [&] {
      return std::filesystem::exists(path) && std::filesystem::file_size(path, none) >= size;
    };
    for (int i = 0; i < 10'000 && !is_there(); ++i) ::usleep(1000);
    return is_there();
  }

 private:
  pid_t child_;
};

class LiveRecording : public testing::Test {
 protected:
  ScratchFolder folder;
  Rng rng = Rng(51).split("live");
  Recording recording = test::random_recording(rng, 6, 500, 20);
  Recording earlier = test::random_recording(rng, 2, 30, 2);
};

TEST_F(LiveRecording, IsReadWholeAtAnyMomentWhileItIsWritten) {
  constexpr std::uintmax_t kLarge = std::uintmax_t{1} << 24U;  // bytes, after less than a second
  int reads = 0;
  for (int run = 0; run < 4 || (reads <= 20 && run < 100); ++run) {  // slow machines read less often in a run
    const std::filesystem::path path = folder / ("run" + std::to_string(run) + ".h5");
    const WritingProcess writer(path, recording);
    ASSERT_TRUE(writer.wait_for(path));
    for (std::size_t most = 0; std::filesystem::file_size(path) < kLarge; ++reads) {
      SCOPED_TRACE(reads);
      RecordingReader reader(path);
      EXPECT_FALSE(reader.is_complete());
      const std::size_t count = reader.frame_count();
      EXPECT_GE(count, std::max(most, std::size_t{1})) << "frames do not go away";
      most = count;
      ASSERT_GE(reader.events().size() * 40, count - 1);
      Frame frame;
      for (std::size_t i = 0; i < count; i += 1 + count / 20) {
        reader.read_frame(i, frame);
        ASSERT_TRUE(frame == frame_of(recording, i)) << i << " of " << count;
      }
    }
  }
  EXPECT_GT(reads, 20);
}

TEST_F(LiveRecording, AppearsWithItsFirstFrames) {
  RecordingWriter writer(folder / "run.h5", recording.header);
  EXPECT_FALSE(std::filesystem::exists(folder / "run.h5"));
  writer.append(recording.frames[0]);
  writer.flush();
  EXPECT_EQ(folder.names(), Names{"run.h5"});
  EXPECT_EQ(load_recording(folder / "run.h5").frames.size(), 1U);
  writer.close();
  EXPECT_TRUE(load_recording(folder / "run.h5").is_complete);
}

TEST_F(LiveRecording, DoesNotTouchAnEarlierOneBeforeItsEnd) {
  save_recording(folder / "run.h5", earlier);
  {
    RecordingWriter writer(folder / "run.h5", recording.header);
    for (const Frame& frame : recording.frames) writer.append(frame);
    writer.flush();
    EXPECT_TRUE(load_recording(folder / "run.h5") == earlier);
    EXPECT_EQ(load_recording(folder / "run.h5.snug-part").frames.size(), recording.frames.size());
  }
  EXPECT_TRUE(load_recording(folder / "run.h5") == earlier) << "a run that did not get to its end";
  EXPECT_EQ(folder.names(), Names{"run.h5"});
  save_recording(folder / "run.h5", recording);
  EXPECT_TRUE(load_recording(folder / "run.h5").frames == recording.frames);
}

TEST_F(LiveRecording, LosesNothingWhenItIsKilled) {
  save_recording(folder / "run.h5", earlier);
  WritingProcess writer(folder / "run.h5", recording);
  ASSERT_TRUE(writer.wait_for(folder / "run.h5.snug-part", std::uintmax_t{1} << 20U)) << "hundreds of frames";
  writer.end(SIGKILL);
  EXPECT_TRUE(load_recording(folder / "run.h5") == earlier);
  EXPECT_FALSE(load_recording(folder / "run.h5.snug-part").is_complete);
  save_recording(folder / "run.h5", recording);
  EXPECT_EQ(folder.names(), Names{"run.h5"});
}

/// What a process with a small limit on the size of files says when it saves `recording`.
std::string complaint_of_full_disk(const std::filesystem::path& path, const Recording& recording) {
  int ends[2];
  if (::pipe(ends) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{100'000, 100'000};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      save_recording(path, recording);
    } catch (const OutputError& error) {
      (void)!::write(ends[1], error.what(), std::strlen(error.what()));
    }
    ::_exit(0);
  }
  ::close(ends[1]);
  ::waitpid(child, nullptr, 0);
  std::string text(1000, '\0');
  text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, ::read(ends[0], text.data(), text.size()))));
  ::close(ends[0]);
  return text;
}

TEST_F(LiveRecording, SaysSoWhenTheDiskIsFullAndKeepsAnEarlierOne) {
  for (const bool has_earlier : {false, true}) {
    if (has_earlier) save_recording(folder / "run.h5", earlier);
    const std::string complaint = complaint_of_full_disk(folder / "run.h5", recording);
    EXPECT_NE(complaint.find("run.h5: could not be written"), std::string::npos) << complaint;
    EXPECT_NE(complaint.find("File too large"), std::string::npos) << complaint;
    EXPECT_EQ(folder.names(), has_earlier ? Names{"run.h5"} : Names{});
  }
  EXPECT_TRUE(load_recording(folder / "run.h5") == earlier);
}

TEST_F(LiveRecording, LeavesNothingOfARunWithoutFrames) {
  { const RecordingWriter writer(folder / "run.h5", recording.header); }
  EXPECT_EQ(folder.names(), Names{});
}

TEST_F(LiveRecording, HasOneWriter) {
  RecordingWriter first(folder / "run.h5", recording.header);
  for (int i = 0; i < 2; ++i) {
    try {
      save_recording(folder / "run.h5", recording);
      ADD_FAILURE() << "not refused";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("another run"), std::string::npos) << error.what();
    }
    first.append(frame_of(recording, static_cast<std::size_t>(i)));
    first.flush();  // the second time it is at its path
  }
  first.close();
  EXPECT_EQ(load_recording(folder / "run.h5").frames.size(), 2U);
}

TEST_F(LiveRecording, IsNotHeldUpByAReaderThatHangs) {
  RecordingWriter writer(folder / "run.h5", recording.header);
  writer.append(recording.frames[0]);
  writer.flush();
  const int hanging = ::open((folder / "run.h5").c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_TRUE(try_lock(hanging, LockByte::Commit, LockKind::Shared));
  const auto start = std::chrono::steady_clock::now();
  writer.append(recording.frames[1]);
  writer.flush();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(20));
  ::close(hanging);
  writer.close();
  EXPECT_EQ(load_recording(folder / "run.h5").frames.size(), 2U);
}

TEST_F(LiveRecording, SaysThatItWasInterrupted) {
  RecordingWriter writer(folder / "run.h5", recording.header);
  writer.append(recording.frames[0]);
  writer.close("{}", RunEnd::Interrupted);
  const RecordingReader reader(folder / "run.h5");
  EXPECT_FALSE(reader.is_complete());
  EXPECT_TRUE(reader.is_interrupted());
  EXPECT_EQ(reader.result(), "{}");
}

}  // namespace
}  // namespace snug::record
