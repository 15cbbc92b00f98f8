// RunResult: figures of what became of a run.
#include "snug/runs/result.hpp"

#include <algorithm>

namespace snug::runs {

using cell::Repick;

RepickOffsets summarize(const std::vector<Repick>& repicks) {
  RepickOffsets offsets;
  for (const Repick& repick : repicks) {
    offsets.mean += repick.offset / static_cast<double>(repicks.size());
    offsets.worst = std::max(offsets.worst, repick.offset);
  }
  return offsets;
}

}  // namespace snug::runs
