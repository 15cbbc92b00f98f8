// parse: what is a program, and what is said where it is none.
#include "snug/urscript/program.hpp"

#include <gtest/gtest.h>

#include "snug/core/rng.hpp"
#include "snug/urscript/test/fake_host.hpp"

namespace snug::urscript {
namespace {

ScriptError error_of(std::string_view text) {
  auto program = parse(text);
  return program ? ScriptError{} : program.error();
}

TEST(UrScriptProgram, NamesAndKinds) {
  auto program = parse("# a comment\ndef move_it():\n  sleep(1)\nend\n");
  ASSERT_TRUE(program);
  EXPECT_EQ(program->name(), "move_it");
  EXPECT_FALSE(program->is_secondary());
  auto secondary = parse("sec outputs():\n  set_digital_out(0, True)\nend\n");
  ASSERT_TRUE(secondary);
  EXPECT_TRUE(secondary->is_secondary());
  EXPECT_TRUE(parse("set_digital_out(2, False)\n"));
  EXPECT_TRUE(parse("def p():\nend\np()\n"));
  // As a client of UR sends it: a value on the next line, a statement behind it.
  EXPECT_TRUE(parse("def p():\n  global a = # offset\n0  global b = # more\n0  global c = 2\n  textmsg(a + b)\nend\n"));
}

TEST(UrScriptProgram, MistakesHaveALineAndAColumn) {
  EXPECT_EQ(error_of("def p():\n  x = 1 +\nend\n").line, 3);
  const ScriptError unknown = error_of("def p():\n  mvoej([0,0,0,0,0,0])\nend\n");
  EXPECT_EQ(unknown.line, 2);
  EXPECT_EQ(unknown.column, 3);
  EXPECT_NE(unknown.text.find("movej"), std::string::npos) << unknown.text;
  EXPECT_NE(error_of("def p():\n  if True:\n    sync()\n").text, "");
  EXPECT_NE(error_of("def p():\n  y = x\nend\n").text, "");
  EXPECT_NE(error_of("def p():\nend\nmovej([0,0,0,0,0,0])\n").text, "");
  EXPECT_NE(error_of("def p():\n  x = \"open\nend\n").text, "");
  EXPECT_NE(error_of("def p():\n  break\nend\n").text, "");
  EXPECT_NE(error_of(std::string(100000, '(')).text, "");
  EXPECT_NE(error_of(std::string(5'000'000, ' ')).text, "");
}

TEST(UrScriptProgram, WordsOfBlocksOutsideOfOneAreMistakes) {
  for (const char* text : {"else\n", "end\n", "sync()\nelif True:\n  sync()\n", "x = 1 end\n"})
    EXPECT_NE(error_of(text).text, "") << text;
  EXPECT_EQ(error_of("sync()\nelse:\n").line, 2);
}

TEST(UrScriptProgram, ProgramsEndWhereTheirBlocksDo) {
  const std::string text = "def p():\n  while True:\n    sync()\n  end\nend\n";
  EXPECT_EQ(find_program_end(text + "movej([0,0,0,0,0,0])\n"), text.size());
  EXPECT_EQ(find_program_end(text.substr(0, text.size() - 2)), 0U);
  const std::string short_blocks = "def p():\n  if True: sync() end  # end\n  textmsg(\"if def\")\nend\n";
  EXPECT_EQ(find_program_end(short_blocks + "x"), short_blocks.size());
  EXPECT_EQ(find_program_end("\n# x\nsleep(1)\ndef"), 14U);
}

TEST(UrScriptProgram, MutatedProgramsNeitherCrashNorHang) {
  const std::string text =
      "def p(): # c\n  global a = [1, 2.5, p[0,0,0,0,0,1]]\n  thread t(): while a[0] < 9: a[0] = a[0] + 1\n sync() end "
      "end\n"
      "  def f(x, y=2): local z = -x * y % 3\n return z end\n  h = run t()\n  b = f(1, y = 3) >= 2 and not (True xor "
      "False)\n"
      "  if b: movej([0.1,0,0,0,0,0], a=1, v=2, r=0.01)\n elif a[1] == \"s\": halt\n else: kill h\n end\n  join h\n"
      "  textmsg(str_cat(to_str(a), \"x\"), pose_trans(p[1,0,0,0,0,0], a[2]))\n  servoj([0,0,0,0,0,0.1], "
      "t=0.008)\nend\n";
  Rng rng(1);
  int parsed = 0;
  for (int k = 0; k < 3000; ++k) {
    std::string mutant = text;
    for (int change = rng.index(2); change >= 0 && !mutant.empty(); --change) {
      const auto at = static_cast<std::size_t>(rng.index(static_cast<int>(mutant.size())));
      const auto other = static_cast<std::size_t>(rng.index(static_cast<int>(text.size())));
      const int kind = rng.index(4);
      if (kind == 0) mutant[at] = static_cast<char>(rng.index(256));
      if (kind == 1) mutant.erase(at, static_cast<std::size_t>(rng.index(8)));
      if (kind == 2) mutant.insert(at, text.substr(other, static_cast<std::size_t>(rng.index(12))));
      if (kind == 3) mutant[at] = text[other];
    }
    auto program = parse(mutant);
    if (!program) {
      EXPECT_FALSE(program.error().text.empty());
      continue;
    }
    ++parsed;
    test::FakeHost host;
    MachineLimits limits;
    limits.instructions_per_step = 2000;
    Machine machine(std::move(*program), limits);
    (void)host.run(machine, 50);
  }
  EXPECT_GT(parsed, 100);
}

}  // namespace
}  // namespace snug::urscript
