// RestWatch: whether boxes have come to rest: a moment at which all are slow is none, one that rocks turns back there.
#pragma once

#include "snug/cell/simulation.hpp"

namespace snug::cell {

class RestWatch {
 public:
  /// At rest, until `follow` sees a box move.
  explicit RestWatch(double now);
  /// After each tick.
  void follow(const Simulation& simulation, const CellState& state);
  /// No box has moved for a tenth of a second.
  [[nodiscard]] bool is_at_rest(double now) const;

 private:
  double last_motion_;  ///< s
};

}  // namespace snug::cell
