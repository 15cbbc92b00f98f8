// share_out: independent jobs on a few threads, each writing to its own slot.
#pragma once

#include <functional>

namespace snug::packing::internal {

/// Calls job(index, thread) for index 0 .. count-1; thread is below max(1, threads) and never used twice at a time.
void share_out(int count, int threads, const std::function<void(int, int)>& job);

}  // namespace snug::packing::internal
