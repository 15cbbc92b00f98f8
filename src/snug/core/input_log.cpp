// InputLog: which files this process reads, for who has to say what a result is a function of.
#include "snug/core/input_log.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <mutex>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/descriptor.hpp"
#include "snug/core/hash.hpp"

namespace snug {
namespace {

// The one log of the process. A row of a study is a process of its own, and its readers are forty functions in a dozen
// modules: handing a log through all of them would leave out the one that is written next (docs/decisions/0070).
std::atomic<bool> has_log = false;
std::mutex log_mutex;
InputLog::Tell log_tell;

bool is_of_system(const std::string& path) {
  return path.starts_with("/proc/") || path.starts_with("/dev/") || path.starts_with("/sys/");
}

}  // namespace

InputLog::InputLog(Tell tell) {
  const std::lock_guard lock(log_mutex);
  SNUG_CHECK(!has_log, "one log of inputs at a time");
  log_tell = std::move(tell);
  has_log = true;
}

InputLog::~InputLog() {
  const std::lock_guard lock(log_mutex);
  has_log = false;
  log_tell = {};
}

void note_input_hash(const std::string& path, std::uint64_t hash) {
  if (!has_log) return;
  const std::lock_guard lock(log_mutex);
  if (log_tell) log_tell(path, hash);
}

void note_input(const std::filesystem::path& path, std::string_view bytes) {
  if (!has_log || is_of_system(path.string())) return;
  Hash hash;
  hash.add(bytes);
  note_input_hash(path.string(), hash.value());
}

void note_input_file(const std::filesystem::path& path) {
  if (!has_log || is_of_system(path.string())) return;
  note_input_hash(path.string(), hash_of_file(path));
}

std::uint64_t hash_of_file(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  struct stat status = {};
  if (!file.is_open() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) return 0;
  Hash hash;
  for (char buffer[65536];;) {
    const ssize_t count = ::read(file.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return 0;
    if (count == 0) return hash.value();
    hash.add(std::string_view(buffer, static_cast<std::size_t>(count)));
  }
}

}  // namespace snug
