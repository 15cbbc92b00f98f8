// Options that several verbs have: one declaration of each, with one text.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "apps/snug/command_line/verb.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/model/scenario.hpp"

namespace snug::app {

/// The scenario at its place.
void add_scenario(const Verb& verb, std::string& scenario);
void add_robot_scenario(const Verb& verb, std::string& scenario);
/// --threads; absent: all cores.
void add_threads(const Verb& verb, std::optional<int>& threads);
/// --json.
void add_json(const Verb& verb, bool& json);
/// --corrections, a layer of the scenario.
void add_corrections(const Verb& verb, std::string& corrections);
/// Its name; empty for "none".
[[nodiscard]] std::string layer_of(const std::string& corrections);

/// By what keys this program is known to a served cell, and how long it waits for an answer.
struct ClientWords {
  std::optional<std::string> keys;  ///< folder or file
  double patience = 10.0;           ///< s
};
/// --keys, and the option `timeout`.
std::array<OptionRow, 2> add_client(const Verb& verb, std::optional<std::string>& keys, double& patience,
                                    const char* timeout);
inline std::array<OptionRow, 2> add_client(const Verb& verb, ClientWords& client, const char* timeout) {
  return add_client(verb, client.keys, client.patience, timeout);
}

/// How a cell is simulated, instead of as its scenario says.
struct PhysicsWords {
  std::optional<std::string> cup;       ///< holding | phases
  std::optional<double> dt;             ///< s
  std::optional<double> record_period;  ///< s between frames
  std::optional<std::uint64_t> seed;
};
/// --dt, --cup, --seed and --record-period.
void add_physics(const Verb& verb, PhysicsWords& physics);
/// Throws InputError for a time step in which something spins too far.
void apply(const PhysicsWords& physics, model::Scenario& scenario);

/// How a program is moved. Absent words leave it to the program: as it was made for (motion::find_tracking).
struct MotionWords {
  std::optional<std::string> controller;  ///< lagged | exact | fast
  std::optional<double> tempo;            ///< only with fast
};

/// --controller and --tempo.
void add_motion_words(const Verb& verb, MotionWords& words);
/// Throws InputError.
void refuse_tempo_without_fast(const std::optional<double>& tempo, const std::string& controller);
/// `text`: of the program's file `name`. Throws InputError for a --tempo that does not fit --controller, and for a
/// tracking of the program that is none.
void choose_motion(const MotionWords& words, std::string_view text, std::string_view name,
                   cell::SimulationOptions& options);

/// Prints on stderr what the URDF of the scenario's robot leaves open, a line each; nothing without a robot.
void print_robot_warnings(const model::Scenario& scenario);

}  // namespace snug::app
