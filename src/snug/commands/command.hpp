// Command: verbs and options of a program as plain data, for its manual page and for completion in shells.
#pragma once

#include <string>
#include <vector>

namespace snug::commands {

/// An option, a flag or, without names, a word at its place.
struct CommandOption {
  std::vector<std::string> names;    ///< as typed: "-o", "--record"
  std::string value;                 ///< what follows, such as FILE.csv; empty for a flag
  std::vector<std::string> choices;  ///< the values that are accepted, where they are few (`one_of`)
  std::string about;
  bool takes_file = false;
  bool is_required = false;
};

struct Command {
  std::vector<std::string> words;  ///< after `snug`: {"pack"}, {"cup", "evaluate"}; empty for the program itself
  std::string about;
  std::string more;  ///< what stands below its --help: keys, examples
  std::vector<CommandOption> options;
  std::vector<std::string> verbs;  ///< what may follow at this place
};

/// The program itself first, each verb before its parts, in the order of its --help.
using CommandList = std::vector<Command>;

}  // namespace snug::commands
