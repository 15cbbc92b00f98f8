// Failure: words for why runs fail.
#include "snug/cell/failure.hpp"

namespace snug::cell {

const char* name_of(FailureKind kind) {
  switch (kind) {
    case FailureKind::None:
      return "none";
    case FailureKind::TooManyPairs:
      return "too many pairs";
    case FailureKind::NotFinite:
      return "not finite";
    case FailureKind::LostBody:
      return "lost body";
    case FailureKind::ProtectiveStop:
      return "protective stop";
    case FailureKind::TooLong:
      return "too long";
    case FailureKind::ContactDepth:
      return "contact depth";
  }
  return "";
}

}  // namespace snug::cell
