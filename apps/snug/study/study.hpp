// study: many runs of a verb over a design, on this machine's cores or as jobs of a cluster.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

/// The words of `snug study`.
struct StudyOptions {
  std::string file;
  std::optional<std::string> dir;  ///< absent: the file's name with the ending .study, in the folder one is in
  std::optional<int> threads;      ///< absent: all cores
  std::optional<std::string> chunks;
  bool slurm = false;
  bool dry_run = false;
  bool json = false;
  std::optional<std::string> output;
  int worst = 10;
};

/// The verb of a row: does the words behind `snug`, with `threads` where they do not say, and returns the exit code.
[[nodiscard]] int run_row(const std::vector<std::string>& words, int threads = 1);

void add_study(CLI::App& app, Action& action);
/// Each throws InputError for input that cannot be used.
[[nodiscard]] int run_study(const StudyOptions& options);
[[nodiscard]] int run_study_status(const StudyOptions& options);
[[nodiscard]] int run_study_merge(const StudyOptions& options);
[[nodiscard]] int run_study_report(const StudyOptions& options);

}  // namespace snug::app
