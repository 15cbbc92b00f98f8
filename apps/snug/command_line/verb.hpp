// Verb: one word of the command line, from its options to its exit code.
#pragma once

#include <functional>

// The parser itself is included only where options are declared: it takes seconds to compile.
namespace CLI {
class App;
}

namespace snug::app {

enum ExitCode : int {
  kSuccess = 0,    ///< done as asked
  kRunFailed = 1,  ///< the input was fine, the run was not (a lost body, a target missed, a full disk)
  kBadInput = 2,   ///< a word of the command line or a file that cannot be used
};

/// What to do once the whole command line is understood. A verb's add function sets it from the parser's callback.
using Action = std::function<int()>;

}  // namespace snug::app
