// decide_before: agents that re-arrange, or know the sequence, plan all of it before anything is done.
#pragma once

#include "snug/session/internal/run.hpp"

namespace snug::session::internal {

/// Whether the agent of these options is one of them.
[[nodiscard]] bool decides_before(const SessionOptions& options);

/// Places and order of all items as the agent would have them, into belief and agenda. Throws InputError for an agent
/// that is not known.
void decide_before(Run& run);

}  // namespace snug::session::internal
