// viewer_page: the page that viewer/ builds, carried inside the program.
#include "apps/snug/command_line/viewer_page.hpp"

#include "snug/core/input_error.hpp"

#ifdef SNUG_VIEWER_PAGE
// The assembler copies the file as it is; a byte array in C++ would take seconds to compile.
// NOLINTNEXTLINE(hicpp-no-assembler): there is no other way to embed a file in C++20
asm(".section .rodata\n"
    ".global snug_viewer_page_begin\n"
    ".global snug_viewer_page_end\n"
    "snug_viewer_page_begin:\n"
    ".incbin \"" SNUG_VIEWER_PAGE
    "\"\n"
    "snug_viewer_page_end:\n"
    ".byte 0\n"
    ".text\n");
extern "C" const char snug_viewer_page_begin[];
extern "C" const char snug_viewer_page_end[];
#endif

namespace snug::app {

std::string_view viewer_page() {
#ifdef SNUG_VIEWER_PAGE
  return {snug_viewer_page_begin, snug_viewer_page_end};
#else
  throw InputError("snug", "viewer page", "a program built without it",
                   "one that was configured with SNUG_VIEWER=ON and built with node");
#endif
}

}  // namespace snug::app
