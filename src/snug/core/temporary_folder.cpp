// TemporaryFolder: made by mkdtemp, so that it is nobody else's.
#include "snug/core/temporary_folder.hpp"

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include "snug/core/input_error.hpp"

namespace snug {

namespace fs = std::filesystem;

TemporaryFolder::TemporaryFolder(const char* name) {
  std::string pattern = (fs::temp_directory_path() / name).string() + "-XXXXXX";
  if (::mkdtemp(pattern.data()) == nullptr)
    throw InputError(pattern, "", std::strerror(errno), "a folder for temporary files (environment variable TMPDIR)");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void TemporaryFolder::empty() const {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(path_, ignored)) fs::remove_all(entry.path(), ignored);
}

}  // namespace snug
