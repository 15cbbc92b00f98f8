// SNUG_CHECK: stops the program on a bug of ours, in every build.
#include "snug/core/check.hpp"

#include <cstdio>
#include <cstdlib>

namespace snug {

void fail_check(const char* condition, const char* file, int line, const char* message) noexcept {
  std::fprintf(stderr, "snug: internal error: %s (%s) at %s:%d\n", message, condition, file, line);
  std::abort();
}

}  // namespace snug
