// docs/scenario.md: every key that the reader knows has a row in the table of its mapping.
#include <gtest/gtest.h>

#include <iomanip>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <type_traits>

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

/// "kind.key" of each field with its default as numbers are written; of mappings those of their fields.
class Defaults {
 public:
  template <class Settings>
  static std::map<std::string, std::string> of(const std::string& kind) {
    Defaults defaults;
    Settings settings;
    defaults.kind_ = kind;
    settings.fields(defaults);
    return defaults.texts_;
  }

  template <class... Any>
  void operator()(const char* key, double& value, Any&&...) {
    note(key, value);
  }
  template <class... Any>
  void operator()(const char* key, int& value, Any&&...) {
    note(key, value);
  }
  template <class... Any>
  void operator()(const char* key, Degrees value, Any&&...) {
    note(key, value.radians * 180.0 / std::numbers::pi);
  }
  void operator()(const char* key, bool& value) { texts_[kind_ + "." + key] = value ? "true" : "false"; }
  template <class Settings>
  requires std::is_class_v<Settings>
  void operator()(const char* key, Settings& /*settings*/) {
    const std::map<std::string, std::string> own = of<Settings>(key);
    texts_.insert(own.begin(), own.end());
  }

 private:
  void note(const char* key, double value) {
    std::ostringstream text;
    text << std::setprecision(10) << value;
    texts_[kind_ + "." + key] = text.str();
  }
  std::string kind_;
  std::map<std::string, std::string> texts_;
};

/// The third cell of each row of documented_keys().
std::map<std::string, std::string> documented_defaults() {
  std::istringstream text(test::read_text(test::project_file("docs/scenario.md")));
  std::map<std::string, std::string> defaults;
  std::vector<std::string> kinds;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("#")) kinds = code_words(line);
    if (!line.starts_with("| `")) continue;
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, '|');) cells.push_back(cell);
    if (cells.size() < 4) continue;
    const std::string value = cells[3].substr(1, cells[3].size() - 2);
    for (const std::string& key : code_words(cells[1]))
      for (const std::string& kind : kinds) defaults[kind + "." + key] = value;
  }
  return defaults;
}

TEST(ScenarioReference, SaysTheDefaultsByWhichBoxesArePacked) {
  const std::map<std::string, std::string> documented = documented_defaults();
  const auto expect_documented = [&](const std::map<std::string, std::string>& defaults) {
    EXPECT_FALSE(defaults.empty());
    for (const auto& [key, value] : defaults) {
      const auto found = documented.find(key);
      EXPECT_EQ(found != documented.end() ? found->second : "no row", value) << key;
    }
  };
  expect_documented(Defaults::of<settings::SkillParams>("skills"));
  expect_documented(Defaults::of<settings::PackingSettings>("packing"));
  expect_documented(Defaults::of<settings::PlaceLimits>("place_limits"));
  expect_documented(Defaults::of<settings::RehearsalSettings>("rehearsal"));
  expect_documented(Defaults::of<settings::BeliefParams>("belief"));
  expect_documented(Defaults::of<settings::RecoverySettings>("recovery"));
  expect_documented(Defaults::of<settings::MotionGuards>("motion_guards"));
}

TEST(ScenarioReference, ShowsExamplesThatLoad) {
  EXPECT_GE(examples().size(), 3u);
  for (const std::string& example : examples()) EXPECT_NO_THROW((void)parse_scenario(example, "docs/scenario.md"));
}

}  // namespace
}  // namespace snug::model
