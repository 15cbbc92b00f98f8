// FrameSource: commands and folders keep to their contract, and what does not is said and leaves nothing behind.
#include "snug/frames/frame_source.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "snug/camera/render.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"

namespace snug::frames {
namespace {

namespace fs = std::filesystem;

const std::string& frame_bytes() {
  static const std::string bytes = [] {
    model::CameraParams camera = model::make_camera("ideal");
    camera.width = 32;
    camera.height = 24;
    camera.intrinsics = {30.0, 30.0, 15.5, 11.5};
    camera::Scene scene;
    camera::add_box(scene, "wall", Pose{Matrix3::Identity(), Vector3(0, 0, 1.0)}, Vector3(5, 5, 0.1));
    return camera::format_png(camera::render(scene, camera, {}, 1).frame);
  }();
  return bytes;
}

class FrameSource : public ::testing::Test {
 protected:
  FrameSource() { write("taken.png", frame_bytes()); }

  fs::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  [[nodiscard]] std::string read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_ / name).rdbuf();
    return text.str();
  }
  /// What a source of these words says of its first look.
  Expected<camera::Frame, std::string> look(const std::string& from, double patience = 20.0) {
    settings_.from = from;
    settings_.patience = patience;
    settings_.grace = 0.05;
    return make_frame_source(settings_)(1, 2.5);
  }
  void expect_trouble(const std::string& from, const std::string& part, double patience = 20.0) {
    const auto frame = look(from, patience);
    ASSERT_FALSE(frame) << from;
    EXPECT_NE(frame.error().find(part), std::string::npos) << frame.error();
  }
  std::string shell(const std::string& script) { return "/bin/sh '" + write("script", script).string() + "'"; }
  std::string taken() { return (folder_ / "taken.png").string(); }

  snug::test::ScratchFolder folder_;
  SourceSettings settings_;
};

TEST_F(FrameSource, RunsTheCommandAtEachLook) {
  settings_.from = "cp " + taken() + " {frame}.png";
  const camera::FrameSource source = make_frame_source(settings_);
  for (std::uint64_t i = 1; i <= 3; ++i) {
    const auto frame = source(i, 0.0);
    ASSERT_TRUE(frame) << frame.error();
    EXPECT_NEAR(frame->depth(12, 16), 0.95, 1e-4);
  }
}

TEST_F(FrameSource, TellsTheCommandWhichLookItIs) {
  const std::string out = (folder_ / "said").string();
  ASSERT_TRUE(look(shell("echo \"$1 $SNUG_LOOK $SNUG_TIME\" > " + out + "; cp " + taken() +
                         " \"$SNUG_FRAME.png\"; read nothing && exit 5; exit 0\n") +
                   " {look}"));
  EXPECT_EQ(read("said"), "1 1 2.500000\n");
}

TEST_F(FrameSource, LeavesNothingBehind) {
  const std::string out = (folder_ / "said").string();
  ASSERT_TRUE(look(shell("cp " + taken() + " $SNUG_FRAME.png; dirname $SNUG_FRAME > " + out + "\n")));
  std::string place = read("said");
  place.pop_back();
  EXPECT_FALSE(fs::exists(place)) << place;
}

TEST_F(FrameSource, SaysHowACommandFailedWithoutItsEscapes) {
  expect_trouble(shell("printf 'warming up\\n\\033[31mno light\\033[0m\\n' >&2; exit 3\n"),
                 "exit code 3: warming up\\n\\x1b[31mno light\\x1b[0m");
  expect_trouble(shell("kill -9 $$\n"), "by signal 9");
  expect_trouble("true", "wrote no frame");
  expect_trouble(shell("cp " + taken() + " $SNUG_FRAME.png; cp " + taken() + " $SNUG_FRAME.ply\n"), "two frames");
  expect_trouble(shell("echo hello > $SNUG_FRAME.png\n"), "begins like none");
  expect_trouble(shell("mkfifo $SNUG_FRAME.png\n"), "frame.png");
}

TEST_F(FrameSource, EndsACommandThatTakesTooLongWithAllThatItStarted) {
  const std::string out = (folder_ / "pid").string();
  expect_trouble(shell("trap '' TERM\n/bin/sh -c 'trap \"\" TERM; echo $$ > " + out + "; sleep 60' &\nsleep 60\n"),
                 "did not end within 0.3 s", 0.3);
  const std::string pid = read("pid");
  ASSERT_FALSE(pid.empty());
  const fs::path process = fs::path("/proc") / pid.substr(0, pid.size() - 1) / "stat";
  for (int i = 0; i < 200; ++i) {  // SIGKILL takes a moment
    std::ifstream stat(process);
    std::string number, name, state;
    if (!(stat >> number >> name >> state) || state == "Z") return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  FAIL() << "it goes on: " << pid;
}

TEST_F(FrameSource, HearsOneThatNeverStopsTalkingAndStillLooksAtTheClock) {
  expect_trouble("yes", "did not end within 0.1 s: ", 0.1);
}

TEST_F(FrameSource, EndsWithTheUser) {
  int asked = 0;
  settings_.is_interrupted = [&asked] { return ++asked > 3; };
  expect_trouble("sleep 60", "interrupted");
  asked = 0;
  expect_trouble(folder_.path().string(), "interrupted");
}

TEST_F(FrameSource, RefusesWhatIsNeitherFolderNorProgramBeforeAnythingMoves) {
  for (const char* from : {"no-such-program-anywhere {frame}.png", "/no/such/folder", "a | b", ""}) {
    settings_.from = from;
    EXPECT_THROW((void)make_frame_source(settings_), InputError) << from;
  }
}

/// What a camera's own program does: it waits for a look, and puts its frame there whole.
class FolderCamera {
 public:
  FolderCamera(const fs::path& folder, std::string name, std::string bytes) {
    thread_ = std::thread([this, folder, name, bytes] {
      while (!is_stopped_ && !fs::exists(folder / "look.json"))
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      std::ofstream(folder / ".part", std::ios::binary) << bytes;
      std::ofstream(folder / "taken-labels.png", std::ios::binary) << bytes;
      fs::rename(folder / ".part", folder / name);
    });
  }
  ~FolderCamera() {
    is_stopped_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> is_stopped_ = false;
  std::thread thread_;
};

TEST_F(FrameSource, TakesTheFrameThatIsNewInItsFolder) {
  for (const std::string name : {"second.png", "taken.png"}) {  // of another name, or another file of the same
    fs::remove(folder_ / "look.json");
    write("taken.png", "not a frame, and not new");
    const FolderCamera camera(folder_.path(), name, frame_bytes());
    const auto frame = look(folder_.path().string());
    ASSERT_TRUE(frame) << frame.error();
    EXPECT_EQ(read("look.json"), "{\"look\": 1, \"time_s\": 2.500000}\n");
  }
}

TEST_F(FrameSource, WaitsForAFrameOnlySoLong) {
  expect_trouble(folder_.path().string(), "no new frame", 0.05);
  fs::remove(folder_ / "look.json");
  const FolderCamera camera(folder_.path(), "broken.ply", "ply\nformat ascii 1.0\n");
  expect_trouble(folder_.path().string(), "broken.ply");
}

TEST_F(FrameSource, HasItsFolderForItself) {
  settings_.from = folder_.path().string();
  const camera::FrameSource source = make_frame_source(settings_);
  EXPECT_THROW((void)make_frame_source(settings_), InputError);
}

}  // namespace
}  // namespace snug::frames
