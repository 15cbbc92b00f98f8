// What a verb leaves: files that are reserved before the work begins, and text on stdout.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "snug/core/output_file.hpp"

namespace snug::commands {

/// A file and the word of the command line that named it.
struct NamedFile {
  std::string word;
  std::filesystem::path path;
};
using NamedFiles = std::vector<NamedFile>;

/// Adds a file, if it was asked for.
void add_file(NamedFiles& files, const std::string& word, const std::optional<std::string>& path);
/// Files that one word names.
[[nodiscard]] NamedFiles name_all(const std::string& word, const std::vector<std::string>& paths);

/// Throws InputError when an output is one of the inputs or another output, also under another name (links).
void expect_distinct(const NamedFiles& inputs, const NamedFiles& outputs);

/// The file of -o where that is the only output; none if it was not given.
[[nodiscard]] OutputFile reserve(const NamedFiles& inputs, const std::string& path);
[[nodiscard]] std::optional<OutputFile> reserve(const NamedFiles& inputs, const std::optional<std::string>& path);
/// The file of an option that was given and checked with the others.
[[nodiscard]] std::optional<OutputFile> reserve(const std::optional<std::string>& path);

/// The last part of a path, as it is shown.
[[nodiscard]] std::string file_name(const std::string& path);

/// Makes the folder that `word` of the command line names, if it is not there. Throws InputError when that fails, and
/// when nothing could be put into it.
void make_folder(const std::string& word, const std::filesystem::path& path);

/// To the file of -o, or to stdout where it was not given.
void print_or_write(const std::string& text, std::optional<OutputFile> output);

/// To stdout. Throws OutputError when it cannot be written.
void print(std::string_view text);
/// The same, seen at once by who reads along.
void print_now(std::string_view text);
/// Writes what is still to be written; to be called once, at the end. False when that, or anything before, failed: then
/// stderr has the reason.
[[nodiscard]] bool flush_stdout();

}  // namespace snug::commands
