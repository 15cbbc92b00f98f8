// capture_program: the run of a program, in memory.
#pragma once

#include <optional>
#include <string>

#include "snug/model/scenario.hpp"
#include "snug/model/scene_task.hpp"
#include "snug/record/recording.hpp"

namespace snug::identification::internal {

struct CapturedRun {
  record::Recording recording;
  std::string failure;  ///< empty, or why it stopped early
};
[[nodiscard]] CapturedRun capture_program(const model::Scenario& scenario, const model::TaskProgram& program,
                                          std::optional<double> until);

}  // namespace snug::identification::internal
