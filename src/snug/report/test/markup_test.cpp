// Markup and tables: well-formed whatever they are made of; written by this module alone.
#include "snug/report/markup.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <regex>

#include "snug/core/read_file.hpp"
#include "snug/report/table.hpp"
#include "snug/report/test/sound.hpp"

namespace snug::report {
namespace {

constexpr const char* kAttack = "</td><script>'\"&";

TEST(Markup, EveryPieceIsWholeAndEscapesTheTextInIt) {
  const std::vector<Markup> pieces = {
      heading(2, kAttack),
      paragraph(kAttack),
      bold(kAttack),
      small(kAttack),
      code(kAttack),
      preformatted(kAttack),
      link(kAttack, kAttack),
      details(kAttack, kAttack),
      section(kAttack),
      figure(kAttack, kAttack),
      picture(kAttack, "<svg></svg>"),
      side_by_side({kAttack, kAttack}),
      cards({kAttack}),
      key_figures({{kAttack, kAttack, kAttack}}),
      number(1.5, 2),
      as_markup(Table{{{kAttack, true}, {kAttack}}, {{kAttack, kAttack}, {kAttack}}, {}})};
  for (const Markup& piece : pieces) {
    SCOPED_TRACE(piece.html());
    EXPECT_EQ(piece.html().find("<script"), std::string::npos);
    expect_well_formed(piece.html());
  }
}

TEST(Markup, IsPutTogetherWithoutBeingEscapedAgain) {
  const Markup both = bold("a") + " < " + small("b");
  EXPECT_EQ(both.html(), "<b>a</b> &lt; <small>b</small>");
  EXPECT_TRUE(Markup().is_empty());
  EXPECT_EQ(paragraph(both).html(), "<p><b>a</b> &lt; <small>b</small></p>\n");
}

TEST(Number, HasItsDecimalsItsDeviationOrIsNotAvailable) {
  const double none = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(number(4.306, 2).html(), "4.31");
  EXPECT_EQ(number(4.306, 0.1234, 2).html(), "4.31 <small>± 0.12</small>");
  EXPECT_EQ(number(4.306, none, 1).html(), "4.3");
  EXPECT_EQ(number(none, 1), not_available());
  EXPECT_EQ(number(std::numeric_limits<double>::infinity(), 1), not_available());
}

TEST(Table, ShortRowsSpanWhatIsLeft) {
  const Table table{{{"a", true}, {"b"}, {"c"}}, {{"1", "2", "3"}, {"x", "not found"}}, {"mean"}};
  const std::string html = as_markup(table).html();
  EXPECT_EQ(count(html, "colspan=\"2\""), 1);
  EXPECT_EQ(count(html, "colspan=\"3\""), 1) << "the foot";
  EXPECT_EQ(count(html, "<tr>"), 4);
  EXPECT_EQ(count(html, "<th "), 3);
  EXPECT_TRUE(as_markup(Table{}).is_empty());
}

TEST(TableDeathTest, RefusesMoreCellsThanColumns) {
  EXPECT_DEATH((void)as_markup(Table{{{"a"}}, {{"1", "2"}}, {}}), "a cell for each column");
}

/// Files of C++ outside this module, without tests.
std::vector<std::filesystem::path> other_sources() {
  namespace fs = std::filesystem;
  std::vector<fs::path> files;
  const fs::path root = SNUG_SOURCE_DIR;
  for (const fs::path& folder : {root / "src", root / "apps", root / "python" / "src"}) {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
      const std::string path = entry.path().generic_string();
      const bool is_source = path.ends_with(".cpp") || path.ends_with(".hpp");
      const bool is_other = path.find("/snug/report/") == std::string::npos && path.find("/test/") == std::string::npos;
      if (is_source && is_other) files.push_back(entry.path());
    }
  }
  return files;
}

TEST(Markup, IsWrittenByThisModuleAlone) {
  const std::regex tag(
      "\"[^\"\n]*</?(a|b|p|br|td|th|tr|table|div|span|h[1-6]|pre|code|html|head|svg|circle|polygon|figure|small)[ >/]");
  const std::vector<std::filesystem::path> files = other_sources();
  ASSERT_GT(files.size(), 500u);
  for (const std::filesystem::path& file : files) {
    const std::string text = read_file(file, "a source");
    std::smatch found;
    EXPECT_FALSE(std::regex_search(text, found, tag)) << file << ": " << found.str();
  }
}

}  // namespace
}  // namespace snug::report
