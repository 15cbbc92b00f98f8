// Slurm: a study as an array of jobs; which runs when and where is the scheduler's.
#pragma once

#include <string>
#include <vector>

#include "snug/study/merge.hpp"

namespace snug::study {

/// Ranges of chunks, one for each task of an array: those with rows missing, at most `most_tasks` ranges.
struct ArrayPlan {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> tasks;  ///< first and last chunk
};
[[nodiscard]] ArrayPlan plan_array(const Study& study, const Folder& folder, std::uint64_t most_tasks = 1000);

/// The script of the array: task k does the k-th range. `program`: the snug that runs; `file`: of the study.
[[nodiscard]] std::string array_script(const Study& study, const Folder& folder, const ArrayPlan& plan,
                                       const std::string& program, const std::string& file);

/// Hands a script to sbatch and returns what it says. Throws std::runtime_error with its complaint, or when there is no
/// sbatch.
[[nodiscard]] std::string submit(const std::filesystem::path& script);

}  // namespace snug::study
