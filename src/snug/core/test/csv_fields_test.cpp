// Tests of the fields of a CSV: quotes as spreadsheets write them, and what is refused.
#include "snug/core/csv_fields.hpp"

#include <gtest/gtest.h>

#include "snug/core/input_error.hpp"
#include "snug/core/test/peak_memory.hpp"

namespace snug {
namespace {

using Fields = std::vector<std::string>;

TEST(SplitCsv, TakesBlanksOffAndReadsQuotedFields) {
  EXPECT_EQ(split_csv("", "f:1"), Fields{""});
  EXPECT_EQ(split_csv("a, b ,\tc\r", "f:1"), (Fields{"a", "b", "c"}));
  EXPECT_EQ(split_csv("a,,", "f:1"), (Fields{"a", "", ""}));
  EXPECT_EQ(split_csv("\"a, b\",c", "f:1"), (Fields{"a, b", "c"}));
  EXPECT_EQ(split_csv(" \"5\"\" box\" , \"\",\" c \"\r", "f:1"), (Fields{"5\" box", "", " c "}));
  EXPECT_EQ(split_csv("5\" box,c", "f:1"), (Fields{"5\" box", "c"})) << "a quote inside a plain field is a character";
}

TEST(SplitCsv, RefusesQuotesThatAreNotClosedAndTextBehindThem) {
  for (const char* line : {"\"a", "a,\"", "\"a\"\"", "\"a,b\nc", "\"a\" b,c", "\"a\"b\""}) {
    EXPECT_THROW((void)split_csv(line, "f:3"), InputError) << line;
  }
  try {
    (void)split_csv("x,\"a", "f:3");
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "f:3: got a quote that is not closed: \"a; expected a quote at the field's end, too");
  }
}

TEST(SplitCsv, RefusesALineWithTooManyFieldsAndNamesTheLimit) {
  EXPECT_EQ(split_csv(std::string(kMostCsvFields - 1, ','), "f:1").size(), kMostCsvFields);
  try {
    (void)split_csv(std::string(kMostCsvFields, ','), "f:7");
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "f:7: got more than 10000 fields; expected 10000 fields or fewer");
  }
  const auto peak =
      test::peak_memory([] { EXPECT_THROW((void)split_csv(std::string(5'000'000, ','), "f:1"), InputError); });
  ASSERT_TRUE(peak.has_value());
  EXPECT_LT(*peak, std::size_t{20'000'000});
}

TEST(RefuseSemicolons, RefusesAHeaderThatHasNothingElse) {
  EXPECT_THROW(refuse_semicolons("a;b", "f:1"), InputError);
  EXPECT_NO_THROW(refuse_semicolons("a,b;c", "f:1"));
  EXPECT_NO_THROW(refuse_semicolons("a", "f:1"));
}

TEST(WithoutByteOrderMark, TakesOneMarkOffTheBeginning) {
  EXPECT_EQ(without_byte_order_mark("\xEF\xBB\xBF"
                                    "a"),
            "a");
  EXPECT_EQ(without_byte_order_mark("\xEF\xBB"), "\xEF\xBB");
  EXPECT_EQ(without_byte_order_mark(""), "");
}

}  // namespace
}  // namespace snug
