// pack: packs a plant with a sequence, item by item, and says how that went.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/remote_runs/remote_trial.hpp"

namespace snug::app {

/// The words of `snug pack`.
struct PackOptions {
  std::string scenario;
  std::string sequence;
  ScenarioChanges changes;
  session::SessionOptions
      session;  ///< agent, decision time, samples and skips as said; the rest is made of what follows
  std::optional<std::uint64_t> seed;
  std::optional<std::uint64_t> random_seed;  ///< the sequence is drawn: every box of the scenario, in random order
  double agent_patience = 600.0;             ///< s, for an answer of an agent in Python
  remote_runs::PlantChoice plant;
  std::optional<int> threads;       ///< absent: all cores
  std::string controller = "fast";  ///< or lagged
  std::optional<double> tempo;      ///< only with fast; absent: 1
  std::string future = "order";
  std::vector<std::string> plant_set;  ///< "KEY=VALUE", of the plant's scenario alone
  std::string fault;                   ///< "drop@3,noseal@5"
  std::optional<std::string> robot;    ///< absent: the scenario's, where its file is there; "none"
  std::optional<int> monte_carlo;
  std::optional<std::string> program, plan, record;
  std::optional<std::string> log;            ///< of events
  std::optional<std::string> live;           ///< frames for who watches; with `record`
  std::optional<std::string> resume;         ///< log of the session that is gone on with
  std::optional<std::string> operator_file;  ///< what who operates says; "-": standard input
  std::optional<std::string> save_beliefs;   ///< folder
  bool json = false;
};

/// What `pack` and `compare` have in common.
void add_packing_options(const Verb& verb, PackOptions& options);
/// Who the agent asks is not chosen yet.
[[nodiscard]] session::SessionOptions make_session_options(const PackOptions& options, const model::Scenario& scenario);
/// Who decides in the agent's place: a class written in Python, started; nobody for a built-in agent. `patience`: s.
[[nodiscard]] packing::Ask choose_ask(const std::string& agent, double patience);
/// Throws InputError for words that say nothing.
[[nodiscard]] simulated_plant::SimulatedPlantOptions make_plant_options(const PackOptions& options,
                                                                        const session::SessionOptions& session);
/// A line on a terminal that is written over again, or nothing.
[[nodiscard]] study::TrialProgress make_progress_line(const std::string& label);

/// Throws InputError for input that cannot be used.
[[nodiscard]] int run_pack(const PackOptions& options);

}  // namespace snug::app
