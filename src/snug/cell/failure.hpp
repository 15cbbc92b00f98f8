// Failure: why a run could not go on, or failed though it went on to its end.
#pragma once

#include <string>

namespace snug::cell {

enum class FailureKind {
  None,
  TooManyPairs,    ///< more pairs of bodies near each other than there is room for
  NotFinite,       ///< the state is not a number any more
  LostBody,        ///< a body that must not leave the cell did
  ProtectiveStop,  ///< of the robot: RunResult::stop
  TooLong,         ///< the program did not end
  ContactDepth,    ///< bodies too deep in each other; the run went on to its end
};
[[nodiscard]] const char* name_of(FailureKind kind);

struct Failure {
  FailureKind kind = FailureKind::None;
  std::string text;  ///< for people: body, time, last contacts
  [[nodiscard]] explicit operator bool() const { return kind != FailureKind::None; }
  bool operator==(const Failure&) const = default;
};

}  // namespace snug::cell
