// Faults: what the words say, and what is refused.
#include "snug/simulated_plant/faults.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"

namespace snug::simulated_plant {
namespace {

TEST(Faults, AreReadInTheOrderWritten) {
  const std::vector<Fault> expected{{FaultKind::Drop, 3},
                                    {FaultKind::NoSeal, 5},
                                    {FaultKind::Displace, 7},
                                    {FaultKind::Stop, 9},
                                    {FaultKind::Push, 11}};
  EXPECT_EQ(parse_faults("drop@3,noseal@5,displace@7,stop@9,push@11"), expected);
  EXPECT_EQ(parse_faults("object@3,clear@6"), (std::vector<Fault>{{FaultKind::Object, 3}, {FaultKind::Clear, 6}}));
  EXPECT_TRUE(parse_faults("").empty());
}

TEST(Faults, OthersAreRefused) {
  for (const char* text : {"drop", "drop@", "drop@0", "drop@-1", "drop@3x", "fall@3", "drop@3,", ",drop@3",
                           "drop@3,,stop@4", "drop@1e3", "drop@99999999999", "drop@3 ", " drop@3", "drop@3;stop@4"}) {
    EXPECT_THROW((void)parse_faults(text), InputError) << text;
  }
}

}  // namespace
}  // namespace snug::simulated_plant
