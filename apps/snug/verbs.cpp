// add_verbs: every verb that this program offers, in the order of --help.
#include "verbs.hpp"

namespace snug::app {

void add_verbs([[maybe_unused]] CLI::App& app, [[maybe_unused]] Action& action) {}

}  // namespace snug::app
