// GridFile: pictures and texts in an HDF5 file that others may have made; nothing that it says of itself is believed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace snug::record {

/// All functions throw InputError, with path and name, for what is not there, damaged, kept in another file, or more
/// than a file of this size can hold.
class GridFile {
 public:
  explicit GridFile(const std::filesystem::path& path);
  ~GridFile();
  GridFile(const GridFile&) = delete;
  GridFile& operator=(const GridFile&) = delete;

  struct Size {
    int rows = 0, cols = 0;
  };
  [[nodiscard]] bool has(const char* name) const;
  /// A dataset of numbers with two dimensions of 1 to `most` each, row by row.
  [[nodiscard]] Size read(const char* name, int most, std::vector<float>& values) const;
  [[nodiscard]] Size read(const char* name, int most, std::vector<std::uint8_t>& values) const;
  /// A text of the file itself (attribute), UTF-8.
  [[nodiscard]] std::string read_text(const char* name) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::record
