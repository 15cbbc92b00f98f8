// archive: what is in archives of measurements, whether they are whole, and archives from parts.
#pragma once

#include <string>
#include <vector>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct ArchiveListOptions {
  std::string archive;
  bool json = false;
};
struct ArchiveConvertOptions {
  std::string input;
  std::string output;  ///< a folder for an archive's tables, a .h5 for a log
  std::string name;    ///< of the recording a log becomes; the log's own unless given
  std::string note, sequence;
};
struct ArchiveMergeOptions {
  std::vector<std::string> archives;
  std::string output;
};

void add_archive(CLI::App& app, Action& action);
[[nodiscard]] int run_archive_list(const ArchiveListOptions& options);
[[nodiscard]] int run_archive_check(const ArchiveListOptions& options);
[[nodiscard]] int run_archive_convert(const ArchiveConvertOptions& options);
[[nodiscard]] int run_archive_merge(const ArchiveMergeOptions& options);

}  // namespace snug::app
