// peak_memory: how much more memory a piece of work takes at its worst, measured in a child process.
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstddef>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

namespace snug::test {

/// A line of /proc/self/status, bytes: VmRSS is what the process has now, VmHWM the most that it ever had.
inline std::size_t memory_status(const std::string& key) {
  std::ifstream file("/proc/self/status");
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with(key + ":")) continue;
    std::size_t kilobytes = 0;
    std::istringstream(line.substr(key.size() + 1)) >> kilobytes;
    return kilobytes << 10U;
  }
  return 0;
}

/// Bytes beyond what the process had before; nothing when the child did not come to its end. The child never returns.
template <class Work>
std::optional<std::size_t> peak_memory(Work work) {
  int ends[2] = {-1, -1};
  if (::pipe(ends) != 0) return std::nullopt;
  const pid_t child = ::fork();
  if (child == 0) {
    std::ofstream("/proc/self/clear_refs") << "5";  // VmHWM starts anew
    const std::size_t before = memory_status("VmRSS");
    work();
    const std::size_t peak = memory_status("VmHWM");
    const std::size_t more = peak > before ? peak - before : 0;
    const bool is_told = ::write(ends[1], &more, sizeof more) == sizeof more;
    ::_exit(is_told ? 0 : 1);
  }
  ::close(ends[1]);
  std::size_t more = 0;
  const bool is_told = ::read(ends[0], &more, sizeof more) == sizeof more;
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  if (!is_told || !WIFEXITED(status) || WEXITSTATUS(status) != 0) return std::nullopt;
  return more;
}

/// What reading an input of this size may take.
inline std::size_t allowed_memory(std::size_t input_bytes) { return 20 * input_bytes + 100'000'000; }

}  // namespace snug::test
