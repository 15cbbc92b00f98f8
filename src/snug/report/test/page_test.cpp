// The frame of pages, and pages that hold recordings.
#include "snug/report/page.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/report/recordings_page.hpp"
#include "snug/report/test/sound.hpp"

namespace snug::report {
namespace {

template <class Work>
std::string complaint(const Work& work) {
  try {
    work();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MakePage, IsOneFileWithoutScriptsOrAnythingToLoad) {
  const std::string page = make_page("</title><script>", paragraph("text"));
  EXPECT_TRUE(page.starts_with("<!doctype html>\n<html lang=\"en\">"));
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=[\"']?(https?:|//)|url\\(|@import")));
  EXPECT_NE(page.find("name=\"viewport\""), std::string::npos);
  EXPECT_NE(page.find("prefers-color-scheme: dark"), std::string::npos);
  EXPECT_NE(page.find("@media print"), std::string::npos);
  EXPECT_EQ(count(page, "&lt;/title&gt;&lt;script&gt;"), 2) << "title and heading";
}

/// Values of --names in a rule of a style sheet.
std::map<std::string, std::string> inks_of(const std::string& css, const std::string& rule) {
  const std::size_t begin = css.find('{', css.find(rule)), end = css.find('}', begin);
  std::map<std::string, std::string> inks;
  const std::string body = css.substr(begin, end - begin);
  const std::regex ink("--([a-z-]+): (#[0-9a-f]+);");
  for (std::sregex_iterator at(body.begin(), body.end(), ink), last; at != last; ++at) inks[(*at)[1]] = (*at)[2];
  return inks;
}

TEST(MakePage, HasTheInksOfThePageThatReplaysRecordings) {
  const std::string viewer = read_file(std::string(SNUG_SOURCE_DIR) + "/viewer/src/ui/style.css", "a style sheet");
  const std::string page = make_page("t", {});
  const auto light = inks_of(viewer, ":root"), dark = inks_of(viewer, ":root[data-theme=\"dark\"]");
  ASSERT_EQ(light.size(), 7u);
  for (const auto& [name, value] : light) EXPECT_EQ(inks_of(page, ":root {")[name], value) << name;
  const std::string night = page.substr(page.find("prefers-color-scheme: dark"));
  for (const auto& [name, value] : dark) EXPECT_EQ(inks_of(night, ":root {")[name], value) << name;
}

TEST(Page, PutsRecordingsInThePlaceOfTheMark) {
  const std::string page = "<html>\n<!--snug:recordings-->\n</html>\n";
  const PageRecording recordings[] = {{"a\"<b>&.h5", "abc"}, {"c.h5", std::string("\0\xff", 2)}};
  EXPECT_EQ(assemble_page(page, recordings),
            "<html>\n<script type=\"application/octet-stream;base64\" id=\"snug-recording-0\" "
            "data-name=\"a&quot;&lt;b&gt;&amp;.h5\">YWJj</script>\n<script type=\"application/octet-stream;base64\" "
            "id=\"snug-recording-1\" data-name=\"c.h5\">AP8=</script>\n\n</html>\n");
  EXPECT_NE(complaint([] { (void)assemble_page("<html></html>", {}); }), "");
  EXPECT_NE(complaint([&] { (void)assemble_page(page + page, {}); }), "");
}

}  // namespace
}  // namespace snug::report
