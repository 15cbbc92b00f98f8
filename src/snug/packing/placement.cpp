// NoPlace: words for the reasons.
#include "snug/packing/placement.hpp"

namespace snug::packing {

std::string_view describe(NoPlace reason) {
  switch (reason) {
    case NoPlace::TooBig:
      return "too big for the container";
    case NoPlace::TooHeavy:
      return "too heavy for the robot";
    case NoPlace::NotPickable:
      return "no face that the cup can hold";
    case NoPlace::NoSpace:
      return "no space left";
    case NoPlace::NoStablePlace:
      return "no place where it stands";
    case NoPlace::OverLoad:
      return "only places on boxes that must not carry it";
    case NoPlace::NotReachable:
      return "no place within reach";
    case NoPlace::NotPlanned:
      return "left out of the plan";
  }
  return "no reason";
}

}  // namespace snug::packing
