// program_motion: how a program is moved: as --controller and --tempo say, else as it was packed.
#include "apps/snug/command_line/program_motion.hpp"

#include <CLI/CLI.hpp>

#include "apps/snug/command_line/options.hpp"
#include "apps/snug/command_line/ranges.hpp"
#include "snug/core/input_error.hpp"
#include "snug/motion/program_tracking.hpp"

namespace snug::app {

void add_motion_words(CLI::App& verb, MotionWords& words) {
  verb.add_option("--controller", words.controller,
                  "lagged: the demonstrator's timing and lag; exact: on the reference; fast: bounded jerk, blends, "
                  "rows and waits that end by what is felt, as pack does (default: as the program was packed)")
      ->check(one_of({"lagged", "exact", "fast"}))
      ->type_name("KIND");
  verb.add_option("--tempo", words.tempo,
                  "fraction of the speeds, with fast (default: that the program was packed with, or 1)")
      ->check(within(0.5, 1.0))
      ->type_name("FRACTION");
}

void refuse_tempo_without_fast(const std::optional<double>& tempo, const std::string& controller) {
  if (!tempo || controller == "fast") return;
  throw InputError("command line", "--tempo", "with --controller " + controller, "--controller fast, or none");
}

void choose_motion(const MotionWords& words, std::string_view text, std::string_view name,
                   cell::SimulationOptions& options) {
  if (words.controller) refuse_tempo_without_fast(words.tempo, *words.controller);
  options.tracking =
      motion::choose_tracking(words.controller, words.tempo, motion::find_tracking(text, name), "command line");
}

}  // namespace snug::app
