// Faults: what goes wrong in a simulated plant because somebody asked for it: "drop@3,noseal@5".
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace snug::simulated_plant {

enum class FaultKind {
  NoSeal,    ///< the first pick of the item does not seal
  Drop,      ///< the item falls from the cup while it is carried
  Stop,      ///< the robot stops for protection while it carries the item
  Displace,  ///< the item, let go in the container, is moved 30 mm away, on top of others where they are in the way
  Push,      ///< the same with the packed box that is nearest to it
  Object,    ///< once the item, or the next that is, is let go in the container, something foreign is put in there
  Clear,     ///< at that time, foreign objects are taken out again
};
[[nodiscard]] const char* name_of(FaultKind kind);

struct Fault {
  FaultKind kind = FaultKind::NoSeal;
  int item = 1;  ///< number of the item among those that the plant brings, from 1
  bool operator==(const Fault&) const = default;
};

/// "KIND@N" separated by commas; empty text: none. Throws InputError for anything else, naming the nearest kind.
[[nodiscard]] std::vector<Fault> parse_faults(std::string_view text);

}  // namespace snug::simulated_plant
