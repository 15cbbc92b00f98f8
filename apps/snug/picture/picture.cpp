// picture: puts the recording into the viewer's page and has a browser without a screen draw it.
#include "apps/snug/picture/picture.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/recorded_instant.hpp"
#include "apps/snug/common/robot_files.hpp"
#include "snug/core/descriptor.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/core/write_file.hpp"
#include "snug/replay/browser.hpp"
#include "snug/replay/replay.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {
namespace {

namespace fs = std::filesystem;

constexpr std::array kCameras = {"cell", "top", "side", "tool"};
constexpr std::array kParts = {"names", "contacts", "forces", "wrenches", "ghost",  "frames",
                               "trace", "xray",     "robot",  "walls",    "shadows"};
constexpr std::size_t kMostFrames = 200'000;
constexpr std::chrono::seconds kPatience(60);  // until the page has drawn for the first time

template <std::size_t N>
void expect_one_of(const char* option, const std::string& word, const std::array<const char*, N>& words) {
  if (std::any_of(words.begin(), words.end(), [&](const char* known) { return word == known; })) return;
  throw InputError("command line", option, word, fmt::format("one of {}", fmt::join(words, ", ")));
}

void expect_parts(const char* option, const std::string& list) {
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    expect_one_of(option, list.substr(begin, end - begin), kParts);
    begin = end + 1;
  }
}

/// The page with the recording in it, in a browser, as it is drawn for pictures.
class Studio {
 public:
  Studio(const PictureOptions& options, record::RecordingReader& reader)
      : browser_(replay::find_browser(), folder_.path() / "profile", options.width, options.height) {
    const std::string name = fs::path(options.recording).filename().string();
    const replay::RobotDescription robot = find_robot(reader, options.recording, options.urdf);
    const report::PageRecording recording{name, replay::encode_recording(reader, name, {}, robot)};
    const fs::path page = folder_.path() / "page.html";
    write_file(page, report::assemble_page(viewer_page(), {&recording, 1}));
    browser_.open(fmt::format("file://{}#picture=1&t={}&camera={}&theme={}&show={}&hide={}&size={}x{}", page.string(),
                              options.time.value_or(options.from.value_or(reader.times().back())), options.camera,
                              options.theme, options.show, options.hide, options.width, options.height));
    wait_until_drawn();
  }
  void show(double time) {
    // The next picture of the browser but one has surely been drawn after the change.
    (void)browser_.evaluate(fmt::format(
        "window.snug.setTime({}), new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(0))))",
        time));
  }
  [[nodiscard]] std::string take_picture() { return browser_.take_picture(); }

 private:
  void wait_until_drawn() {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (browser_.evaluate("window.snugReady === true") != "true") {
      if (std::chrono::steady_clock::now() > deadline)
        throw replay::BrowserError("the page did not draw within a minute");
      ::usleep(20'000);
    }
    const std::string trouble = browser_.evaluate("window.snug.error");
    if (trouble != "\"\"") throw replay::BrowserError("in the page: " + trouble);
  }

  TemporaryFolder folder_{"snug-picture"};
  replay::Browser browser_;
};

/// Instants of the frames of a video.
std::vector<double> video_times(const PictureOptions& options, const record::RecordingReader& reader) {
  const std::vector<double>& times = reader.times();
  const double from = std::max(times.front(), options.from.value_or(times.front()));
  const double to = std::min(times.back(), options.to.value_or(times.back()));
  if (from > to) {
    throw InputError("command line", "--from, --to", "nothing between them",
                     fmt::format("times within {:.3f} s to {:.3f} s", times.front(), times.back()));
  }
  const double step = options.speed / options.fps;
  const double count = std::floor((to - from) / step + 1e-9) + 1.0;
  if (count > static_cast<double>(kMostFrames)) {
    throw InputError("command line", "--fps", fmt::format("{:.0f} pictures", count),
                     fmt::format("at most {}: less of the recording, or a higher --speed", kMostFrames));
  }
  std::vector<double> instants;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    instants.push_back(from + static_cast<double>(i) * step);
  }
  return instants;
}

/// Pictures of an earlier video must not get among the new ones.
void expect_empty(const fs::path& path) {
  std::error_code error;
  if (!fs::is_empty(path, error) || error) {
    throw InputError(path.string(), "--video", error ? error.message() : "a folder with something in it",
                     "a new or empty folder");
  }
}

volatile std::sig_atomic_t g_is_interrupted = 0;

/// Lets temporary files and the browser go in order.
void heed_interruption() {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, [](int) { g_is_interrupted = 1; });
}

/// Keeps a second video out of the same folder as long as the result lives.
Descriptor lock_folder(const std::string& path) {
  Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.is_open() && ::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw InputError(path, "--video", "a folder that another run is writing to", "one that nobody else writes to");
  return folder;
}

void draw_video(const PictureOptions& options, record::RecordingReader& reader) {
  const std::vector<double> instants = video_times(options, reader);
  make_folder("--video", options.video);
  const Descriptor lock = lock_folder(options.video);
  expect_empty(options.video);
  Studio studio(options, reader);
  const bool is_watched = ::isatty(STDERR_FILENO) == 1;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (g_is_interrupted != 0) throw replay::BrowserError(fmt::format("interrupted after {} pictures", i));
    studio.show(instants[i]);
    write_file(fs::path(options.video) / fmt::format("frame-{:06}.png", i), studio.take_picture());
    if (is_watched) std::fprintf(stderr, "\r%zu of %zu pictures", i + 1, instants.size());
  }
  std::fprintf(stderr, "%s%s: %zu pictures\n", is_watched ? "\r" : "", options.video.c_str(), instants.size());
}

}  // namespace

int run_picture(const PictureOptions& options) {
  expect_one_of("--camera", options.camera, kCameras);
  expect_one_of("--theme", options.theme, std::array{"light", "dark"});
  expect_parts("--show", options.show);
  expect_parts("--hide", options.hide);
  std::optional<OutputFile> output;
  NamedFiles inputs = {{"the recording", options.recording}};
  add_file(inputs, "--urdf", options.urdf);
  if (!options.output.empty()) output = reserve(inputs, options.output);
  record::RecordingReader reader(options.recording);
  expect_recorded(reader, options.recording, options.time);
  heed_interruption();
  try {
    if (!options.video.empty()) {
      draw_video(options, reader);
    } else {
      const std::string picture = Studio(options, reader).take_picture();
      write_file(std::move(*output), picture);
      std::fprintf(stderr, "%s: %dx%d at %.3f s, camera %s\n", options.output.c_str(), options.width, options.height,
                   options.time.value_or(reader.times().back()), options.camera.c_str());
    }
  } catch (const replay::BrowserError& error) {
    std::fprintf(stderr, "snug: failed: %s\n", error.what());
    return kRunFailed;
  }
  return kSuccess;
}

}  // namespace snug::app
