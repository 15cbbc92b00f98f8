// Damaged files: whatever is cut, changed or repeated, the loader answers with a scenario or an InputError.
#include <gtest/gtest.h>

#include "scenario_text.hpp"
#include "snug/core/rng.hpp"

namespace snug::model {
namespace {

std::string mutated(std::string text, Rng& rng) {
  const auto place = [&] { return static_cast<std::size_t>(rng.index(static_cast<int>(text.size()))); };
  static const std::string kBits = "{}[]:,-&*!|>'\"#%@`?~\t\n 0e.+x";
  const int changes = 1 + rng.index(4);
  for (int i = 0; i < changes && !text.empty(); ++i) {
    const std::size_t at = place();
    switch (rng.index(6)) {
      case 0:
        text.resize(at);
        break;
      case 1:
        text[at] = kBits[static_cast<std::size_t>(rng.index(static_cast<int>(kBits.size())))];
        break;
      case 2:
        text[at] = static_cast<char>(rng.index(256));
        break;
      case 3:
        text.erase(at, 1 + static_cast<std::size_t>(rng.index(40)));
        break;
      case 4:
        text.insert(at, text.substr(place(), static_cast<std::size_t>(rng.index(80))));
        break;
      default:
        text.insert(at, 1, kBits[static_cast<std::size_t>(rng.index(static_cast<int>(kBits.size())))]);
    }
  }
  return text;
}

void expect_answer(const std::string& text, int& accepted, int& refused) {
  try {
    (void)parse_scenario(text, "damaged.yaml");
    ++accepted;
  } catch (const InputError& error) {
    ++refused;
    EXPECT_EQ(error.where.substr(0, 12), "damaged.yaml");
    EXPECT_FALSE(error.expected.empty());
  }
  // Anything else that is thrown, or a crash, fails the test.
}

TEST(DamagedFiles, NeverCrashTheLoader) {
  Rng rng = Rng(11).split("damage");
  int accepted = 0;
  int refused = 0;
  const std::string cell = test::read_text(test::project_file("scenarios/box-demonstrator.yaml"));
  const std::string spring = test::read_text(test::project_file("scenarios/bench/s6b.yaml"));
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    expect_answer(mutated(cell, rng), accepted, refused);
    expect_answer(mutated(spring, rng), accepted, refused);
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(accepted, 100);  // comments and harmless digits: the mutations are not all gross
}

TEST(DamagedFiles, DeepNestingAndHugeRepetitionAreRefused) {
  int accepted = 0;
  int refused = 0;
  for (const char* piece : {"[", "{", "- ", "? ", "&a [*a, ", "{a: ", "!!", "'"}) {
    std::string text;
    for (int i = 0; i < 20000; ++i) text += piece;
    expect_answer(text, accepted, refused);
  }
  expect_answer("bodies: &a\n  - *a\n", accepted, refused);
  expect_answer(std::string("name: a\0b\n", 10), accepted, refused);
  EXPECT_EQ(accepted, 0);
}

}  // namespace
}  // namespace snug::model
