// Manual: the manual page, made from what `--help` of each verb says.
#include "snug/commands/manual.hpp"

#include <fmt/format.h>

namespace snug::commands {
namespace {

/// Letters that mean something to man(7), made to mean themselves; `-` is the one that can be pasted into a shell.
std::string man_escaped(const std::string& text) {
  std::string result;
  bool starts_line = true;
  for (const char c : text) {
    if (starts_line && (c == '.' || c == '\'')) result += "\\&";
    if (c == '\\')
      result += "\\e";
    else if (c == '-')
      result += "\\-";
    else
      result += c;
    starts_line = c == '\n';
  }
  return result;
}

std::string verbatim(const std::string& text) { return ".PP\n.EX\n" + man_escaped(text) + "\n.EE\n"; }

std::string heading_of(const CommandOption& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + name;
  if (names.empty()) return fmt::format(".I {}\n", man_escaped(option.value));
  if (option.value.empty()) return fmt::format(".B {}\n", man_escaped(names));
  return fmt::format(".BI \"{}\" \" {}\"\n", man_escaped(names), man_escaped(option.value));
}

std::string format_option(const CommandOption& option) {
  std::string about = option.about;
  if (!option.choices.empty()) {
    about += about.empty() ? "one of" : "; one of";
    for (const std::string& choice : option.choices) about += (choice == option.choices.front() ? " " : ", ") + choice;
  }
  return ".TP\n" + heading_of(option) + man_escaped(about.empty() ? option.value : about) + "\n";
}

std::string name_of(const Command& command) {
  std::string name = "snug";
  for (const std::string& word : command.words) name += " " + word;
  return name;
}

std::string usage_of(const Command& command) {
  std::string usage = fmt::format(".B {}\n", man_escaped(name_of(command)));
  if (!command.verbs.empty()) usage += ".I VERB\n";
  usage += "[options]";
  for (const CommandOption& option : command.options) {
    if (option.names.empty())
      usage += (option.is_required ? " " : " [") + man_escaped(option.value) + (option.is_required ? "" : "]");
  }
  return usage + "\n";
}

}  // namespace

std::string format_manual(const CommandList& commands, const std::string& version) {
  std::string text;
  for (const Command& command : commands) {
    if (command.words.empty()) {
      text += fmt::format(".TH SNUG 1 \"\" \"snug {}\"\n.SH NAME\nsnug \\- {}\n", version, man_escaped(command.about));
      text += ".SH SYNOPSIS\n" + usage_of(command) + ".SH OPTIONS\n";
    } else {
      text += fmt::format(".SS \"{}\"\n{}\n.PP\n", man_escaped(name_of(command)), man_escaped(command.about)) +
              usage_of(command);
    }
    for (const CommandOption& option : command.options) text += format_option(option);
    if (!command.more.empty()) text += verbatim(command.more);
    if (command.words.empty()) text += ".SH VERBS\n";
  }
  return text;
}

}  // namespace snug::commands
