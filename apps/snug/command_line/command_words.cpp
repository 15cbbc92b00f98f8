// The words of a command line that are none of the program's: said with the nearest that is.
#include "apps/snug/command_line/command_words.hpp"

#include <algorithm>

#include "snug/core/input_error.hpp"

namespace snug::app {
namespace {

std::vector<const CLI::App*> verbs_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* verb) { return !verb->get_name().empty(); });
}

const CLI::App* find_verb(const CLI::App& app, const std::string& word) {
  const std::vector<const CLI::App*> verbs = verbs_of(app);
  const auto found = std::ranges::find(verbs, word, [](const CLI::App* verb) { return verb->get_name(); });
  return found == verbs.end() ? nullptr : *found;
}

bool is_option(const std::string& word) { return word.starts_with("-"); }

std::string hint_of(const std::string& word, const std::vector<std::string>& names, const char* before = "") {
  const std::string_view nearest = find_nearest(word, names);
  return nearest.empty() ? std::string() : "; did you mean " + (before + std::string(nearest)) + "?";
}

/// "snug identify" of the sub-verb stiffness's parent.
std::string command_of(const CLI::App& app) {
  return app.get_parent() == nullptr ? app.get_name() : command_of(*app.get_parent()) + " " + app.get_name();
}

/// `word`: stands where a verb of `app` should; empty: nothing does.
[[noreturn]] void refuse_verb(const CLI::App& app, const std::string& word) {
  std::vector<std::string> names;
  std::string expected = "one of";
  for (const CLI::App* known : verbs_of(app)) {
    names.push_back(known->get_name());
    expected += (names.size() == 1 ? " " : ", ") + names.back();
  }
  const std::string hint = hint_of(word, names);
  // A message has an end: the nearest verb is worth more than the list of all.
  if (app.get_parent() == nullptr && !hint.empty()) expected = "one of `" + command_of(app) + " --help`";
  throw InputError("command line", app.get_parent() == nullptr ? "verb" : "verb after " + app.get_name(),
                   word.empty() ? "nothing" : "'" + word + "'", expected + hint);
}

}  // namespace

void check_verbs(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::App* at = &app;
  auto word = std::ranges::find_if_not(words, is_option);
  while (word != words.end() && !is_option(*word)) {
    const CLI::App* verb = find_verb(*at, *word);
    if (verb == nullptr) {
      if (at != &app && at->get_require_subcommand_min() == 0) return;
      refuse_verb(*at, *word);
    }
    at = verb;
    ++word;
  }
}

void refuse_words(const CLI::App& app, const std::vector<std::string>& words) {
  std::vector<const CLI::App*> verbs{&app};
  for (const std::string& word : words) {
    if (word == "--") break;
    if (!word.starts_with("--")) {
      if (const CLI::App* verb = find_verb(*verbs.back(), word)) verbs.push_back(verb);
      continue;
    }
    const std::string name = word.substr(2, word.find('=') == std::string::npos ? word.npos : word.find('=') - 2);
    std::vector<std::string> names;
    for (auto verb = verbs.rbegin(); verb != verbs.rend(); ++verb) {
      for (const CLI::Option* option : (*verb)->get_options()) {
        names.insert(names.end(), option->get_lnames().begin(), option->get_lnames().end());
      }
    }
    if (std::ranges::find(names, name) != names.end()) continue;
    throw InputError("command line", "--" + name, "an unknown option",
                     "one of `" + command_of(*verbs.back()) + " --help`" + hint_of(name, names, "--"));
  }
  if (verbs.size() > 1 && verbs.back()->get_require_subcommand_min() > 0) refuse_verb(*verbs.back(), "");
}

}  // namespace snug::app
