// StepLines: how many steps somebody allows who types lines.
#pragma once

#include <functional>
#include <string>

namespace snug::served_cell {

/// Lines: an empty one allows a step, a number so many, `c` all there are, `r` resets.
class StepLines {
 public:
  /// `complain`: told of a line that is none of these.
  explicit StepLines(std::function<void(const std::string&)> complain) : complain_(std::move(complain)) {}
  /// Takes what has come on a descriptor: steps that may be done now, -1 for all, also when it has ended, kReset.
  int read(int descriptor);

 private:
  [[nodiscard]] int steps_of(const std::string& line) const;

  std::function<void(const std::string&)> complain_;
  std::string text_;
};

}  // namespace snug::served_cell
