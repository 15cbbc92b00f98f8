// Study: many runs of one verb of the program, each a pure function of its index.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace snug::study {

enum class Design {
  Grid,    ///< every combination of the factors' values, the last factor changing fastest
  List,    ///< the points that are listed
  Random,  ///< each factor drawn by itself
  Sobol,   ///< factors fill the cube evenly
};

/// Something that differs from row to row.
struct Factor {
  std::string name;
  std::string option;               ///< of the verb, such as --agent; or empty
  std::string key;                  ///< of the scenario, set with --set; or empty
  std::vector<std::string> values;  ///< to choose from; or none:
  double from = 0.0, to = 1.0;      ///< a range
  bool is_log = false;              ///< even in the logarithm
  bool is_whole = false;            ///< rounded to whole numbers
  bool operator==(const Factor&) const = default;
};

/// A number of a row's result that is kept.
struct Output {
  std::string name;          ///< path in the JSON of the verb, such as monte_carlo.success_percent
  bool is_worst_low = true;  ///< which end of it the report calls worst
  bool operator==(const Output&) const = default;
};

/// Whose runs have the same seed.
enum class SeedBy {
  Row,     ///< nobody's
  Repeat,  ///< those of the same repetition at all points: differences are then due to the factors
};

struct Study {
  std::string name;
  std::string source;  ///< file it was read from
  std::string text;    ///< of the file
  std::string verb;
  std::string scenario;              ///< or empty: the verb takes none
  std::vector<std::string> options;  ///< words that all rows have
  Design design = Design::Grid;
  std::vector<Factor> factors;
  std::vector<std::vector<std::string>> points;  ///< List: a value for each factor
  std::uint64_t point_count = 0;
  int repeat = 1;
  std::uint64_t seed = 1;
  std::string seed_option = "--seed";  ///< gets the row's seed; empty: none does
  SeedBy seed_by = SeedBy::Row;
  std::vector<Output> outputs;                             ///< empty: all numbers of the result but those of clocks
  int chunk = 1;                                           ///< rows of a table
  double time_limit = 0.0;                                 ///< s of a row; 0: none
  std::vector<std::pair<std::string, std::string>> slurm;  ///< more options of sbatch

  [[nodiscard]] std::uint64_t rows() const { return point_count * static_cast<std::uint64_t>(repeat); }
  [[nodiscard]] std::uint64_t chunks() const {
    return (rows() + static_cast<std::uint64_t>(chunk) - 1) / static_cast<std::uint64_t>(chunk);
  }
};

/// Rows of a study at most.
inline constexpr std::uint64_t kMostRows = 10'000'000;

/// Reads a study (docs/studies.md). Throws InputError with file, line and key.
[[nodiscard]] Study load_study(const std::filesystem::path& path);
[[nodiscard]] Study parse_study(std::string_view text, const std::string& name);

/// A study of listed points, as a program makes it.
struct ListDesign {
  std::string name, verb, scenario;
  std::vector<std::pair<std::string, std::string>> options;  ///< that all rows have, with their values
  std::vector<std::string> factors;                          ///< options of the verb
  std::vector<std::vector<std::string>> points;              ///< a value for each factor
  std::vector<Output> outputs;
};
/// The study, and as its text the file that parse_study() reads as the same one. Needs at least one point.
[[nodiscard]] Study make_list_study(const ListDesign& design);

/// Rows of a table where a study does not say: about a thousand tables at most, and not more rows in one than are lost
/// with pleasure.
[[nodiscard]] int default_chunk(std::uint64_t rows);

/// First and last of "12" or "3-7". Throws InputError for what is none, or beyond the study's chunks.
[[nodiscard]] std::pair<std::uint64_t, std::uint64_t> parse_chunks(const std::string& words, const Study& study);

struct Row {
  std::uint64_t index = 0, point = 0;
  int repeat = 0;
  std::uint64_t seed = 0;
  std::vector<std::string> values;  ///< of the factors
};
/// Row `index` (below rows()).
[[nodiscard]] Row row_of(const Study& study, std::uint64_t index);
/// The words behind `snug` that do it, without --json.
[[nodiscard]] std::vector<std::string> words_of(const Study& study, const Row& row);
/// The same as a line for a shell.
[[nodiscard]] std::string command_of(const Study& study, const Row& row);
/// A word as a shell takes it.
[[nodiscard]] std::string quoted(const std::string& word);

}  // namespace snug::study
