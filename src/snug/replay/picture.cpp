// Pictures: instants of a recording as PNG, drawn by the page that holds it, in a browser without a screen.
#include "snug/replay/picture.hpp"

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
#include <sstream>

#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"

namespace snug::replay {
namespace {

namespace fs = std::filesystem;

constexpr std::array kParts = {"names", "contacts", "forces", "wrenches", "ghost",  "frames",
                               "trace", "xray",     "robot",  "walls",    "shadows"};
constexpr std::size_t kMostFrames = 200'000;
constexpr std::chrono::seconds kPatience(60);  // until the page has drawn for the first time

/// Pictures of an earlier video must not get among the new ones.
void expect_empty(const fs::path& path) {
  std::error_code error;
  if (!fs::is_empty(path, error) || error) {
    throw InputError(path.string(), "--video", error ? error.message() : "a folder with something in it",
                     "a new or empty folder");
  }
}

Descriptor lock_folder(const fs::path& path) {
  Descriptor folder(::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.is_open() && ::flock(folder.get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    throw InputError(path.string(), "--video", "a folder that another run is writing to",
                     "one that nobody else writes to");
  return folder;
}

}  // namespace

void expect_picture_parts(const char* option, const std::string& list) {
  std::istringstream parts(list);
  for (std::string part; std::getline(parts, part, ',');) {
    if (std::ranges::find(kParts, part) == kParts.end())
      throw InputError("command line", option, part, fmt::format("one of {}", fmt::join(kParts, ", ")));
  }
}

PictureSize parse_picture_size(const std::string& words) {
  PictureSize size;
  char rest = '\0';
  const int found = std::sscanf(words.c_str(), "%dx%d%c", &size.width, &size.height, &rest);
  const auto is_fine = [](int pixels) { return pixels >= 16 && pixels <= 8192; };
  if (found == 2 && is_fine(size.width) && is_fine(size.height)) return size;
  throw InputError("command line", "--size", words, "WIDTHxHEIGHT in pixels, each from 16 to 8192, such as 1280x800");
}

Studio::Studio(std::string_view page, const PictureView& view, double time)
    : browser_(find_browser(), folder_.path() / "profile", view.size.width, view.size.height) {
  const fs::path file = folder_.path() / "page.html";
  write_file(file, page);
  browser_.open(fmt::format("file://{}#picture=1&t={}&camera={}&theme={}&show={}&hide={}&size={}x{}", file.string(),
                            time, view.camera, view.theme, view.show, view.hide, view.size.width, view.size.height));
  wait_until_drawn();
}

void Studio::show(double time) {
  // The next picture of the browser but one has surely been drawn after the change.
  (void)browser_.evaluate(fmt::format(
      "window.snug.setTime({}), new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(0))))",
      time));
}

void Studio::wait_until_drawn() {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (browser_.evaluate("window.snugReady === true") != "true") {
    if (std::chrono::steady_clock::now() > deadline) throw BrowserError("the page did not draw within a minute");
    ::usleep(20'000);
  }
  const std::string trouble = browser_.evaluate("window.snug.error");
  if (trouble != "\"\"") throw BrowserError("in the page: " + trouble);
}

std::vector<double> video_instants(const std::vector<double>& times, const VideoTimes& video) {
  const double from = std::max(times.front(), video.from.value_or(times.front()));
  const double to = std::min(times.back(), video.to.value_or(times.back()));
  if (from > to) {
    throw InputError("command line", "--from, --to", "nothing between them",
                     fmt::format("times within {:.3f} s to {:.3f} s", times.front(), times.back()));
  }
  const double step = video.speed / video.fps;
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

VideoFolder::VideoFolder(const fs::path& path) : path_(path), lock_(lock_folder(path)) { expect_empty(path); }

void VideoFolder::draw(Studio& studio, const std::vector<double>& instants, const std::function<bool()>& is_interrupted,
                       const std::function<void(std::size_t)>& tell) const {
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (is_interrupted()) throw BrowserError(fmt::format("interrupted after {} pictures", i));
    studio.show(instants[i]);
    write_file(path_ / fmt::format("frame-{:06}.png", i), studio.take_picture());
    tell(i + 1);
  }
}

}  // namespace snug::replay
