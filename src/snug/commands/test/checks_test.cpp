// Checks of words: what is taken, and what the message says of what is not.
#include "snug/commands/checks.hpp"

#include <gtest/gtest.h>

namespace snug::commands {
namespace {

TEST(OneOf, NamesTheWordsAndTheNearest) {
  const Check check = one_of({"lagged", "fast"});
  EXPECT_EQ(check("fast"), "");
  EXPECT_EQ(check("fats"), "got 'fats'; expected one of lagged, fast; did you mean fast?");
  EXPECT_EQ(check("quite another"), "got 'quite another'; expected one of lagged, fast");
  EXPECT_EQ(one_of({"margin"}, "module:Class")("mine:Agent"), "");
  EXPECT_EQ(one_of({"margin"}, "module:Class")("mine"), "got 'mine'; expected one of margin, or module:Class");
}

TEST(OneOf, ItsNameHasTheWords) {
  EXPECT_EQ(choices_in(one_of({"a", "b"}).name), (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(choices_in(positive().name), std::vector<std::string>());
}

TEST(Numbers, AreWholeWordsAndFinite) {
  EXPECT_EQ(positive()("1e-3"), "");
  for (const char* word : {"0", "-1", "inf", "nan", "1x", "", " 1", "0x10"}) EXPECT_NE(positive()(word), "") << word;
  EXPECT_EQ(finite()("-2.5"), "");
  EXPECT_EQ(finite()("+2.5"), "");
  for (const char* word : {"inf", "-inf", "nan", "++1", "1e999"}) EXPECT_NE(finite()(word), "") << word;
}

TEST(Numbers, HaveBounds) {
  EXPECT_EQ(whole(1)("18446744073709551615"), "");
  EXPECT_EQ(whole(1)("18446744073709551616"),
            "got '18446744073709551616'; expected a whole number, 1 or more, below 2^64");
  EXPECT_EQ(whole(1, 4)("4"), "");
  EXPECT_EQ(whole(1, 4)("5"), "got '5'; expected a whole number from 1 to 4");
  EXPECT_EQ(whole(0, 4)("-1"), "got '-1'; expected a whole number from 0 to 4");
  EXPECT_EQ(within(0.5, 1.0)("1"), "");
  EXPECT_EQ(within(0.5, 1.0)("0.4"), "got '0.4'; expected a number from 0.5 to 1");
  EXPECT_NE(within(0.5, 1.0)("nan"), "");
}

}  // namespace
}  // namespace snug::commands
