// Completion and manual: each verb, option and choice is there, and no text of theirs ends what stands around it.
#include "snug/commands/completion.hpp"

#include <gtest/gtest.h>

#include "snug/commands/manual.hpp"

namespace snug::commands {
namespace {

CommandList small_program() {
  Command program{{}, "packs boxes", "", {}, {"cup"}};
  program.options.push_back({{"-h", "--help"}, "", {}, "help", false, false});
  Command cup{{"cup"}, "asks the cup's model", "Example:\n  snug cup evaluate", {}, {"evaluate"}};
  Command evaluate{{"cup", "evaluate"}, "a [wrench]: it's", "", {}, {}};
  evaluate.options.push_back({{}, "FILE", {}, "lines", true, true});
  evaluate.options.push_back({{"--law"}, "NAME", {"old", "new"}, "which", false, false});
  evaluate.options.push_back({{"-o", "--output"}, "FILE.csv", {}, "where", true, false});
  return {program, cup, evaluate};
}

void expect_in(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << part << "\nis not in\n" << text;
}

TEST(Completion, OfBashOffersVerbsChoicesAndNames) {
  const std::string text = format_bash_completion(small_program());
  expect_in(text, "'/cup' | 'cup/evaluate')");
  expect_in(text, "'cup evaluate|--law') words='old new' ;;");
  expect_in(text, "'cup evaluate|-o' | 'cup evaluate|--output') return ;;");
  expect_in(text, "'cup') [[ $current == -* ]] && words='' || words='evaluate' ;;");
}

TEST(Completion, OfZshEscapesWhatItsFunctionsRead) {
  const std::string text = format_zsh_completion(small_program());
  expect_in(text, "'evaluate:a \\[wrench\\]\\: it'\"'\"'s'");
  expect_in(text, "'*--law[which]:NAME:(old new)'");
  expect_in(text, "'*'{-o,--output}'[where]:FILE.csv:_files'");
}

TEST(Completion, OfFishHasALineForEachVerbAndOption) {
  const std::string text = format_fish_completion(small_program());
  expect_in(text, "-f -a evaluate -d 'a [wrench]: it'\"'\"'s'\n");
  expect_in(text, " -l law -x -a 'old new' -d 'which'\n");
  expect_in(text, " -s o -l output -r -F -d 'where'\n");
}

TEST(Manual, EscapesWhatManWouldRead) {
  CommandList commands = small_program();
  commands[1].more = ".TH is no heading\na \\ b";
  const std::string text = format_manual(commands, "1.2");
  EXPECT_EQ(text.find(".TH SNUG 1 \"\" \"snug 1.2\"\n.SH NAME\nsnug \\- packs boxes\n"), 0U) << text;
  expect_in(text, ".EX\n\\&.TH is no heading\na \\e b\n.EE\n");
  expect_in(text, ".SS \"snug cup evaluate\"\n");
  expect_in(text, ".BI \"\\-\\-law\" \" NAME\"\nwhich; one of old, new\n");
  expect_in(text, "[options] FILE\n");
}

}  // namespace
}  // namespace snug::commands
