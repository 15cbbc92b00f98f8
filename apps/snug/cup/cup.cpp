// cup: reads JSON lines, asks the cup module, prints its answers.
#include "apps/snug/cup/cup.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/shipped.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/cup/json_lines.hpp"

namespace snug::app {
namespace {

using AnswerLine = std::string (*)(std::string_view line, int line_number, std::string_view source);

struct CupOptions {
  std::string input = "-";  ///< file of JSON lines; "-": stdin
};

constexpr std::size_t kLongestLine = 65536;  // a question with all its digits has some 1500

constexpr std::size_t kLargestLines = std::size_t{16} << 30U;  // read line by line

/// Like std::getline, but of a line that does not end only a little more than is allowed.
bool read_line(std::istream& input, std::string& line) {
  line.clear();
  for (int c = input.get(); c != std::char_traits<char>::eof(); c = input.get()) {
    if (c == '\n' || line.size() > kLongestLine) return true;
    line += static_cast<char>(c);
  }
  return !line.empty();
}

int answer_lines(std::istream& input, const std::string& source, AnswerLine answer) {
  std::string line;
  for (int number = 1; read_line(input, line); ++number) {
    if (line.size() > kLongestLine) {
      throw InputError(source + ":" + std::to_string(number), "",
                       "a line of more than " + std::to_string(kLongestLine) + " bytes",
                       "one JSON object on each line");
    }
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    print_now(answer(line, number, source) + "\n");
  }
  return kSuccess;
}

int run(const CupOptions& options, AnswerLine answer) {
  const std::string input = find_shipped(options.input);
  if (input == "-") return answer_lines(std::cin, "stdin", answer);
  check_readable(input, "a file of JSON lines, or - for what comes on stdin", kLargestLines);
  std::ifstream file(input);
  return answer_lines(file, input, answer);
}

int run_cup_evaluate(const CupOptions& options) { return run(options, cup::evaluate_json_line); }

int run_cup_settle(const CupOptions& options) { return run(options, cup::settle_json_line); }

constexpr const char* kEvaluateHelp =
    R"(Each line: {"R": 3x3, "o": [3], "K": 6x6, "S_R_S1": 3x3, "S_o_S1": [3]}; matrices as rows, SI units, linear part first.
The answer has the wrench on the package in S and in S1, and the stored energy V.
Example:
  snug cup evaluate scenarios/examples/deformations.jsonl)";

constexpr const char* kSettleHelp =
    R"(Each line: {"W_R_E": 3x3, "mass": kg, "com_S": [3], "K": 6x6, "E_H_S2": {"R", "o"}, "S_H_S1": {"R", "o"}}.
The answer has the pose of the lip, E_R_S and E_o_S, and whether the load stays there: stable.
Example:
  snug cup settle scenarios/examples/loads.jsonl)";

void add_questions(const Verb& verb, const char* name, const char* about, const char* help,
                   int (*run)(const CupOptions&)) {
  const Verb part = verb.part(name, about, help);
  CupOptions& options = part.runs(run);
  part.option("input", options.input, "FILE", "file of JSON lines, - for stdin");
}

}  // namespace

void add_cup(CLI::App& app, Action& action) {
  const Verb verb(app, action, "cup", "ask the model of the suction cup",
                  "`snug cup evaluate --help` and `snug cup settle --help` tell the keys of a line.");
  add_questions(verb, "evaluate", "the wrench that a deformation gives", kEvaluateHelp, run_cup_evaluate);
  add_questions(verb, "settle", "where a held box hangs at rest", kSettleHelp, run_cup_settle);
  add_cup_estimate(verb);
  add_cup_catalogue(verb);
}

}  // namespace snug::app
