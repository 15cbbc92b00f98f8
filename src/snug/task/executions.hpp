// Executions: a finished program repeated open loop under what nobody knows exactly.
#pragma once

#include <string>
#include <vector>

#include "snug/cell/ensemble.hpp"
#include "snug/task/session.hpp"

namespace snug::task {

struct ExecutionOptions {
  int count = 20;
  std::uint64_t seed = 1;
  int threads = 1;  ///< results do not depend on it
  Uncertainty uncertainty{.mass = cell::kMassSpread};
  cell::SimulationOptions simulation{motion::ControllerKind::Faithful, cup::CupMode::Phases, {}};
};

/// One item over all executions.
struct ItemSpread {
  std::string id;
  int succeeded = 0;                    ///< executions at whose end it is packed
  Vector3 deviation = Vector3::Zero();  ///< m, standard deviation of its middle in T, where it succeeded
  double worst_distance = 0.0;          ///< m, from where it came to rest without changes
};

struct ExecutionResult {
  int count = 0;
  int failed = 0;  ///< executions that did not reach the program's end, such as by a protective stop
  std::vector<ItemSpread> items;
  double success_percent = 0.0;  ///< of all items in all executions
  double mean_filling_percent = 0.0, lowest_filling_percent = 0.0;
};

/// Runs the program of a session `count` times, each with everything uncertain drawn anew.
[[nodiscard]] ExecutionResult repeat(const model::Scenario& scenario, const SessionResult& session,
                                     const ExecutionOptions& options);

}  // namespace snug::task
