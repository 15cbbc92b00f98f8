// Ray: a study as tasks of a Ray cluster; which runs when and where is Ray's.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "snug/study/slurm.hpp"

namespace snug::study {

/// A program in Python that hands each range of chunks to a Ray cluster as a task of one core and waits for all: the
/// same words with `--chunks`, on whatever node is free. A task whose node is lost begins again elsewhere and goes on
/// with what its table lacks. `address`: of the cluster, as Ray has it, or "local": of this machine alone, for as long
/// as it takes. Program, study and folder have to be on a file system that all nodes see. It ends with 0 when every row
/// has a result, 1 when rows were left out, 2 when there is no Ray or no cluster.
[[nodiscard]] std::string ray_program(const Study& study, const Folder& folder, const ArrayPlan& plan,
                                      const std::string& program, const std::string& file, const std::string& address);

/// Writes what hands the ranges of `plan` to Ray at `address`, or without one to Slurm, into the study's folder:
/// ray-tasks.py or array.sh. Its path. Throws OutputError.
[[nodiscard]] std::filesystem::path write_tasks(const Study& study, const Folder& folder, const ArrayPlan& plan,
                                                const std::string& program, const std::string& file,
                                                const std::optional<std::string>& address);

}  // namespace snug::study
