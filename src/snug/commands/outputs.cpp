// What a verb leaves: files that are reserved before the work begins, and text on stdout.
#include "snug/commands/outputs.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "snug/core/follow_links.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/write_file.hpp"

namespace snug::commands {
namespace {

bool g_is_stdout_reported = false;  ///< what is wrong with it was thrown

[[noreturn]] void fail_stdout() {
  g_is_stdout_reported = true;
  throw OutputError("standard output", std::strerror(errno));
}

bool are_same(const std::filesystem::path& a, const std::filesystem::path& b) {
  struct stat of_a = {}, of_b = {};
  const bool has_a = ::stat(a.c_str(), &of_a) == 0, has_b = ::stat(b.c_str(), &of_b) == 0;
  if (has_a && has_b) return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
  if (has_a != has_b) return false;
  std::error_code error;  // neither is there yet: then their names decide
  return std::filesystem::weakly_canonical(follow_links(a), error) ==
         std::filesystem::weakly_canonical(follow_links(b), error);
}

void expect_other(const NamedFile& output, const NamedFile& other, const char* expected) {
  const auto refuse = [&](const std::string& what) {
    throw InputError("command line", output.word, "'" + output.path.string() + "', " + what + other.word, expected);
  };
  if (are_same(output.path, other.path)) refuse("the same file as ");
  if (are_same(draft_of(output.path), other.path)) refuse("whose draft is the same file as ");
}

}  // namespace

void add_file(NamedFiles& files, const std::string& word, const std::optional<std::string>& path) {
  if (path) files.push_back({word, *path});
}

NamedFiles name_all(const std::string& word, const std::vector<std::string>& paths) {
  NamedFiles files;
  for (const std::string& path : paths) files.push_back({word, path});
  return files;
}

void expect_distinct(const NamedFiles& inputs, const NamedFiles& outputs) {
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (const NamedFile& input : inputs) expect_other(outputs[i], input, "a file that is not read");
    for (std::size_t k = 0; k < i; ++k) expect_other(outputs[i], outputs[k], "a file of its own");
  }
}

OutputFile reserve(const NamedFiles& inputs, const std::string& path) {
  expect_distinct(inputs, {{"-o", path}});
  return {path};
}

std::optional<OutputFile> reserve(const NamedFiles& inputs, const std::optional<std::string>& path) {
  if (!path) return std::nullopt;
  return reserve(inputs, *path);
}

std::optional<OutputFile> reserve(const std::optional<std::string>& path) {
  if (!path) return std::nullopt;
  return OutputFile(*path);
}

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

void make_folder(const std::string& word, const std::filesystem::path& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  std::string reason = error ? error.message() : std::string();
  if (reason.empty() && !std::filesystem::is_directory(path, error)) reason = "not a folder";
  if (reason.empty() && ::access(path.c_str(), W_OK | X_OK) != 0) reason = std::strerror(errno);
  if (!reason.empty())
    throw InputError("command line", word, "'" + path.string() + "': " + reason, "a folder that can be written into");
}

void print(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_stdout();
}

void print_now(std::string_view text) {
  print(text);
  if (std::fflush(stdout) != 0) fail_stdout();
}

void print_or_write(const std::string& text, std::optional<OutputFile> output) {
  if (output)
    write_file(std::move(*output), text);
  else
    print(text);
}

bool flush_stdout() {
  const bool has_failed = std::ferror(stdout) != 0;
  errno = 0;
  if (std::fflush(stdout) == 0 && !has_failed) return true;
  if (g_is_stdout_reported) return false;
  const char* why = errno != 0 ? std::strerror(errno) : "an earlier write failed";
  std::fprintf(stderr, "snug: failed: %s\n", OutputError("standard output", why).what());
  return false;
}

}  // namespace snug::commands
