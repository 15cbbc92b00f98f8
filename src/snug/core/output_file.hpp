// OutputFile: a file that is written whole or not at all, by one writer at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>

namespace snug {

/// Writing failed after it had begun (disk full, folder gone): the input was fine, the run was not.
class OutputError : public std::runtime_error {
 public:
  OutputError(const std::string& where, const std::string& why);
};

/// A file in the making: it is written beside its place, as NAME.snug-part, and put there by publish(). Until then
/// what was there stays; without publish() nothing changes and nothing is left. A replaced file's mode is kept (and its
/// owner, where the system lets us), a symbolic link stays and what it leads to is replaced.
///
/// One writer at a time: who comes second is refused until the first one's object is gone. A draft that a killed
/// process left behind is taken over.
class OutputFile {
 public:
  /// Makes and locks the draft, which shows that the place can be written. Throws InputError when it cannot: no such
  /// folder, no permission, something that is not a regular file, another writer.
  OutputFile(const std::filesystem::path& path);  // NOLINT(google-explicit-constructor): what takes a file takes a path
  ~OutputFile();
  OutputFile(OutputFile&&) noexcept;
  OutputFile& operator=(OutputFile&&) noexcept;

  /// As it was asked for.
  [[nodiscard]] const std::filesystem::path& path() const;
  /// Where the bytes are now: for libraries that write files themselves.
  [[nodiscard]] const std::filesystem::path& location() const;
  /// Was there a file when this one was begun?
  [[nodiscard]] bool replaces_file() const;
  [[nodiscard]] bool is_published() const;

  /// Appends. Throws OutputError.
  void write(std::string_view bytes);
  /// In the place of all that was written before, in one step: who looks sees the one or the other, also when the
  /// process is killed meanwhile. Throws OutputError; then what was there before stays.
  void replace(std::string_view bytes);
  /// Puts the file into its place, safe from a power failure. The lock stays, and who has it open may go on writing.
  /// Throws OutputError.
  void publish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The draft of a file that would be written at `path`; what is there when it begins is taken for left over, and
/// removed. Throws InputError for a circle of links.
[[nodiscard]] std::filesystem::path draft_of(const std::filesystem::path& path);

/// For `main` alone: when the user or the system ends the program (SIGINT, SIGTERM, SIGHUP), drafts are removed first.
void remove_drafts_when_interrupted();

}  // namespace snug
