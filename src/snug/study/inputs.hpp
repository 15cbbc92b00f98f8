// Inputs: what a row is a function of besides its words, and whether the rows of a study are of one world.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace snug::study {

/// The files that a row read, and the program that did it.
struct Inputs {
  std::string version;                         ///< of the program
  std::map<std::string, std::uint64_t> files;  ///< hashes of their bytes, by the path as it was named
  /// Of version and files, 16 hexadecimal digits; of a path its last name only, so that it is the same where the files
  /// lie in another folder.
  [[nodiscard]] std::string hash() const;
  bool operator==(const Inputs&) const = default;
};

/// A line of a table, before the first row that has these inputs.
[[nodiscard]] std::string format_inputs(const Inputs& inputs, std::uint64_t first_row);
struct InputsLine {
  Inputs inputs;
  std::uint64_t first_row = 0;
};
/// Nothing for another line, or one that is not whole.
[[nodiscard]] std::optional<InputsLine> parse_inputs(const std::string& line);

/// Compares the inputs of rows with each other: a file that two rows read has to have had the same bytes for both, and
/// one program has to have done them all.
class OneWorld {
 public:
  /// `folder`: for messages.
  explicit OneWorld(std::string folder) : folder_(std::move(folder)) {}
  /// Throws InputError that names the file or the versions, and the rows.
  void add(const Inputs& inputs, std::uint64_t row);
  /// Of rows by a program that did not write down what they read.
  void add_unknown(std::uint64_t row);
  /// Throws InputError where a file is not what it was, or this program is another one.
  void expect_now(const std::string& version) const;

 private:
  struct Seen {
    std::uint64_t hash = 0, row = 0;
  };
  std::string folder_;
  std::map<std::string, Seen> files_;
  std::optional<std::pair<std::string, std::uint64_t>> version_;  ///< with the row that has it
  std::optional<std::uint64_t> unknown_;
};

}  // namespace snug::study
