// Completion: a script that lets a shell complete the words of `snug`.
#include "snug/commands/completion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace snug::commands {
namespace {

std::string joined(const std::vector<std::string>& words, const std::string& between = " ") {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
  return text;
}

/// In single quotes, as all three shells read them.
std::string shell_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\"'\"'") : std::string(1, c);
  return result + "'";
}

/// `before word` of each verb, as the loops of the scripts meet them: "/pack", "/cup", "cup/evaluate".
std::vector<std::string> verb_steps(const CommandList& commands) {
  std::vector<std::string> steps;
  for (const Command& command : commands) {
    if (command.words.empty()) continue;
    const std::vector<std::string> before(command.words.begin(), command.words.end() - 1);
    steps.push_back(joined(before) + "/" + command.words.back());
  }
  return steps;
}

std::string quoted_steps(const CommandList& commands, const std::string& between) {
  std::string text;
  for (const std::string& step : verb_steps(commands)) text += (text.empty() ? "" : between) + shell_quoted(step);
  return text;
}

/// The names of the parts of a command with what each is about.
std::vector<std::pair<std::string, std::string>> parts_of(const CommandList& commands, const Command& whole) {
  std::vector<std::pair<std::string, std::string>> parts;
  for (const Command& command : commands) {
    if (command.words.size() != whole.words.size() + 1) continue;
    if (!std::equal(whole.words.begin(), whole.words.end(), command.words.begin())) continue;
    parts.emplace_back(command.words.back(), command.about);
  }
  return parts;
}

/// Brackets and colons end the parts of what _arguments and _describe of zsh read.
std::string zsh_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') result += '\\';
    result += c;
  }
  return result;
}

std::string zsh_value(const CommandOption& option) {
  if (option.value.empty()) return "";
  std::string action = " ";  // a value, nothing to offer
  if (option.takes_file) action = "_files";
  if (!option.choices.empty()) action = "(" + joined(option.choices) + ")";
  return ":" + zsh_escaped(option.value) + ":" + action;
}

std::string zsh_argument(const CommandOption& option) {
  if (option.names.empty()) return shell_quoted("*" + zsh_value(option));
  const std::string about = "[" + zsh_escaped(option.about) + "]";
  if (option.names.size() == 1) return shell_quoted("*" + option.names.front() + about + zsh_value(option));
  return shell_quoted("*") + "{" + joined(option.names, ",") + "}" + shell_quoted(about + zsh_value(option));
}

}  // namespace

std::string format_bash_completion(const CommandList& commands) {
  std::string text =
      "# bash completion for snug, written by `snug completion bash`.\n_snug() {\n  local "
      "current=\"${COMP_WORDS[COMP_CWORD]}\" before=\"${COMP_WORDS[COMP_CWORD-1]}\" verb=\"\" words=\"\" i\n  for ((i "
      "= 1; i < COMP_CWORD; i++)); do\n    case \"$verb/${COMP_WORDS[i]}\" in\n";
  text += fmt::format("      {}) verb=\"${{verb:+$verb }}${{COMP_WORDS[i]}}\" ;;\n", quoted_steps(commands, " | "));
  text += "    esac\n  done\n  COMPREPLY=()\n  case \"$verb|$before\" in\n";
  std::string plain;  // options with a value that cannot be listed
  for (const Command& command : commands) {
    for (const CommandOption& option : command.options) {
      if (option.value.empty()) continue;
      std::string patterns;
      for (const std::string& name : option.names) {
        patterns += (patterns.empty() ? "" : " | ") + shell_quoted(joined(command.words) + "|" + name);
      }
      if (patterns.empty()) continue;
      if (option.choices.empty()) {
        plain += (plain.empty() ? "" : " | ") + patterns;
      } else {
        text += fmt::format("    {}) words={} ;;\n", patterns, shell_quoted(joined(option.choices)));
      }
    }
  }
  if (!plain.empty())
    text += fmt::format("    {}) return ;;  # a file or a number: names of files are offered\n", plain);
  text += "    *)\n      case \"$verb\" in\n";
  for (const Command& command : commands) {
    std::vector<std::string> names;
    for (const CommandOption& option : command.options)
      names.insert(names.end(), option.names.begin(), option.names.end());
    text += fmt::format("        {}) [[ $current == -* ]] && words={} || words={} ;;\n",
                        shell_quoted(joined(command.words)), shell_quoted(joined(names)),
                        shell_quoted(joined(command.verbs)));
  }
  return text + R"(      esac
      ;;
  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}
complete -o bashdefault -o default -F _snug snug
)";
}

std::string format_zsh_completion(const CommandList& commands) {
  std::string text = R"(#compdef snug
# zsh completion for snug, written by `snug completion zsh`.
_snug() {
  local verb= i used=1
  local -a verbs
  for ((i = 2; i < CURRENT; i++)); do
    case "$verb/$words[i]" in
)";
  text += fmt::format("      ({}) verb=\"${{verb:+$verb }}$words[i]\"; used=$i ;;\n", quoted_steps(commands, " | "));
  text += R"(    esac
  done
  words=(snug "${(@)words[used+1,-1]}")
  ((CURRENT -= used - 1))
  case "$verb" in
)";
  for (const Command& command : commands) {
    text += fmt::format("    ({})\n", shell_quoted(joined(command.words)));
    if (!command.verbs.empty()) {
      text += "      verbs=(";
      for (const auto& [name, about] : parts_of(commands, command)) {
        text += "\n        " + shell_quoted(name + ":" + zsh_escaped(about));
      }
      text += ")\n      [[ $words[CURRENT] == -* ]] || { _describe verb verbs; return }\n";
    }
    text += "      _arguments -s";
    for (const CommandOption& option : command.options) text += " \\\n        " + zsh_argument(option);
    text += "\n      ;;\n";
  }
  return text + "  esac\n}\n_snug \"$@\"\n";
}

std::string format_fish_completion(const CommandList& commands) {
  std::string text = R"(# fish completion for snug, written by `snug completion fish`.
function __snug_at
    set -l verb ''
    for word in (commandline -opc)[2..-1]
        switch "$verb/$word"
)";
  text += "            case";
  for (const std::string& step : verb_steps(commands)) text += " " + shell_quoted(step);
  text += R"(
                set verb (string trim "$verb $word")
        end
    end
    test "$verb" = "$argv[1]"
end
)";
  for (const Command& command : commands) {
    const std::string at =
        fmt::format("complete -c snug -n {}", shell_quoted("__snug_at '" + joined(command.words) + "'"));
    for (const auto& [name, about] : parts_of(commands, command)) {
      text += fmt::format("{} -f -a {} -d {}\n", at, name, shell_quoted(about));
    }
    for (const CommandOption& option : command.options) {
      if (option.names.empty()) continue;
      text += at;
      for (const std::string& name : option.names) {
        const bool is_long = name.rfind("--", 0) == 0;
        text += (is_long ? " -l " : " -s ") + name.substr(is_long ? 2 : 1);
      }
      if (!option.choices.empty())
        text += " -x -a " + shell_quoted(joined(option.choices));
      else if (!option.value.empty())
        text += option.takes_file ? " -r -F" : " -x";
      text += fmt::format(" -d {}\n", shell_quoted(option.about));
    }
  }
  return text;
}

}  // namespace snug::commands
