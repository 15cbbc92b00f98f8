// Programs (CSV): what was read is written and read again.
#include "fuzz.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace snug;
  fuzz::expect_answer([&] {
    const motion::Program program = motion::parse_program(fuzz::text_of(data, size), "x.csv");
    const motion::Program again = motion::parse_program(motion::format_program(program), "x.csv");
    SNUG_CHECK(again.waypoints.size() == program.waypoints.size(), "as many rows");
    for (std::size_t i = 0; i < again.waypoints.size(); ++i) {
      const motion::Waypoint &a = program.waypoints[i], &b = again.waypoints[i];
      motion::Waypoint read = b;
      read.line = a.line;  // comments and blank lines are not written
      SNUG_CHECK(a == read, "the same rows");
    }
  });
  return 0;
}
