// Verb: one word of the command line, from its options to its exit code, with the parser behind it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "snug/commands/checks.hpp"

// The parser takes seconds to compile: it is included by the few files that ask it.
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace snug::app {

using namespace commands;  // NOLINT(google-build-using-namespace): the words of every verb

// Bounds of what options count: threads, memory and patience end somewhere.
inline constexpr std::uint64_t kMostThreads = 256;
inline constexpr std::uint64_t kMostRuns = 10'000;       ///< of repeated runs
inline constexpr std::uint64_t kMostSequences = 1000;    ///< about as many as one scenario can hold with their items
inline constexpr std::uint64_t kMostThings = 1'000'000;  ///< frames, problems

enum ExitCode : int {
  kSuccess = 0,    ///< done as asked
  kRunFailed = 1,  ///< the input was fine, the run was not (a lost body, a target missed, a full disk)
  kBadInput = 2,   ///< a word of the command line or a file that cannot be used
};

/// What to do once the whole command line is understood. A verb's add function sets it from the parser's callback.
using Action = std::function<int()>;

/// What an option sets; it outlives the parser.
struct OptionTarget {
  template <class Value>
  OptionTarget(Value& value) : variable(&value) {}  // NOLINT(google-explicit-constructor): written at each option
  std::variant<std::string*, int*, double*, std::uint64_t*, std::vector<std::string>*, std::vector<double>*,
               std::optional<std::string>*, std::optional<int>*, std::optional<double>*, std::optional<std::uint64_t>*>
      variable;
};

/// An option that was declared, and what else is asked of it.
class OptionRow {
 public:
  explicit OptionRow(CLI::Option& option) : option_(&option) {}

  OptionRow required(bool is_required = true) const;
  OptionRow needs(const OptionRow& other) const;
  OptionRow excludes(const OptionRow& other) const;
  OptionRow excludes(const std::vector<std::string>& names) const;
  /// Words with `between` between them are values of their own.
  OptionRow delimiter(char between) const;
  /// From `least` to `most` values.
  OptionRow expected(int least, int most) const;
  OptionRow expected(int count) const { return expected(count, count); }
  /// Each mention takes one value: what follows is a word of its own.
  OptionRow one_each() const;
  /// How often it was said.
  [[nodiscard]] std::size_t count() const;

 private:
  CLI::Option* option_;
};

/// A verb while its options are declared. A handle: copies declare options of the same verb.
class Verb {
 public:
  /// `about`: a line for --help; `more`: what stands below the options, such as examples; empty: as of what it is in.
  Verb(CLI::App& app, Action& action, const std::string& name, const std::string& about, const std::string& more = "");

  /// The word behind the verb, as in `cup evaluate`; one is required unless `is_optional`.
  Verb part(const std::string& name, const std::string& about, const std::string& more = "",
            bool is_optional = false) const;

  /// An option with a value, which --help calls `value`: of one that is not required and has one, it says the default.
  /// `names`: "-o,--output", or a word at its place: "scenario".
  OptionRow option(const char* names, OptionTarget target, const char* value, const std::string& about,
                   const Check& check = {}) const;
  OptionRow flag(const char* names, bool& target, const char* about) const;

  /// Runs `run` with its options, which it keeps and returns, when the parser has met this verb and none of its parts.
  template <class Options>
  Options& runs(int (*run)(const Options&)) const {
    const auto options = std::make_shared<Options>();
    acts([options, run] { return run(*options); });
    return *options;
  }
  template <class Options>
  Options& runs(int (*run)(const Options&, const Verb&)) const {
    const auto options = std::make_shared<Options>();
    acts([options, run, verb = *this] { return run(*options, verb); });
    return *options;
  }
  void acts(Action action) const;
  [[nodiscard]] bool has(const char* option) const;  ///< said

 private:
  CLI::App* app_;
  Action* action_;
};

}  // namespace snug::app
