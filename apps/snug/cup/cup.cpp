// cup: reads JSON lines, asks the cup module, prints its answers.
#include "apps/snug/cup/cup.hpp"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "apps/snug/command_line/outputs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/cup/json_lines.hpp"

namespace snug::app {
namespace {

using AnswerLine = std::string (*)(std::string_view line, int line_number, std::string_view source);

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
  if (options.input == "-") return answer_lines(std::cin, "stdin", answer);
  check_readable(options.input, "a file of JSON lines, or - for what comes on stdin", kLargestLines);
  std::ifstream file(options.input);
  return answer_lines(file, options.input, answer);
}

}  // namespace

int run_cup_evaluate(const CupOptions& options) { return run(options, cup::evaluate_json_line); }

int run_cup_settle(const CupOptions& options) { return run(options, cup::settle_json_line); }

}  // namespace snug::app
