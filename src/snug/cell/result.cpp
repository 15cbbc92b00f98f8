// RunResult: figures of what became of a run.
#include "snug/cell/result.hpp"

#include <algorithm>

namespace snug::cell {

RepickOffsets summarize(const std::vector<Repick>& repicks) {
  RepickOffsets offsets;
  for (const Repick& repick : repicks) {
    offsets.mean += repick.offset / static_cast<double>(repicks.size());
    offsets.worst = std::max(offsets.worst, repick.offset);
  }
  return offsets;
}

}  // namespace snug::cell
