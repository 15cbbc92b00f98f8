// list_commands: verbs and options as the parser knows them, as plain data.
#include "apps/snug/command_line/command_list.hpp"

#include <CLI/CLI.hpp>

namespace snug::app {
namespace {

using commands::Command;
using commands::CommandList;
using commands::CommandOption;

/// The words of the checks of an option.
std::vector<std::string> choices_of(CLI::Option& option) {
  std::vector<std::string> words;
  try {
    for (int i = 0;; ++i) {
      const std::vector<std::string> more = commands::choices_in(option.get_validator(i)->get_name());
      words.insert(words.end(), more.begin(), more.end());
    }
  } catch (const CLI::OptionNotFound&) {  // the parser has no other way to say that there are no more
  }
  return words;
}

CommandOption describe(CLI::Option& option) {
  CommandOption described;
  for (const std::string& name : option.get_snames()) described.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) described.names.push_back("--" + name);
  if (option.get_items_expected_max() > 0) {  // none: a flag
    described.value = option.get_type_name();
    if (described.value.empty() || described.value == "TEXT") described.value = "VALUE";
  }
  described.choices = choices_of(option);
  described.about = option.get_description();
  const std::string& value = described.value;
  described.takes_file = value.rfind("FILE", 0) == 0 || value == "DIR" || value == "ORDERS" ||
                         (value.find('.') != std::string::npos && value.find("..") == std::string::npos);
  described.is_required = option.get_required();
  return described;
}

void add(CLI::App& app, const std::vector<std::string>& words, CommandList& commands) {
  Command command;
  command.words = words;
  command.about = app.get_description();
  command.more = app.get_footer();
  for (CLI::Option* option : app.get_options({})) command.options.push_back(describe(*option));
  const std::vector<CLI::App*> parts = app.get_subcommands([](CLI::App*) { return true; });
  for (const CLI::App* part : parts) command.verbs.push_back(part->get_name());
  commands.push_back(command);
  for (CLI::App* part : parts) {
    std::vector<std::string> longer = words;
    longer.push_back(part->get_name());
    add(*part, longer, commands);
  }
}

}  // namespace

CommandList list_commands(CLI::App& app) {
  CommandList commands;
  add(app, {}, commands);
  return commands;
}

}  // namespace snug::app
