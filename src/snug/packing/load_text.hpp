// Loads as text: a table for people, JSON for programs.
#pragma once

#include <string>
#include <vector>

#include "snug/packing/loading.hpp"

namespace snug::packing {

struct SolvedLoad {
  LoadProblem problem;
  LoadResult result;
};

/// A line each and the mean. At least one load.
[[nodiscard]] std::string format_load_table(const std::vector<SolvedLoad>& loads);
/// `time`: s, that each was given.
[[nodiscard]] std::string format_load_json(const std::vector<SolvedLoad>& loads, double time);

}  // namespace snug::packing
