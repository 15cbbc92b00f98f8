// serve --ur: the cell as a controller of Universal Robots that any of its clients drives.
#pragma once

#include "apps/snug/serve/serve.hpp"
#include "snug/ur/robot_data.hpp"

namespace snug::app {

/// One of those that --model offers.
[[nodiscard]] ur::Model ur_model_of(const std::string& name);
/// Serves until Ctrl-C, until a client shuts the controller down, or with `once` until the first run is over.
[[nodiscard]] int run_serve_ur(const ServeOptions& options);

}  // namespace snug::app
