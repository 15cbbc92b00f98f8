// viewer_page: the page that viewer/ builds, carried inside the program.
#pragma once

#include <string_view>

namespace snug::app {

/// The whole page. Throws InputError when this program was built without it (SNUG_VIEWER=OFF).
[[nodiscard]] std::string_view viewer_page();

}  // namespace snug::app
