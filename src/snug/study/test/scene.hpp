// A study of a made-up verb in a folder that goes away.
#pragma once

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "snug/core/test/scratch_folder.hpp"
#include "snug/study/run.hpp"

namespace snug::study::test {

using snug::test::ScratchFolder;

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

inline Study grid(int levels, int repeat, int chunk, const std::string& more = "") {
  std::string values;
  for (int i = 0; i < levels; ++i) values += (i > 0 ? ", " : "") + std::to_string(i);
  return parse_study("name: test\nverb: fake\nrepeat: " + std::to_string(repeat) + "\nchunk: " + std::to_string(chunk) +
                         "\nfactors:\n  - {option: --x, values: [" + values +
                         "]}\n  - {option: --w, values: [left, right]}\n" + more,
                     "study.yaml");
}

/// words: fake --x X --w W --seed S --json
inline int fake(const std::vector<std::string>& words) {
  const double x = std::stod(words[2]);
  const bool is_left = words[4] == "left";
  std::printf(
      "{\"y\": %.3f, \"z\": %.17g, \"who\": \"%s\", \"wall_seconds\": %d, \"deep\": {\"list\": [1, 2], \"b\": true}}\n",
      x * x + (is_left ? 0.0 : 10.0), std::stod(words[6]) / 7.0, words[4].c_str(), ::getpid());
  return 0;
}

}  // namespace snug::study::test
