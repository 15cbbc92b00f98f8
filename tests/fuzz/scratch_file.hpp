// Files of this process in memory, for readers that take no text.
#pragma once

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace snug::fuzz {

/// A place in memory where the system has it.
inline std::filesystem::path scratch_path(const std::string& ending) {
  const std::filesystem::path memory = "/dev/shm";
  const bool has_memory = ::access(memory.c_str(), W_OK) == 0;
  return (has_memory ? memory : std::filesystem::temp_directory_path()) /
         ("snug-fuzz-" + std::to_string(::getpid()) + ending);
}

inline void write_scratch(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      .write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

class ScratchFile {
 public:
  explicit ScratchFile(const std::string& ending) : path_(scratch_path(ending)) {}
  ~ScratchFile() { ::unlink(path_.c_str()); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void write(std::string_view bytes) const { write_scratch(path_, bytes); }

 private:
  std::filesystem::path path_;
};

/// A folder whose files only their owner can read.
class ScratchFolder {
 public:
  ScratchFolder() : path_(scratch_path("")) { std::filesystem::create_directory(path_); }
  ~ScratchFolder() {
    std::error_code failed;
    std::filesystem::remove_all(path_, failed);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void write(const std::string& name, std::string_view bytes) const {
    write_scratch(path_ / name, bytes);
    ::chmod((path_ / name).c_str(), 0600);
  }

 private:
  std::filesystem::path path_;
};

}  // namespace snug::fuzz
