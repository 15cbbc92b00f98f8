// Verdicts on parameters.
#include "snug/identification/parameter.hpp"

namespace snug::identification {

const char* name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::Identified:
      return "identified";
    case Verdict::Weak:
      return "weak";
    case Verdict::NotIdentifiable:
      return "not identifiable";
  }
  return "";
}

Verdict judge(double standard_error, double scale) {
  constexpr double kIdentified = 0.05, kWeak = 0.25;
  if (standard_error < kIdentified * scale) return Verdict::Identified;
  return standard_error < kWeak * scale ? Verdict::Weak : Verdict::NotIdentifiable;
}

}  // namespace snug::identification
