// Escape: attacked with what names of items may be.
#include "snug/report/escape.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>

#include "snug/core/rng.hpp"
#include "snug/core/text.hpp"

namespace snug::report {
namespace {

/// References undone: what a browser shows of an element's text.
std::string shown(std::string text) {
  const std::array<std::pair<const char*, const char*>, 5> references = {
      {{"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&amp;", "&"}}};
  for (const auto& [reference, character] : references) {
    const std::string word = reference;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
      text.replace(at, word.size(), character);
  }
  return text;
}

TEST(Escape, KeepsPlainTextAndLettersOfEveryScript) {
  for (const char* text : {"", "BOX012", "a b\nc", "Größe 3 µm", "箱", "صندوق", "\U0001F4E6", "x = 3 %"}) {
    EXPECT_EQ(escape(text), text);
  }
}

TEST(Escape, LeavesNothingThatEndsAnElementOrAnAttribute) {
  const std::array attacks = {"</script><script>alert(1)</script>",
                              "\"><img src=x onerror=alert(1)>",
                              "' onload='x",
                              "]]>",
                              "<!--",
                              "--><b>",
                              "<![CDATA[",
                              "&#60;script&#62;",
                              "&lt;b&gt;",
                              "`${x}`",
                              "</title>",
                              "</style>",
                              "</svg>",
                              "<?xml ?>"};
  for (const std::string attack : attacks) {
    SCOPED_TRACE(attack);
    const std::string text = escape(attack);
    EXPECT_EQ(text.find_first_of("<>\"'"), std::string::npos);
    EXPECT_EQ(shown(text), attack) << "and what is read is what was written";
  }
}

TEST(Escape, ShowsWhatCannotBeSeen) {
  EXPECT_EQ(escape("a\u202egnp.exe"), "a\\u202egnp.exe") << "right-to-left override";
  EXPECT_EQ(escape("\u2066x\u2069"), "\\u2066x\\u2069") << "isolates";
  EXPECT_EQ(escape(std::string_view("\0\x01\x1b[31m\x7f", 8)), "\\x00\\x01\\x1b[31m\\x7f") << "XML takes none of these";
  EXPECT_EQ(escape("a\tb\r\nc"), "a b \nc");
  EXPECT_EQ(escape("\xff<\xc0\xaf"), "\\xff&lt;\\xc0\\xaf") << "bytes that are no UTF-8, an overlong slash among them";
  EXPECT_EQ(escape("\u2028"), "\\u2028");
}

TEST(Escape, GivesWholeUtf8WithoutMarkupForAnyBytes) {
  Rng rng = Rng(5).split("escape");
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    std::string bytes;
    const auto size = static_cast<int>(rng.uniform(0.0, 40.0));
    for (int k = 0; k < size; ++k) bytes += static_cast<char>(rng.uniform(0.0, 256.0));
    const std::string text = escape(bytes);
    EXPECT_TRUE(is_utf8(text));
    EXPECT_EQ(text.find_first_of("<>\"'"), std::string::npos);
    for (const char c : text) EXPECT_TRUE(c == '\n' || static_cast<unsigned char>(c) >= 0x20);
    for (std::size_t at = text.find('&'); at != std::string::npos; at = text.find('&', at + 1)) {
      const std::string reference = text.substr(at, text.find(';', at) - at + 1);
      EXPECT_TRUE((std::set<std::string>{"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"}.contains(reference))) << reference;
    }
  }
}

TEST(UrlOfPath, HasNoSchemeAndOneWayBack) {
  EXPECT_EQ(url_of_path("runs/001-margin-1.html"), "runs/001-margin-1.html");
  EXPECT_EQ(url_of_path("javascript:alert(1)"), "javascript%3Aalert%281%29");
  EXPECT_EQ(url_of_path("the runs/a\"b'c?d#e%.html"), "the%20runs/a%22b%27c%3Fd%23e%25.html");
  EXPECT_EQ(url_of_path("ä"), "%C3%A4");
}

}  // namespace
}  // namespace snug::report
