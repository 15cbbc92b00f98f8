// Browser: a Chromium without a screen that opens one page, is asked things and photographed, over a pipe of its own.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace snug::replay {

/// Chromium as the environment variable SNUG_CHROMIUM or Debian's package chromium has it. Throws InputError naming
/// both when there is none.
[[nodiscard]] std::string find_browser();

/// What went wrong with the browser or in the page. Not the user's fault: the exit code is 1.
class BrowserError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The process ends with the object, and with this program however that ends. A signal that is handled while it is
/// waited for counts as an interruption: BrowserError.
class Browser {
 public:
  /// `profile`: a folder of its own for what it keeps. Throws BrowserError when it does not start.
  Browser(const std::string& program, const std::filesystem::path& profile, int width, int height);
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  void open(const std::string& address);
  /// The value of a JavaScript expression as JSON text; waits for it when it is a promise. Throws BrowserError with
  /// the script's own words when it throws.
  [[nodiscard]] std::string evaluate(const std::string& expression);
  /// What is to be seen, as PNG.
  [[nodiscard]] std::string take_picture();

 private:
  /// Calls a method of the DevTools protocol: parameters and result are JSON objects.
  std::string call(const std::string& method, const std::string& parameters);
  void send(const std::string& message);
  [[nodiscard]] std::string receive(std::chrono::steady_clock::time_point deadline);
  void start(const std::string& program, const std::filesystem::path& profile, int width, int height);
  void end();

  pid_t child_ = 0;
  int socket_ = -1;
  int last_id_ = 0;
  std::string session_;
  std::string buffer_;  ///< received, not read yet
};

}  // namespace snug::replay
