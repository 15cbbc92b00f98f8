// add_verbs: every verb that this program offers, in the order of --help.
#pragma once

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

/// Adds the verbs to `app`; parsing one of them sets `action`, which must outlive the parser.
void add_verbs(CLI::App& app, Action& action);

}  // namespace snug::app
