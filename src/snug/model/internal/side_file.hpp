// Side files: what a scenario names beside itself, with a bound on how much of it is read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "snug/model/internal/value.hpp"

namespace snug::model::internal {

/// The path that a value names, relative to the folder of the scenario.
[[nodiscard]] std::filesystem::path beside_scenario(const Value& value);
/// The same. Fails at the value when there is none.
[[nodiscard]] std::filesystem::path find_side_file(const Value& value, const std::string& what);
/// Fails when the file is no regular one or larger than `most` bytes.
void check_side_file(const std::filesystem::path& file, std::size_t most, const std::string& what);
/// All of it, at most `most` bytes.
[[nodiscard]] std::string read_side_file(const std::filesystem::path& file, std::size_t most, const std::string& what);

}  // namespace snug::model::internal
