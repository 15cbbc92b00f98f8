// view --live --click: a cell that another program serves, in the browser while it is driven.
#pragma once

#include "apps/snug/view/view.hpp"

namespace snug::app {

/// Serves the page until the program is told to stop (Ctrl-C).
[[nodiscard]] int view_served(const ViewOptions& options);

}  // namespace snug::app
