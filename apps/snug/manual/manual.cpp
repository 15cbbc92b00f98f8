// manual: the manual page, made from what `--help` of each verb says.
#include "snug/commands/manual.hpp"

#include "apps/snug/command_line/command_list.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/verbs.hpp"
#include "apps/snug/command_line/version.hpp"

namespace snug::app {
namespace {

constexpr const char* kManualExamples = R"(Examples:
  snug manual | man -l -
  snug manual > snug.1)";

}  // namespace

void add_manual(CLI::App& app, Action& action) {
  const Verb verb(app, action, "manual", "print the manual page in the format of man(7)", kManualExamples);
  verb.acts([&app] {
    print(commands::format_manual(list_commands(app), version_text()));
    return kSuccess;
  });
}

}  // namespace snug::app
