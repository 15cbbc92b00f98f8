// read_file: a whole text file, if it is one of a sensible size.
#include "snug/core/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "snug/core/input_error.hpp"
#include "snug/core/input_log.hpp"

namespace snug {
namespace {

/// A file that is open for reading; closed when this goes.
class OpenFile {
 public:
  /// Without waiting: a pipe that nobody writes to would hold the program before anybody can look what it is.
  explicit OpenFile(const std::filesystem::path& path)
      : file_(::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC)) {}
  ~OpenFile() {
    if (file_ >= 0) ::close(file_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int get() const { return file_; }

 private:
  int file_;
};

std::string describe(mode_t mode) {
  if (S_ISDIR(mode)) return "a folder";
  if (S_ISFIFO(mode)) return "a pipe";
  if (S_ISCHR(mode) || S_ISBLK(mode)) return "a device";
  return "something that is not a regular file";
}

[[noreturn]] void refuse_size(const std::filesystem::path& path, const std::string& expected, std::size_t most) {
  const bool is_mega = most >= (std::size_t{1} << 20U);
  const std::string limit = std::to_string(is_mega ? most >> 20U : most >> 10U) + (is_mega ? " MB" : " kB");
  throw InputError(path.string(), "", "more than " + limit, expected + " of at most " + limit);
}

/// Opens it and looks what it is.
struct Looked {
  OpenFile file;
  std::size_t size = 0;

  Looked(const std::filesystem::path& path, const std::string& expected, std::size_t most) : file(path) {
    struct stat status {};
    if (file.get() < 0 || ::fstat(file.get(), &status) != 0) {
      throw InputError(path.string(), "", errno == ENOENT ? "no such file" : std::strerror(errno), expected);
    }
    if (!S_ISREG(status.st_mode)) throw InputError(path.string(), "", describe(status.st_mode), expected);
    size = static_cast<std::size_t>(std::max<off_t>(0, status.st_size));
    if (size > most) refuse_size(path, expected, most);
  }
};

}  // namespace

std::string read_file(const std::filesystem::path& path, const std::string& expected, std::size_t most) {
  const Looked looked(path, expected, most);
  std::string text;
  text.reserve(looked.size);
  // Until the end, not by the size: files below /proc say 0, and others may grow meanwhile.
  for (char buffer[65536];;) {
    const ssize_t count = ::read(looked.file.get(), buffer, sizeof buffer);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw InputError(path.string(), "", std::strerror(errno), expected);
    if (count == 0) {
      note_input(path, text);
      return text;
    }
    if (text.size() + static_cast<std::size_t>(count) > most) refuse_size(path, expected, most);
    text.append(buffer, static_cast<std::size_t>(count));
  }
}

void check_readable(const std::filesystem::path& path, const std::string& expected, std::size_t most) {
  const Looked looked(path, expected, most);
  note_input_file(path);
}

}  // namespace snug
