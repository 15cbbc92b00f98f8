// TemporaryFolder: a folder of this process alone, gone with the object.
#pragma once

#include <filesystem>

namespace snug {

class TemporaryFolder {
 public:
  /// In the system's place for such (TMPDIR): `name` and six characters. Throws InputError where none can be made.
  explicit TemporaryFolder(const char* name);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// What cannot be removed stays.
  void empty() const;

 private:
  std::filesystem::path path_;
};

}  // namespace snug
