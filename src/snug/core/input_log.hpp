// InputLog: which files this process reads, for who has to say what a result is a function of.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

namespace snug {

/// While it lives, `tell` is called for every file that is read here with its path as it was named and a hash of its
/// bytes, one call at a time, by whatever thread reads. At most one at a time.
class InputLog {
 public:
  using Tell = std::function<void(const std::string& path, std::uint64_t hash)>;
  explicit InputLog(Tell tell);
  ~InputLog();
  InputLog(const InputLog&) = delete;
  InputLog& operator=(const InputLog&) = delete;
};

/// For readers: these bytes were read of that file. Does nothing without a log; files of the system (/proc, /dev, /sys)
/// are no inputs.
void note_input(const std::filesystem::path& path, std::string_view bytes);
/// The same for a file that a library reads by its name.
void note_input_file(const std::filesystem::path& path);
/// The same for one that another process has read.
void note_input_hash(const std::string& path, std::uint64_t hash);
/// Of the file's bytes; 0 where it cannot be read.
[[nodiscard]] std::uint64_t hash_of_file(const std::filesystem::path& path);

}  // namespace snug
