// pack: packs a sequence, item by item, and says how that went.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scenario_options.hpp"
#include "snug/task/session.hpp"
#include "verb.hpp"

namespace snug::app {

/// The words of `snug pack`.
struct PackOptions {
  std::string scenario;
  std::string sequence;
  ScenarioChanges changes;
  std::string agent = "contact-aware";
  std::optional<std::uint64_t> seed;
  double decision_time = packing::PackingSettings{}.decision_time;  ///< s
  std::optional<int> threads;                                       ///< absent: all cores
  int samples = task::SessionOptions{}.samples;
  std::string future = "own";
  std::string look = "exact";
  std::optional<std::string> robot;
  std::optional<int> executions;
  std::optional<std::string> program, plan, record;
  bool json = false;
};

void add_pack(CLI::App& app, Action& action);
/// What `pack` and `compare` have in common.
void add_packing_options(CLI::App& verb, PackOptions& options);
[[nodiscard]] task::SessionOptions make_session_options(const PackOptions& options, const SourcedScenario& loaded,
                                                        const std::string& sequence);
/// A line on a terminal that is written over again, or nothing.
[[nodiscard]] task::Progress make_progress_line(const std::string& label);

/// Throws InputError for input that cannot be used.
[[nodiscard]] int run_pack(const PackOptions& options);

}  // namespace snug::app
