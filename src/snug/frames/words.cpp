// Words of a command, as they are written on one line.
#include "snug/frames/internal/words.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>

#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"

namespace snug::frames::internal {
namespace {

[[noreturn]] void refuse_command(const std::string& got, const std::string& expected) {
  throw InputError("command line", "--frames", got, expected);
}

/// What a shell would do with these no shell does here: better said than passed on as a word.
void expect_no_shell(const std::string& word) {
  constexpr std::array kOfShells = {"|", "||", "&", "&&", ";", "<", ">", ">>", "2>", "2>&1", "|&"};
  const bool is_of_shell = std::ranges::find(kOfShells, word) != kOfShells.end() || word.ends_with(';') ||
                           word.find("$(") != std::string::npos || word.find('`') != std::string::npos;
  if (is_of_shell) {
    refuse_command("'" + printable(word, 60) + "'",
                   "one program and its words: no shell runs them (put them into a script, or quote the word)");
  }
}

void replace_all(std::string& word, std::string_view name, const std::string& value) {
  for (std::size_t at = word.find(name); at != std::string::npos; at = word.find(name, at + value.size()))
    word.replace(at, name.size(), value);
}

bool is_program(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_regular_file(path, error) && ::access(path.c_str(), X_OK) == 0;
}

}  // namespace

std::vector<std::string> split_command(const std::string& text) {
  std::vector<std::string> words;
  std::string word;
  bool is_open = false, was_quoted = false;
  char quote = '\0';
  const auto end_word = [&] {
    if (!is_open) return;
    if (!was_quoted) expect_no_shell(word);
    words.push_back(std::move(word));
    word.clear();
    is_open = was_quoted = false;
  };
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '\0') refuse_command("a byte 0", "text");
    const bool is_blank = c == ' ' || c == '\t' || c == '\n';
    if (quote == '\0' && is_blank) {
      end_word();
      continue;
    }
    is_open = true;
    if (quote == '\0' && (c == '\'' || c == '"')) {
      quote = c;
      was_quoted = true;
    } else if (c == quote) {
      quote = '\0';
    } else if (c == '\\' && quote != '\'') {
      if (i + 1 == text.size()) refuse_command("a backslash at the end", "a character behind it");
      const char next = text[i + 1];
      const bool keeps = quote == '"' && next != '"' && next != '\\';
      if (keeps) word += c;
      if (!keeps) was_quoted = true;
      if (!keeps) ++i;
      if (!keeps) word += next;
    } else {
      word += c;
    }
  }
  if (quote != '\0') refuse_command(std::string("an open ") + quote, "its end");
  end_word();
  if (words.empty()) refuse_command("nothing", "a folder, or a command that writes a frame");
  return words;
}

std::vector<std::string> fill_in(std::vector<std::string> words, const std::string& frame, std::uint64_t look,
                                 double time) {
  for (std::string& word : words) {
    replace_all(word, "{look}", std::to_string(look));
    replace_all(word, "{time}", fmt::format("{:.6f}", time));
    replace_all(word, "{frame}", frame);
  }
  return words;
}

std::string find_program(const std::string& word) {
  if (word.find('/') != std::string::npos) return is_program(word) ? word : std::string();
  const char* folders = std::getenv("PATH");
  std::string rest = folders != nullptr ? folders : "/usr/bin:/bin";
  while (!rest.empty()) {
    const std::size_t colon = rest.find(':');
    const std::string folder = rest.substr(0, colon);
    rest = colon == std::string::npos ? "" : rest.substr(colon + 1);
    if (folder.empty()) continue;  // the current folder: never by accident
    const std::filesystem::path path = std::filesystem::path(folder) / word;
    if (is_program(path)) return path.string();
  }
  return {};
}

}  // namespace snug::frames::internal
