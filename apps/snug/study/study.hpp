// run_row: a row of a study is a verb of this program.
#pragma once

#include <string>
#include <vector>

namespace snug::app {

/// The verb of a row: does the words behind `snug`, with `threads` where they do not say, and returns the exit code.
[[nodiscard]] int run_row(const std::vector<std::string>& words, int threads = 1);

}  // namespace snug::app
