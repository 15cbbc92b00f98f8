// workspace_page: the page of `snug ui` that viewer/ builds, carried inside the program.
#include "apps/snug/command_line/workspace_page.hpp"

#include "snug/core/input_error.hpp"

#ifdef SNUG_VIEWER_PAGE
// The assembler copies the files as they are; byte arrays in C++ would take seconds to compile.
#define SNUG_EMBED(name, file)      \
  asm(".section .rodata\n"          \
      ".global " name               \
      "_begin\n"                    \
      ".global " name "_end\n" name \
      "_begin:\n"                   \
      ".incbin \"" SNUG_WORKSPACE_FOLDER file "\"\n" name "_end:\n.byte 0\n.text\n")
SNUG_EMBED("snug_workspace_page", "/workspace.html");
SNUG_EMBED("snug_workspace_script", "/workspace.js");
SNUG_EMBED("snug_workspace_style", "/workspace.css");
#undef SNUG_EMBED
extern "C" const char snug_workspace_page_begin[], snug_workspace_page_end[];
extern "C" const char snug_workspace_script_begin[], snug_workspace_script_end[];
extern "C" const char snug_workspace_style_begin[], snug_workspace_style_end[];
#endif

namespace snug::app {

#ifdef SNUG_VIEWER_PAGE
std::string_view workspace_page() { return {snug_workspace_page_begin, snug_workspace_page_end}; }
std::string_view workspace_script() { return {snug_workspace_script_begin, snug_workspace_script_end}; }
std::string_view workspace_style() { return {snug_workspace_style_begin, snug_workspace_style_end}; }
#else
std::string_view workspace_page() {
  throw InputError("snug", "page", "a program built without it",
                   "one that was configured with SNUG_VIEWER=ON and built with node");
}
std::string_view workspace_script() { return workspace_page(); }
std::string_view workspace_style() { return workspace_page(); }
#endif

}  // namespace snug::app
