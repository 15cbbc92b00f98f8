// Browser: the DevTools protocol over --remote-debugging-pipe: JSON texts that end with a zero byte. No port is opened.
#include "snug/replay/browser.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <nlohmann/json.hpp>
#include <vector>

#include "snug/core/input_error.hpp"

extern char** environ;  // NOLINT(readability-redundant-declaration): POSIX leaves it to the program

namespace snug::replay {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

constexpr std::chrono::seconds kAnswerPatience(120);  // for one answer, on a machine that is busy
constexpr std::chrono::seconds kGoodbye(5);
constexpr int kReads = 3, kWrites = 4;  // the browser's ends of the pipe, by its convention
constexpr std::size_t kLargestMessage = std::size_t{256} << 20U;

/// Of the standard alphabet; what is not of it is left out.
std::string from_base64(const std::string& text) {
  static const std::array<int, 256> values = [] {
    std::array<int, 256> table;
    table.fill(-1);
    const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (int i = 0; i < 64; ++i) table[static_cast<unsigned char>(letters[i])] = i;
    return table;
  }();
  std::string bytes;
  unsigned gathered = 0;
  int bits = 0;
  for (const char c : text) {
    const int value = values[static_cast<unsigned char>(c)];
    if (value < 0) continue;
    gathered = ((gathered << 6U) | static_cast<unsigned>(value)) & 0xFFFFU;
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(static_cast<unsigned char>((gathered >> bits) & 0xFFU));
  }
  return bytes;
}

/// Two ends of one connection, both above the numbers that the browser expects and closed in its other children.
std::array<int, 2> make_connection() {
  std::array<int, 2> low{}, high{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, low.data()) != 0) throw BrowserError(std::strerror(errno));
  for (std::size_t i = 0; i < 2; ++i) {
    high[i] = ::fcntl(low[i], F_DUPFD_CLOEXEC, kWrites + 1);
    ::close(low[i]);
  }
  if (high[0] < 0 || high[1] < 0) throw BrowserError("too many open files");
  return high;
}

}  // namespace

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

Browser::Browser(const std::string& program, const std::filesystem::path& profile, int width, int height) {
  start(program, profile, width, height);
  try {
    const Json target = Json::parse(call("Target.createTarget", R"({"url": "about:blank"})"));
    const Json attached = {{"targetId", target.at("targetId")}, {"flatten", true}};
    session_ = Json::parse(call("Target.attachToTarget", attached.dump())).at("sessionId");
    const Json screen = {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}};
    call("Emulation.setDeviceMetricsOverride", screen.dump());
  } catch (const Json::exception& error) {
    end();
    throw BrowserError(fmt::format("{} gave an unexpected answer: {}", program, error.what()));
  } catch (...) {
    end();
    throw;
  }
}

Browser::~Browser() { end(); }

void Browser::start(const std::string& program, const std::filesystem::path& profile, int width, int height) {
  const std::array<int, 2> ends = make_connection();
  std::vector<std::string> words = {program,
                                    "--headless",
                                    "--no-sandbox",
                                    "--disable-dev-shm-usage",
                                    "--disable-gpu",
                                    "--enable-unsafe-swiftshader",
                                    "--disable-quic",
                                    "--no-first-run",
                                    "--disable-background-networking",
                                    "--disable-component-update",
                                    "--disable-sync",
                                    "--hide-scrollbars",
                                    "--remote-debugging-pipe",
                                    "--user-data-dir=" + profile.string(),
                                    fmt::format("--window-size={},{}", width, height)};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  for (const int file : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    posix_spawn_file_actions_addopen(&actions, file, "/dev/null", file == STDIN_FILENO ? O_RDONLY : O_WRONLY, 0);
  }
  posix_spawn_file_actions_adddup2(&actions, ends[1], kReads);
  posix_spawn_file_actions_adddup2(&actions, ends[1], kWrites);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // its helpers can be stopped with it
  const int failed = ::posix_spawn(&child_, words[0].c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  ::close(ends[1]);
  socket_ = ends[0];
  if (failed == 0) return;
  child_ = 0;
  end();
  throw BrowserError(fmt::format("{} cannot be started: {}", program, std::strerror(failed)));
}

void Browser::end() {
  if (socket_ >= 0) {
    try {
      send(Json({{"id", ++last_id_}, {"method", "Browser.close"}}).dump());
    } catch (const BrowserError&) {  // it has gone already
    }
    ::close(socket_);
    socket_ = -1;
  }
  if (child_ == 0) return;
  const auto deadline = Clock::now() + kGoodbye;
  while (::waitpid(child_, nullptr, WNOHANG) == 0) {
    if (Clock::now() > deadline) {
      ::kill(-child_, SIGKILL);
      ::waitpid(child_, nullptr, 0);
      break;
    }
    ::usleep(10'000);
  }
  child_ = 0;
}

void Browser::send(const std::string& message) {
  const std::string bytes = message + '\0';
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw BrowserError("the browser has ended");
    sent += static_cast<std::size_t>(count);
  }
}

std::string Browser::receive(Clock::time_point deadline) {
  for (std::size_t seen = 0;;) {
    const std::size_t end = buffer_.find('\0', seen);
    if (end != std::string::npos) {
      std::string message = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      return message;
    }
    seen = buffer_.size();
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd waiting = {socket_, POLLIN, 0};
    const int ready = left > 0 ? ::poll(&waiting, 1, static_cast<int>(left)) : 0;
    if (ready < 0 && errno == EINTR) throw BrowserError("interrupted");
    if (ready <= 0) throw BrowserError(fmt::format("the browser has not answered for {} s", kAnswerPatience.count()));
    std::array<char, 65536> part;
    const ssize_t count = ::recv(socket_, part.data(), part.size(), 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw BrowserError("the browser has ended");
    buffer_.append(part.data(), static_cast<std::size_t>(count));
    if (buffer_.size() > kLargestMessage) throw BrowserError("the browser sent too much data");
  }
}

std::string Browser::call(const std::string& method, const std::string& parameters) {
  const int id = ++last_id_;
  Json message = {{"id", id}, {"method", method}, {"params", Json::parse(parameters)}};
  if (!session_.empty()) message["sessionId"] = session_;
  send(message.dump());
  const auto deadline = Clock::now() + kAnswerPatience;
  for (;;) {
    const Json answer = Json::parse(receive(deadline), nullptr, false);
    if (answer.is_discarded() || answer.value("id", 0) != id) continue;  // events, of which none is needed
    if (answer.contains("error")) {
      throw BrowserError(fmt::format("{}: {}", method, answer["error"].value("message", "failed")));
    }
    return answer.value("result", Json::object()).dump();
  }
}

void Browser::open(const std::string& address) {
  const Json result = Json::parse(call("Page.navigate", Json({{"url", address}}).dump()));
  if (const std::string trouble = result.value("errorText", ""); !trouble.empty()) throw BrowserError(trouble);
}

std::string Browser::evaluate(const std::string& expression) {
  const Json parameters = {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}};
  const Json result = Json::parse(call("Runtime.evaluate", parameters.dump()));
  if (result.contains("exceptionDetails")) {
    const Json& details = result["exceptionDetails"];
    const Json thrown = details.value("exception", Json::object());
    throw BrowserError("in the page: " + thrown.value("description", details.value("text", "failed")));
  }
  return result.at("result").value("value", Json()).dump();
}

std::string Browser::take_picture() {
  const Json result = Json::parse(call("Page.captureScreenshot", R"({"format": "png"})"));
  std::string png = from_base64(result.value("data", ""));
  if (!png.starts_with("\x89PNG")) throw BrowserError("the browser drew no picture");
  return png;
}

}  // namespace snug::replay
