// cup: what wrench a deformation gives, and where a held box hangs, as JSON lines; a starting cup from a data sheet.
#pragma once

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

void add_cup_estimate(const Verb& verb);
void add_cup_catalogue(const Verb& verb);

}  // namespace snug::app
