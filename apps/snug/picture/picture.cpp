// picture: one instant of a recording as PNG, or many for a video, drawn without a screen.
#include "apps/snug/command_line/verbs.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "apps/snug/command_line/stop_signal.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "apps/snug/command_line/viewer_page.hpp"
#include "apps/snug/common/recordings.hpp"
#include "snug/core/descriptor.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/temporary_folder.hpp"
#include "snug/core/write_file.hpp"
#include "snug/replay/browser.hpp"
#include "snug/replay/replay.hpp"
#include "snug/report/recordings_page.hpp"

namespace snug::app {
namespace {

struct PictureOptions {
  std::string recording;
  std::string output;              ///< one picture; empty: a video
  std::optional<double> time;      ///< s; absent: the end
  std::string video;               ///< folder for numbered pictures; empty: one picture
  double fps = 25.0;               ///< pictures a second
  double speed = 1.0;              ///< of the video: recorded seconds a second
  std::optional<double> from, to;  ///< s; of the video
  std::string size = "1280x800";   ///< px
  std::string camera = "cell";
  std::string theme = "light";
  std::optional<std::string> urdf;  ///< of the robot in it; absent: looked for
  std::string show, hide;           ///< parts of the drawing, separated by commas
};

namespace fs = std::filesystem;

constexpr std::array kParts = {"names", "contacts", "forces", "wrenches", "ghost",  "frames",
                               "trace", "xray",     "robot",  "walls",    "shadows"};
constexpr std::size_t kMostFrames = 200'000;
constexpr std::chrono::seconds kPatience(60);  // until the page has drawn for the first time

void expect_parts(const char* option, const std::string& list) {
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    if (std::ranges::find(kParts, part) == kParts.end())
      throw InputError("command line", option, part, fmt::format("one of {}", fmt::join(kParts, ", ")));
  }
}

struct PictureSize {
  int width = 0, height = 0;  ///< px
};

PictureSize size_of(const PictureOptions& options) {
  PictureSize size;
  char rest = '\0';
  const int found = std::sscanf(options.size.c_str(), "%dx%d%c", &size.width, &size.height, &rest);
  const auto is_fine = [](int pixels) { return pixels >= 16 && pixels <= 8192; };
  if (found == 2 && is_fine(size.width) && is_fine(size.height)) return size;
  throw InputError("command line", "--size", options.size,
                   "WIDTHxHEIGHT in pixels, each from 16 to 8192, such as 1280x800");
}

/// The page with the recording in it, in a browser, as it is drawn for pictures.
class Studio {
 public:
  Studio(const PictureOptions& options, const PictureSize& size, record::RecordingReader& reader)
      : browser_(replay::find_browser(), folder_.path() / "profile", size.width, size.height) {
    const report::PageRecording recording = encode_recording(reader, options.recording, {}, options.urdf);
    const fs::path page = folder_.path() / "page.html";
    write_file(page, report::assemble_page(viewer_page(), {&recording, 1}));
    browser_.open(fmt::format("file://{}#picture=1&t={}&camera={}&theme={}&show={}&hide={}&size={}x{}", page.string(),
                              options.time.value_or(options.from.value_or(reader.times().back())), options.camera,
                              options.theme, options.show, options.hide, size.width, size.height));
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
  Studio studio(options, size_of(options), reader);
  const bool is_watched = ::isatty(STDERR_FILENO) == 1;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (is_interrupted()) throw replay::BrowserError(fmt::format("interrupted after {} pictures", i));
    studio.show(instants[i]);
    write_file(fs::path(options.video) / fmt::format("frame-{:06}.png", i), studio.take_picture());
    if (is_watched) std::fprintf(stderr, "\r%zu of %zu pictures", i + 1, instants.size());
  }
  std::fprintf(stderr, "%s%s: %zu pictures\n", is_watched ? "\r" : "", options.video.c_str(), instants.size());
}

void check_picture_words(const PictureOptions& options) {
  const bool is_video = !options.video.empty();
  if (is_video == !options.output.empty()) {
    throw InputError("command line", "-o, --video", is_video ? "both" : "none of them",
                     "-o FILE.png for one picture, or --video DIR for many");
  }
  if (is_video && options.time) throw InputError("command line", "--time", "with --video", "--from and --to");
  if (!is_video && (options.from || options.to)) {
    throw InputError("command line", "--from, --to", "without --video", "--time for one picture");
  }
}

int run_picture(const PictureOptions& options) {
  check_picture_words(options);
  const PictureSize size = size_of(options);
  expect_parts("--show", options.show);
  expect_parts("--hide", options.hide);
  std::optional<OutputFile> output;
  NamedFiles inputs = {{"the recording", options.recording}};
  add_file(inputs, "--urdf", options.urdf);
  if (!options.output.empty()) output = reserve(inputs, options.output);
  record::RecordingReader reader(options.recording);
  expect_recorded(reader, options.recording, options.time);
  catch_interrupts();
  try {
    if (!options.video.empty()) {
      draw_video(options, reader);
    } else {
      const std::string picture = Studio(options, size, reader).take_picture();
      write_file(std::move(*output), picture);
      std::fprintf(stderr, "%s: %dx%d at %.3f s, camera %s\n", options.output.c_str(), size.width, size.height,
                   options.time.value_or(reader.times().back()), options.camera.c_str());
    }
  } catch (const replay::BrowserError& error) {
    std::fprintf(stderr, "snug: failed: %s\n", error.what());
    return kRunFailed;
  }
  return kSuccess;
}

constexpr const char* kPictureExamples = R"(Examples:
  snug picture run.h5 -o end.png --camera top
  snug picture run.h5 --time 12.3 --size 1920x1080 --show frames,wrenches -o pick.png
  snug picture run.h5 --video frames --fps 25 --from 10 --to 20
  ffmpeg -framerate 25 -i frames/frame-%06d.png -pix_fmt yuv420p run.mp4      # makes a film of the last)";

// Pictures a second, and times as fast as it was.
constexpr double kSlowest = 1e-3;
constexpr double kFastest = 1000.0;

}  // namespace

void add_picture(CLI::App& app, Action& action) {
  const Verb verb(app, action, "picture",
                  "draw an instant of a recording as PNG, or the frames of a video; needs chromium", kPictureExamples);
  PictureOptions& options = verb.runs(run_picture);
  verb.option("recording", options.recording, "FILE.h5", "what to draw").required();
  verb.option("-o,--output", options.output, "FILE.png", "the picture to write");
  verb.option("--time", options.time, "SECONDS", "of the instant; without it the end", finite());
  verb.option("--video", options.video, "DIR",
              "instead of one picture: frame-000000.png ... in this new or empty folder");
  verb.option("--fps", options.fps, "N", "pictures a second of the video", within(kSlowest, kFastest));
  verb.option("--speed", options.speed, "FACTOR", "of the video, recorded seconds a second",
              within(kSlowest, kFastest));
  verb.option("--from", options.from, "SECONDS", "where the video begins; without it the first frame", finite());
  verb.option("--to", options.to, "SECONDS", "where the video ends; without it the last frame", finite());
  verb.option("--size", options.size, "WxH", "in pixels");
  verb.option("--camera", options.camera, "NAME", "cell, top, side (both of the container) or tool",
              one_of({"cell", "top", "side", "tool"}));
  verb.option("--theme", options.theme, "NAME", "light or dark", one_of({"light", "dark"}));
  verb.option("--show", options.show, "A,B",
              "parts to draw: names, contacts, forces, wrenches, ghost, frames, trace, xray, robot, walls, shadows");
  verb.option("--hide", options.hide, "A,B", "parts to leave out");
  add_urdf(verb, options.urdf);
}

}  // namespace snug::app
