// run_command_line: the program without its beginning and end, for those who run its verbs again.
#pragma once

namespace snug::app {

/// What `snug` does with these words, errors said on stderr; the exit code. Standard output is not flushed.
[[nodiscard]] int run_command_line(int argc, char** argv);

}  // namespace snug::app
