// completion: a script that lets a shell complete the words of `snug`, made from the parser's own list of them.
#include "snug/commands/completion.hpp"

#include "apps/snug/command_line/command_list.hpp"
#include "apps/snug/command_line/outputs.hpp"
#include "apps/snug/command_line/verbs.hpp"

namespace snug::app {
namespace {

constexpr const char* kCompletionHelp = R"(Installed packages bring these scripts. By hand:
  snug completion bash > ~/.local/share/bash-completion/completions/snug
  snug completion zsh > ~/.zfunc/_snug          (a folder of $fpath)
  snug completion fish > ~/.config/fish/completions/snug.fish)";

struct CompletionOptions {
  std::string shell;
  CLI::App* app = nullptr;  ///< whose words they are
};

int print_completion(const CompletionOptions& options) {
  const auto format = options.shell == "bash"  ? commands::format_bash_completion
                      : options.shell == "zsh" ? commands::format_zsh_completion
                                               : commands::format_fish_completion;
  print(format(list_commands(*options.app)));
  return kSuccess;
}

}  // namespace

void add_completion(CLI::App& app, Action& action) {
  const Verb verb(app, action, "completion", "print the completion script for a shell", kCompletionHelp);
  CompletionOptions& options = verb.runs(print_completion);
  verb.option("shell", options.shell, "SHELL", "bash, zsh or fish", one_of({"bash", "zsh", "fish"})).required();
  options.app = &app;
}

}  // namespace snug::app
