// Recording: what a simulation leaves behind: where everything was, what touched what, and what happened.
#include "snug/record/recording.hpp"

namespace snug::record {

int find_body(const RecordingHeader& header, std::string_view name) {
  for (std::size_t i = 0; i < header.bodies.size(); ++i)
    if (header.bodies[i].name == name) return static_cast<int>(i);
  return -1;
}

}  // namespace snug::record
