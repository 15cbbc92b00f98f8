// Names of scenarios: what comes with snug is found from any folder, and one's own file comes first.
#include "snug/model/scenario_names.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "snug/core/input_error.hpp"
#include "snug/model/scenario.hpp"

namespace snug::model {
namespace {

namespace fs = std::filesystem;

const fs::path kShipped = fs::path(SNUG_SOURCE_DIR) / "scenarios";

/// An empty folder, in which the test stands.
class ScenarioNames : public ::testing::Test {
 protected:
  void SetUp() override {
    before_ = fs::current_path();
    folder_ = fs::path(::testing::TempDir()) / ::testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    fs::current_path(folder_);
  }
  void TearDown() override {
    fs::current_path(before_);
    fs::remove_all(folder_);
  }
  static void write(const char* name, const char* text) { std::ofstream(name) << text; }

 private:
  fs::path before_, folder_;
};

TEST_F(ScenarioNames, ListsScenariosAndNoOtherFiles) {
  const std::vector<std::string> names = list_scenarios(kShipped);
  const auto has = [&](const char* name) { return std::find(names.begin(), names.end(), name) != names.end(); };
  EXPECT_TRUE(has("box-demonstrator") && has("bench/s6a") && has("init/cell"));
  EXPECT_FALSE(has("demo-placements") || has("tosses/task") || has("examples/friction"));
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const std::string& name : names) EXPECT_NO_THROW((void)load_scenario(find_scenario_file(name, kShipped)));
}

TEST_F(ScenarioNames, AreFoundFromAnyFolderInEachSpelling) {
  for (const char* words : {"drop", "drop.yaml", "scenarios/drop.yaml"})
    EXPECT_EQ(find_scenario_file(words, kShipped), kShipped / "drop.yaml") << words;
}

TEST_F(ScenarioNames, FileInTheCurrentFolderComesFirst) {
  write("drop.yaml", "mine");
  EXPECT_EQ(find_scenario_file("drop", kShipped), "drop.yaml");
  write("drop", "mine too");
  EXPECT_EQ(find_scenario_file("drop", kShipped), "drop");
}

TEST_F(ScenarioNames, FolderOfThatNameIsNoFile) {
  fs::create_directory("drop");
  EXPECT_EQ(find_scenario_file("drop", kShipped), kShipped / "drop.yaml");
}

TEST_F(ScenarioNames, UnknownNameIsToldTheNearest) {
  const auto complaint = [](const char* words, const fs::path& folder) {
    try {
      (void)find_scenario_file(words, folder);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(complaint("box-demonstratr", kShipped).find("'box-demonstrator'"), std::string::npos);
  EXPECT_NE(complaint("qqqqqqqqq", kShipped).find(" push slide stack"), std::string::npos);
  EXPECT_NE(complaint("drop", {}).find("none came with"), std::string::npos);
  EXPECT_NE(complaint("drop", "no/such/folder").find("none came with"), std::string::npos);
}

TEST_F(ScenarioNames, MissingPathsAreLeftToTheReader) {
  EXPECT_EQ(find_scenario_file("my/cell.yaml", kShipped), "my/cell.yaml");
  EXPECT_EQ(find_scenario_file("/none/there", kShipped), "/none/there");
}

}  // namespace
}  // namespace snug::model
