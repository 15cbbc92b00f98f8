// snug: the command line. Parses words, calls modules, prints; no physics here.
#include <fcntl.h>
#include <signal.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <exception>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "apps/snug/command_line/command_line.hpp"
#include "apps/snug/command_line/command_words.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "apps/snug/command_line/version.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace {

using snug::app::Action;

constexpr const char* kExamples = R"(Examples:
  snug init cell my-cell
  snug pack scenarios/box-demonstrator.yaml --sequence 1 --program program.csv -o run.h5
  snug report run.h5 -o run.html
  snug simulate scenarios/drop.yaml --until 5 --json
`snug VERB --help` lists the options of a verb. Data goes to stdout, messages to stderr.
Exit codes:
  0  done; boxes that were not packed, with their reasons, are a result too
  1  the run failed: snug could not write an output, a simulation could not continue (a protective stop of the robot, also
     on its way home; with --monte-carlo and compare in any of the runs), pack or compare was interrupted, or check or
     bench found a fault
  2  the input cannot be used, or an output cannot be written, is an input or is being written by another run)";

/// Words become names in JSON and HDF5, which take UTF-8 only.
void check_words(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (snug::is_utf8(argv[i])) continue;
    throw snug::InputError("command line", "word " + std::to_string(i), std::string("'") + argv[i] + "'", "UTF-8");
  }
}

int run(int argc, char** argv) {
  CLI::App app("snug simulates how a robot with a suction cup packs boxes, contact included.", "snug");
  app.set_version_flag("--version", std::string("snug ") + snug::app::version_text());
  app.require_subcommand(0, 1);
  app.footer(kExamples);
  Action action;
  snug::app::add_verbs(app, action);
  check_words(argc, argv);
  const std::vector<std::string> words(argv + 1, argv + argc);
  snug::app::check_verbs(app, words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    std::ostringstream text;
    const int code = app.exit(request, text, text);
    snug::app::print(text.str());
    return code;
  } catch (const CLI::ParseError& error) {
    snug::app::refuse_words(app, words);
    constexpr std::size_t kRoomForWord = 250;
    throw snug::InputError("command line", snug::printable(error.what(), kRoomForWord) + " (see --help)", "", "");
  }
  if (!action) {
    snug::app::print(app.help());
    return snug::app::kSuccess;
  }
  return action();
}

/// Streams that were closed (`>&-`) stay so, but their numbers must not become those of files.
void occupy_closed_streams() {
  for (const int number : {0, 1, 2}) {
    if (::fcntl(number, F_GETFD) < 0 && errno == EBADF) (void)!::open("/dev/null", number == 0 ? O_WRONLY : O_RDONLY);
  }
}

}  // namespace

int snug::app::run_command_line(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const snug::InputError& error) {
    std::fprintf(stderr, "snug: error: %s\n", error.what());
    return snug::app::kBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "snug: failed: %s\n", snug::printable(error.what(), snug::kLongestMessage).c_str());
    return snug::app::kRunFailed;
  }
}

int main(int argc, char** argv) {
  occupy_closed_streams();
  ::signal(SIGXFSZ, SIG_IGN);  // a limit on the size of files is like a full disk: said, not died of
  snug::remove_drafts_when_interrupted();
  const int code = snug::app::run_command_line(argc, argv);
  const bool is_written = snug::app::flush_stdout();
  return code == snug::app::kSuccess && !is_written ? snug::app::kRunFailed : code;
}
