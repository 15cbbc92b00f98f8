// cup: reads JSON lines, asks the cup module, prints its answers.
#include "cup.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "outputs.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/json_lines.hpp"

namespace snug::app {
namespace {

using AnswerLine = std::string (*)(std::string_view line, int line_number, std::string_view source);

int answer_lines(std::istream& input, const std::string& source, AnswerLine answer) {
  std::string line;
  for (int number = 1; std::getline(input, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    print(answer(line, number, source) + "\n");
    if (std::fflush(stdout) != 0) throw OutputError("standard output", std::strerror(errno));
  }
  return kSuccess;
}

int run(const CupOptions& options, AnswerLine answer) {
  if (options.input == "-") return answer_lines(std::cin, "stdin", answer);
  std::ifstream file(options.input);
  if (!file || std::filesystem::is_directory(options.input)) {
    throw InputError(options.input, "", "", "a file of JSON lines that can be read");
  }
  return answer_lines(file, options.input, answer);
}

}  // namespace

int run_cup_evaluate(const CupOptions& options) { return run(options, cup::evaluate_json_line); }

int run_cup_settle(const CupOptions& options) { return run(options, cup::settle_json_line); }

}  // namespace snug::app
