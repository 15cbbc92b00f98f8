// Tests of tables: columns in any order, every complaint with line and column.
#include "snug/core/table.hpp"

#include <gtest/gtest.h>

#include "snug/core/csv_fields.hpp"
#include "snug/core/input_error.hpp"

namespace snug {
namespace {

template <class Work>
void expect_refused(const Work& work, const std::string& part) {
  try {
    work();
    ADD_FAILURE() << "taken, expected: " << part;
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Table, ReadsColumnsInAnyOrderAndRefusesWhatIsBroken) {
  const Table table = parse_table("# touches\n\nb, c,a\n1,2,3\n+4,5e-1,6\n", "t.csv", {"a", "b"});
  EXPECT_EQ(table.rows, (std::vector<std::vector<double>>{{3, 1}, {6, 4}}));
  EXPECT_EQ(table.where(1), "t.csv:5");
  const Table quoted = parse_table("\xEF\xBB\xBF\"a\",note\n\"1\",\"x, y\"\n", "t.csv", {"a"});
  EXPECT_EQ(quoted.rows, (std::vector<std::vector<double>>{{1}})) << "as spreadsheets write it";
  expect_refused([] { (void)parse_table("a;b\n1;2\n", "t.csv", {"a"}); }, "t.csv:1: got semicolons");
  expect_refused([] { (void)parse_table("a,b\n\"1,2\n", "t.csv", {"a"}); }, "t.csv:2: got a quote");
  const std::string commas(kMostCsvFields, ',');
  expect_refused([&] { (void)parse_table(commas, "t.csv", {"a"}); }, "t.csv:1: got more than 10000 fields");
  expect_refused([&] { (void)parse_table("a\n" + commas, "t.csv", {"a"}); }, "t.csv:2: got more than 10000 fields");
  expect_refused([] { (void)parse_table("", "t.csv", {"a"}); }, "no header");
  expect_refused([] { (void)parse_table("a,b\n1,2\n", "t.csv", {"a", "c"}); }, "column 'c'");
  expect_refused([] { (void)parse_table("a,a\n1,2\n", "t.csv", {"a"}); }, "twice");
  expect_refused([] { (void)parse_table("a,b\n1\n", "t.csv", {"a"}); }, "t.csv:2");
  for (const char* cell : {"", "nan", "inf", "1e300", "1mm", "--1"})
    expect_refused([&] { (void)parse_table(std::string("a,b\n") + cell + ",1\n", "t.csv", {"a"}); }, "t.csv:2: a");
}

}  // namespace
}  // namespace snug
