// Helpers of the model tests: shipped files, a text with one thing changed, and the complaint it must cause.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/model/scenario.hpp"

namespace snug::model::test {

inline std::filesystem::path project_file(const std::string& relative) {
  return std::filesystem::path(SNUG_SOURCE_DIR) / relative;
}

inline const Scenario& demonstrator() {
  static const Scenario scenario = load_scenario(project_file("scenarios/box-demonstrator.yaml"));
  return scenario;
}

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline std::vector<std::filesystem::path> shipped_scenarios() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(project_file("scenarios")))
    // Placements are lists of boxes, sensors and cups what is measured with, examples and tasks what verbs read.
    if (entry.path().extension() == ".yaml" && !entry.path().stem().string().ends_with("placements") &&
        entry.path().stem() != "task" && entry.path().parent_path().filename() != "examples" &&
        entry.path().parent_path().filename() != "sensors" && entry.path().parent_path().filename() != "cups")
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// `text` with the only occurrence of `from` replaced; a test that would replace nothing or two things fails.
inline std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "no '" << from << "'";
  if (at == std::string::npos) return text;
  EXPECT_EQ(text.find(from, at + 1), std::string::npos) << "'" << from << "' more than once";
  return text.replace(at, from.size(), to);
}

/// 1-based line of the only occurrence of `mark`.
inline int line_of(const std::string& text, std::string_view mark) {
  const std::size_t at = text.find(mark);
  EXPECT_NE(at, std::string::npos) << "no '" << mark << "'";
  return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
}

struct Complaint {
  std::string_view at;        ///< a piece of the line that is blamed
  std::string key;            ///< exact
  std::string_view got;       ///< part of it
  std::string_view expected;  ///< part of it
};

inline void expect_complaint(const std::string& text, const Complaint& complaint) {
  try {
    (void)parse_scenario(text, "test.yaml");
    ADD_FAILURE() << "no complaint about " << complaint.key;
  } catch (const InputError& error) {
    SCOPED_TRACE(error.what());
    EXPECT_EQ(error.where, "test.yaml:" + std::to_string(line_of(text, complaint.at)));
    EXPECT_EQ(error.key, complaint.key);
    EXPECT_NE(error.got.find(complaint.got), std::string::npos);
    EXPECT_NE(error.expected.find(complaint.expected), std::string::npos);
  }
}

}  // namespace snug::model::test
