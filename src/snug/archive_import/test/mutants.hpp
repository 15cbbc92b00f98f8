// Texts with a few bytes changed, as cut files, wrong editors and attackers change them.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/core/text.hpp"

namespace snug::archive_import::test {

/// One to four changes: a byte, one of `words` put in, up to eight bytes taken out.
inline std::string mutate(std::string text, const std::vector<std::string>& words, Rng& rng) {
  for (int change = 1 + rng.index(4); change > 0 && !text.empty(); --change) {
    const auto at = static_cast<std::size_t>(rng.index(static_cast<int>(text.size())));
    switch (rng.index(3)) {
      case 0:
        text[at] = static_cast<char>(rng.index(256));
        break;
      case 1:
        text.insert(at, words[static_cast<std::size_t>(rng.index(static_cast<int>(words.size())))]);
        break;
      default:
        text.erase(at, 1 + static_cast<std::size_t>(rng.index(8)));
    }
  }
  return text;
}

/// `read` takes each of `count` mutants of `seed`, or refuses it with an InputError in UTF-8. Returns how many it took.
template <class Read>
int expect_answers(const std::string& seed, const std::vector<std::string>& words, int count, Read read) {
  int taken = 0;
  for (int i = 0; i < count; ++i) {
    Rng rng = Rng(1).split("mutant " + std::to_string(i));
    const std::string text = mutate(seed, words, rng);
    SCOPED_TRACE(i);
    try {
      read(text);
      ++taken;
    } catch (const InputError& error) {
      EXPECT_TRUE(is_utf8(error.what()));
    }
  }
  return taken;
}

}  // namespace snug::archive_import::test
