// What the tests of this module share: reference data, the truth behind it, and complaints that must name a place.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "snug/core/input_error.hpp"
#include "snug/model/cup_params.hpp"

namespace snug::identification::test {

inline std::filesystem::path data_path(const std::string& name) {
  return std::filesystem::path(SNUG_SOURCE_DIR) / ".." / "shared" / "data" / "cup" / name;
}

/// The file's content, or null where the reference data is not installed: the test skips then.
inline nlohmann::json load_data(const std::string& name) {
  std::ifstream file(data_path(name));
  return file ? nlohmann::json::parse(file) : nlohmann::json();
}

/// The cup of the reference poses (README of the data).
inline constexpr model::CupElasticity kTruth{2300.0, 5500.0, 5.5, 2.8, -20.0};
inline constexpr double kTrueNumbers[5] = {2300.0, 5500.0, 5.5, 2.8, -20.0};

inline void expect_refused(const std::function<void()>& work, const std::string& part) {
  try {
    work();
    ADD_FAILURE() << "accepted; expected a complaint with '" << part << "'";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

}  // namespace snug::identification::test

#define SNUG_SKIP_WITHOUT(data, name) \
  if ((data).is_null()) GTEST_SKIP() << "reference data not found: " << test::data_path(name)
