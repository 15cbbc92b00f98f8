// Runs a reader over its seeds and over the same changes of them every time: the part of fuzzing that each test run
// does.
//
//   fuzz_<reader> FOLDER MUTATIONS     a fuzzer that libFuzzer found something with takes that file as FOLDER
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/rng.hpp"

namespace {

using namespace snug;

const std::vector<std::string> kWords = {"1e999",    "-1",      "nan",  "inf",      "99999999999999999999",
                                         "0",        "[",       "]",    "{",        "}",
                                         ",",        ":",       "\"",   "'",        "\n",
                                         "- ",       "*a",      "&a ",  "<",        "/>",
                                         "&#xd800;", "\\u0000", "\xff", "\xc3\xa9", "\r\n",
                                         " ",        "true",    "null", "#",        "Content-Length: 9\r\n"};

std::string mutated(const std::vector<std::string>& seeds, std::size_t seed, Rng& rng) {
  std::string text = seeds[seed];
  const auto below = [&rng](std::size_t size) { return static_cast<std::size_t>(rng.index(static_cast<int>(size))); };
  for (int change = 1 + rng.index(4); change > 0 && !text.empty(); --change) {
    const std::size_t at = below(text.size());
    switch (rng.index(8)) {
      case 0:
        text[at] =
            static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1U << static_cast<unsigned>(rng.index(8))));
        break;
      case 1:
        text[at] = static_cast<char>(rng.index(256));
        break;
      case 2:
        text.insert(at, kWords[below(kWords.size())]);
        break;
      case 3:
        text.erase(at, 1 + below(16));
        break;
      case 4:
        text.insert(at, text.substr(below(text.size()), 1 + below(64)));
        break;
      case 5:
        text.resize(at);
        break;
      case 6: {
        const std::string& other = seeds[below(seeds.size())];
        if (!other.empty()) text = text.substr(0, at) + other.substr(below(other.size()));
        break;
      }
      default: {  // a number becomes another one
        const std::size_t digit = text.find_first_of("0123456789", at);
        if (digit == std::string::npos) break;
        const std::size_t end = std::min(text.find_first_not_of("0123456789.e", digit), text.size());
        text.replace(digit, end - digit, kWords[below(6)]);
      }
    }
  }
  return text;
}

const std::string* g_input = nullptr;  ///< what the reader is reading

/// A crash leaves the input behind, so that it can be looked at and become a seed.
void keep_input(int signal) {
  std::signal(signal, SIG_DFL);
  if (g_input != nullptr) {
    const int file = ::open("finding", O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const bool is_kept = file >= 0 && ::write(file, g_input->data(), g_input->size()) >= 0;
    constexpr std::string_view kNote = "the input is in the file 'finding'\n";
    if (is_kept) (void)!::write(STDERR_FILENO, kNote.data(), kNote.size());
  }
  ::raise(signal);
}

void run(const std::string& text) {
  g_input = &text;
  (void)LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s FOLDER-OR-FILE MUTATIONS\n", argv[0]);
    return 2;
  }
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(argv[1])) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) files.push_back(entry.path());
  } else {
    files.emplace_back(argv[1]);
  }
  std::sort(files.begin(), files.end());
  std::vector<std::string> seeds;
  for (const std::filesystem::path& file : files) seeds.push_back(read_file(file, "a seed"));
  if (seeds.empty()) {
    std::fprintf(stderr, "%s: no seeds in %s\n", argv[0], argv[1]);
    return 1;
  }
  for (const int signal : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) std::signal(signal, keep_input);
  for (const std::string& seed : seeds) run(seed);
  const int mutations = std::atoi(argv[2]);
  for (int i = 0; i < mutations; ++i) {
    Rng rng = Rng(1).split("mutation " + std::to_string(i));
    run(mutated(seeds, static_cast<std::size_t>(i) % seeds.size(), rng));
  }
  std::printf("%zu seeds and %d mutations of them\n", seeds.size(), mutations);
  return 0;
}
