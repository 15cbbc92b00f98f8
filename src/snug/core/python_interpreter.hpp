// python_interpreter: the Python that programs of ours are run by.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace snug {

/// SNUG_PYTHON, else /usr/bin/python3, whose modules Debian's packages bring, else what the search path has.
[[nodiscard]] inline std::string python_interpreter() {
  if (const char* asked = std::getenv("SNUG_PYTHON"); asked != nullptr && *asked != '\0') return asked;
  return ::access("/usr/bin/python3", X_OK) == 0 ? "/usr/bin/python3" : "python3";
}

}  // namespace snug
