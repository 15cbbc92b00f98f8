// run_factor: one verb with each of some values of one option, every run in a process of its own.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "snug/study/run.hpp"

namespace snug::study {

/// A study of one factor without tables: repeated runs, and scenes that are measured one at a time.
struct FactorRuns {
  std::string name;  ///< of the study, in messages
  std::string verb, scenario;
  std::vector<std::string> options;  ///< words that all runs have
  std::string option;                ///< of the verb, such as --draw
  std::vector<std::string> values;   ///< of the option, a run each
  std::vector<Output> outputs;
  int processes = 1;
};

/// Tells every row, in the order of the values. Throws std::runtime_error where rows were left out since their
/// processes were killed; `what` names them: "processes of the runs were killed". What `tell` throws ends the call.
void run_factor(const FactorRuns& runs, const Verb& verb, const std::string& what,
                const std::function<void(const RowResult& result, const std::string& said)>& tell);

}  // namespace snug::study
