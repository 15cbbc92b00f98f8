// The words of a command line that are none of the program's: said with the nearest that is.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace snug::app {

/// The words after the program's name. Throws InputError where a verb, or a word after one that requires another, is
/// none of those that there are.
void check_verbs(const CLI::App& app, const std::vector<std::string>& words);
/// Of words that the parser has refused. Throws InputError for the first that begins with "--" and is no option of its
/// verb, from which what the parser says may follow, and where a verb is missing behind another.
void refuse_words(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace snug::app
