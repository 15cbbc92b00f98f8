// program_motion: how a program is moved: as --controller and --tempo say, else as it was packed.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "apps/snug/command_line/verb.hpp"
#include "snug/cell/simulation.hpp"

namespace snug::app {

/// Absent words leave it to the program: as it was made for (motion::find_tracking).
struct MotionWords {
  std::optional<std::string> controller;  ///< lagged | exact | fast
  std::optional<double> tempo;            ///< only with fast
};

/// --controller and --tempo.
void add_motion_words(CLI::App& verb, MotionWords& words);
/// Throws InputError.
void refuse_tempo_without_fast(const std::optional<double>& tempo, const std::string& controller);
/// `text`: of the program's file `name`. Throws InputError for a --tempo that does not fit --controller, and for a
/// tracking of the program that is none.
void choose_motion(const MotionWords& words, std::string_view text, std::string_view name,
                   cell::SimulationOptions& options);

}  // namespace snug::app
