// Folder: scenarios, items and logs of runs as plain files of one folder, for who must not reach beyond it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/descriptor.hpp"

namespace snug::workspace {

inline constexpr std::size_t kLargestUpload = std::size_t{4} << 20U;  ///< bytes of a text that is written
inline constexpr std::size_t kLargestMesh = std::size_t{16} << 20U;   ///< bytes of a mesh that is written
inline constexpr std::size_t kLargestRead = std::size_t{256} << 20U;  ///< bytes of what runs leave
inline constexpr std::size_t kLongestName = 100;                      ///< bytes
inline constexpr std::size_t kMostEntries = 10000;                    ///< in a list

enum class FileKind {
  Scenario,    ///< NAME.yaml
  Items,       ///< NAME.csv, orders
  Log,         ///< NAME.jsonl, events that `snug pack --log` writes
  Words,       ///< NAME.txt, the command of a run and what it printed
  Recording,   ///< NAME.h5
  Program,     ///< NAME.program.csv
  Report,      ///< NAME.html
  Live,        ///< NAME.live, frames that `snug pack --live` writes
  Operator,    ///< NAME.operator, what who operates says: `snug pack --operator` reads it
  Picture,     ///< NAME.png
  Scene,       ///< NAME.glb
  Script,      ///< NAME.script, URScript
  Trajectory,  ///< NAME.ros.yaml
  Mcap,        ///< NAME.mcap
  Urdf,        ///< NAME.urdf, an arm
  Mesh,        ///< NAME.stl, .obj or .dae, of an arm
};

struct Entry {
  std::string name;
  FileKind kind = FileKind::Scenario;
  std::uintmax_t bytes = 0;
  bool operator==(const Entry&) const = default;
};

/// The kind that the ending of a name says. A name has 1 to kLongestName ASCII letters, digits, `.`, `_` and `-`, and
/// begins with a letter or digit: it is no path, no hidden file and no option of a command. Throws InputError for any
/// other name and for an ending that is none of FileKind.
[[nodiscard]] FileKind kind_of_name(std::string_view name);

/// A folder that was opened once: moving or replacing its path later does not lead elsewhere. Symbolic links in it are
/// neither listed nor followed nor written through; pipes, devices and folders are no files of it.
class Folder {
 public:
  /// Throws InputError where there is no folder.
  explicit Folder(const std::filesystem::path& path);

  /// By name. Files with names that kind_of_name() refuses are left out. Throws InputError for more than kMostEntries.
  [[nodiscard]] std::vector<Entry> list() const;
  /// Throws InputError for a name that is refused, and for what is no regular file of a bounded size.
  [[nodiscard]] std::string read(const std::string& name) const { return read_from(name, 0); }
  /// What lies behind the first `offset` bytes; empty where there are not so many; at most `most`.
  [[nodiscard]] std::string read_from(const std::string& name, std::uintmax_t offset,
                                      std::size_t most = kLargestRead) const;
  /// Whether there is a regular file of that name.
  [[nodiscard]] bool has(const std::string& name) const;
  [[nodiscard]] std::uintmax_t size(const std::string& name) const;
  /// Scenario or items, read as the command line reads them before anything is written, arms (arm_edit.hpp) and meshes;
  /// then in one step in the place
  /// of what was there. Throws InputError: with file, line and key for a text that cannot be used; for a log; for a
  /// file that is being written by another. Throws OutputError when writing fails; then what was there stays.
  void write(const std::string& name, std::string_view text) const;
  /// Whether this process may make files in it: not where the disk or the folder can be read only.
  [[nodiscard]] bool can_be_written() const;
  /// As write(), without writing.
  void check(const std::string& name, std::string_view text) const;
  /// Throws InputError where there is no such file.
  void remove(const std::string& name) const;
  /// One line more at the end of what who operates says. Throws InputError where there is no such file.
  void append(const std::string& name, const std::string& line) const;
  /// A file that was not there, open for writing. Throws InputError where something has that name, OutputError where
  /// the folder cannot be written.
  [[nodiscard]] Descriptor create(const std::string& name) const;
  /// As it was given.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Of the folder itself.
  [[nodiscard]] int descriptor() const { return folder_.get(); }

 private:
  std::filesystem::path path_;
  Descriptor folder_;
};

}  // namespace snug::workspace
