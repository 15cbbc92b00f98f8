// Programs (CSV): what was read is written and read again. Rotations come back within the rounding of logarithm and
// exponential (a few units of 2^-53, of an angle up to pi); all else comes back to the last bit.
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
      const motion::Waypoint& a = program.waypoints[i];
      motion::Waypoint read = again.waypoints[i];
      SNUG_CHECK((a.X_WE.R - read.X_WE.R).cwiseAbs().maxCoeff() <= 32 * 0x1p-53, "the same rotations");
      read.X_WE.R = a.X_WE.R;
      read.line = a.line;  // comments and blank lines are not written
      SNUG_CHECK(a == read, "the same rows");
    }
  });
  return 0;
}
