// picture: puts the recording into the viewer's page and has a browser without a screen draw it.
#include "picture.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/replay/page.hpp"
#include "snug/replay/replay.hpp"
#include "viewer_page.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace snug::app {
namespace {

namespace fs = std::filesystem;

constexpr std::array kCameras = {"cell", "top", "side", "tool"};
constexpr std::array kParts = {"names", "contacts", "forces", "wrenches", "ghost",  "frames",
                               "trace", "xray",     "robot",  "walls",    "shadows"};
constexpr int kPatienceSeconds = 120;

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

std::string find_browser() {
  if (const char* chosen = std::getenv("SNUG_CHROMIUM")) {
    if (::access(chosen, X_OK) == 0) return chosen;
    throw InputError("environment", "SNUG_CHROMIUM", chosen, "a program that can be run");
  }
  for (const char* path : {"/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"}) {
    if (::access(path, X_OK) == 0) return path;
  }
  throw InputError("snug picture", "chromium", "none",
                   "Debian's package chromium, or a program like it named by the environment variable SNUG_CHROMIUM");
}

/// A folder that is gone with the object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "snug-picture-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw InputError(name, "", "cannot be made", "a folder for temporary files (environment variable TMPDIR)");
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs a program with its output thrown away; false when it could not be started, failed, or took too long.
bool run_quietly(std::vector<std::string> words) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, file, "/dev/null", file == STDIN_FILENO ? 0 : 1, 0);
  }
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // its helpers can be stopped with it
  pid_t child = 0;
  const int failed = ::posix_spawn(&child, words[0].c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return false;
  int status = 0;
  for (int waited = 0; ::waitpid(child, &status, WNOHANG) == 0; ++waited) {
    if (waited == 20 * kPatienceSeconds) {
      ::kill(-child, SIGKILL);
      ::waitpid(child, &status, 0);
      return false;
    }
    ::usleep(50'000);
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string read_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

int run_picture(const PictureOptions& options) {
  expect_one_of("--camera", options.camera, kCameras);
  expect_one_of("--theme", options.theme, std::array{"light", "dark"});
  expect_parts("--show", options.show);
  expect_parts("--hide", options.hide);
  if (options.time && !std::isfinite(*options.time)) {
    throw InputError("command line", "--time", fmt::format("{}", *options.time), "a finite number of seconds");
  }
  const std::string browser = find_browser();
  record::RecordingReader reader(options.recording);
  const std::string name = fs::path(options.recording).filename().string();
  const replay::PageRecording recording{name, replay::encode_recording(reader, name, {})};
  const TemporaryFolder folder;
  const fs::path page = folder.path() / "page.html", picture = folder.path() / "picture.png";
  replay::write_whole_file(page, replay::assemble_page(viewer_page(), {&recording, 1}));
  const std::string address = fmt::format("file://{}#picture=1&t={}&camera={}&theme={}&show={}&hide={}&size={}x{}",
                                          page.string(), options.time.value_or(1e9), options.camera, options.theme,
                                          options.show, options.hide, options.width, options.height);
  const bool is_drawn = run_quietly(
      {browser, "--headless", "--no-sandbox", "--disable-gpu", "--enable-unsafe-swiftshader", "--disable-quic",
       "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
       "--hide-scrollbars", "--virtual-time-budget=20000", "--user-data-dir=" + (folder.path() / "profile").string(),
       fmt::format("--window-size={},{}", options.width, options.height), "--screenshot=" + picture.string(), address});
  const std::string png = read_file(picture);
  if (!is_drawn || !png.starts_with("\x89PNG")) {
    std::fprintf(stderr, "snug: %s drew no picture\n", browser.c_str());
    return kRunFailed;
  }
  replay::write_whole_file(options.output, png);
  return kSuccess;
}

}  // namespace snug::app
