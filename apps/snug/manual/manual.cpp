// manual: the manual page, made from what `--help` of each verb says.
#include "apps/snug/command_line/verbs.hpp"

#include "apps/snug/command_line/command_list.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/version.hpp"

#include <fmt/format.h>

namespace snug::app {
namespace {

constexpr const char* kManualExamples = R"(Examples:
  snug manual | man -l -
  snug manual > snug.1)";

/// Letters that mean something to man(7), made to mean themselves; `-` is the one that can be pasted into a shell.
std::string escaped(const std::string& text) {
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

std::string verbatim(const std::string& text) { return ".PP\n.EX\n" + escaped(text) + "\n.EE\n"; }

std::string heading_of(const CommandOption& option) {
  std::string names;
  for (const std::string& name : option.names) names += (names.empty() ? "" : ", ") + name;
  if (names.empty()) return fmt::format(".I {}\n", escaped(option.value));
  if (option.value.empty()) return fmt::format(".B {}\n", escaped(names));
  return fmt::format(".BI \"{}\" \" {}\"\n", escaped(names), escaped(option.value));
}

std::string format_option(const CommandOption& option) {
  std::string about = option.about;
  if (!option.choices.empty()) {
    about += about.empty() ? "one of" : "; one of";
    for (const std::string& choice : option.choices) about += (choice == option.choices.front() ? " " : ", ") + choice;
  }
  return ".TP\n" + heading_of(option) + escaped(about.empty() ? option.value : about) + "\n";
}

std::string name_of(const Command& command) {
  std::string name = "snug";
  for (const std::string& word : command.words) name += " " + word;
  return name;
}

std::string usage_of(const Command& command) {
  std::string usage = fmt::format(".B {}\n", escaped(name_of(command)));
  if (!command.verbs.empty()) usage += ".I VERB\n";
  usage += "[options]";
  for (const CommandOption& option : command.options) {
    if (option.names.empty())
      usage += (option.is_required ? " " : " [") + escaped(option.value) + (option.is_required ? "" : "]");
  }
  return usage + "\n";
}

/// In the language of man(7).
std::string format_manual(const std::vector<Command>& commands, const std::string& version) {
  std::string text;
  for (const Command& command : commands) {
    if (command.words.empty()) {
      text += fmt::format(".TH SNUG 1 \"\" \"snug {}\"\n.SH NAME\nsnug \\- {}\n", version, escaped(command.about));
      text += ".SH SYNOPSIS\n" + usage_of(command) + ".SH OPTIONS\n";
    } else {
      text +=
          fmt::format(".SS \"{}\"\n{}\n.PP\n", escaped(name_of(command)), escaped(command.about)) + usage_of(command);
    }
    for (const CommandOption& option : command.options) text += format_option(option);
    if (!command.more.empty()) text += verbatim(command.more);
    if (command.words.empty()) text += ".SH VERBS\n";
  }
  return text;
}

}  // namespace

void add_manual(CLI::App& app, Action& action) {
  const Verb verb(app, action, "manual", "print this manual in the language of man(7)", kManualExamples);
  verb.acts([&app] {
    print(format_manual(list_commands(app), version_text()));
    return kSuccess;
  });
}

}  // namespace snug::app
