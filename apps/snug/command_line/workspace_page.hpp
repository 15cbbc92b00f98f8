// workspace_page: the page of `snug ui` that viewer/ builds, carried inside the program.
#pragma once

#include <string_view>

namespace snug::app {

/// HTML, script and style. Each throws InputError when this program was built without them (SNUG_VIEWER=OFF).
[[nodiscard]] std::string_view workspace_page();
[[nodiscard]] std::string_view workspace_script();
[[nodiscard]] std::string_view workspace_style();

}  // namespace snug::app
