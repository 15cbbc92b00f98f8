// Feeder: brings the boxes of the sequence to the aligner, one after the other, for controllers that do not.
#pragma once

#include "snug/cell/simulation.hpp"

namespace snug::served_cell {

/// The next item of the sequence comes when the one before has been taken, and nothing (tool, another box) is where it
/// would stand.
class Feeder {
 public:
  /// The item that may come now, or -1.
  [[nodiscard]] int next(const cell::Simulation& simulation, const cell::CellState& state) const;
  /// The item that comes next, whatever stands there, or -1.
  [[nodiscard]] int coming(const cell::Simulation& simulation) const;
  /// The item that came last is over the container, or not in the cell any more; true before the first.
  [[nodiscard]] bool is_last_placed(const cell::Simulation& simulation, const cell::CellState& state) const;
  /// It came.
  void advance() { ++next_; }

 private:
  int next_ = 0;
};

}  // namespace snug::served_cell
