// docs/scenario.md: every key that the reader knows has a row in the table of its mapping.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "scenario_text.hpp"
#include "snug/model/internal/parse.hpp"

namespace snug::model {
namespace {

/// Words in backticks of a line.
std::vector<std::string> code_words(const std::string& line) {
  std::vector<std::string> words;
  for (std::size_t a = line.find('`'); a != std::string::npos;) {
    const std::size_t b = line.find('`', a + 1);
    if (b == std::string::npos) break;
    words.push_back(line.substr(a + 1, b - a - 1));
    a = line.find('`', b + 1);
  }
  return words;
}

/// "kind.key" of each table row whose first cell is a key; kinds are the words in backticks of the heading above.
std::set<std::string> documented_keys() {
  std::istringstream text(test::read_text(test::project_file("docs/scenario.md")));
  std::set<std::string> keys;
  std::vector<std::string> kinds;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("#")) kinds = code_words(line);
    if (!line.starts_with("| `")) continue;
    for (const std::string& key : code_words(line.substr(0, line.find('|', 1))))
      for (const std::string& kind : kinds) keys.insert(kind + "." + key);
  }
  return keys;
}

/// The examples of docs/scenario.md.
std::vector<std::string> examples() {
  const std::string text = test::read_text(test::project_file("docs/scenario.md"));
  std::vector<std::string> found;
  for (std::size_t at = text.find("```yaml\n"); at != std::string::npos; at = text.find("```yaml\n", at + 8)) {
    const std::size_t start = at + 8;
    found.push_back(text.substr(start, text.find("```", start) - start));
  }
  return found;
}

std::set<std::string> known_keys() {
  std::set<std::string> keys;
  for (const auto& file : test::shipped_scenarios())
    (void)internal::parse_text(test::read_text(file), file.string(), &keys);
  for (const std::string& example : examples()) (void)internal::parse_text(example, "docs/scenario.md", &keys);
  return keys;
}

TEST(ScenarioReference, HasARowForEveryKeyTheReaderKnows) {
  const std::set<std::string> documented = documented_keys();
  for (const std::string& key : known_keys()) EXPECT_TRUE(documented.contains(key)) << key;
}

TEST(ScenarioReference, HasNoRowForAKeyTheReaderDoesNotKnow) {
  const std::set<std::string> known = known_keys();
  for (const std::string& key : documented_keys()) EXPECT_TRUE(known.contains(key)) << key;
}

TEST(ScenarioReference, ShowsExamplesThatLoad) {
  EXPECT_GE(examples().size(), 3u);
  for (const std::string& example : examples()) EXPECT_NO_THROW((void)parse_scenario(example, "docs/scenario.md"));
}

}  // namespace
}  // namespace snug::model
