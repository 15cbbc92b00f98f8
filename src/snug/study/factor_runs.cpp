// run_factor: one verb with each of some values of one option, every run in a process of its own.
#include "snug/study/factor_runs.hpp"

#include <stdexcept>

namespace snug::study {

void run_factor(const FactorRuns& runs, const Verb& verb, const std::string& what,
                const std::function<void(const RowResult& result, const std::string& said)>& tell) {
  Study study;
  study.name = study.source = runs.name;
  study.verb = runs.verb;
  study.scenario = runs.scenario;
  study.options = runs.options;
  study.seed_option.clear();
  study.factors = {{.name = runs.option.substr(runs.option.find_first_not_of('-')),
                    .option = runs.option,
                    .key = {},
                    .values = runs.values}};
  study.point_count = runs.values.size();
  study.outputs = runs.outputs;
  study.chunk = static_cast<int>(runs.values.size());
  RunSettings settings;
  settings.processes = runs.processes;
  settings.tell = tell;
  if (run_study(study, verb, settings).left_out > 0)
    throw std::runtime_error("processes of the " + what + " were killed");
}

}  // namespace snug::study
