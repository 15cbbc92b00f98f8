// SearchLog: one line a point, numbers that read back to the same double.
#include "snug/identification/internal/search_log.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>

#include "snug/core/file_lock.hpp"
#include "snug/core/hash.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/output_file.hpp"
#include "snug/core/read_file.hpp"

namespace snug::identification::internal {
namespace {

std::vector<double> as_key(const Eigen::VectorXd& point) { return {point.data(), point.data() + point.size()}; }

/// The numbers of a line, or nothing when it is none of ours.
std::optional<std::vector<double>> read_line(std::string_view line) {
  std::vector<double> numbers;
  const char *at = line.data(), *end = line.data() + line.size();
  while (at < end) {
    double value = 0.0;
    const auto [next, error] = std::from_chars(at, end, value);
    if (error != std::errc() || (next != end && *next != ',')) return std::nullopt;
    numbers.push_back(value);
    at = next == end ? end : next + 1;
  }
  return numbers;
}

}  // namespace

SearchLog::SearchLog(const std::filesystem::path& path, const std::string& what) : path_(path) {
  if (path.empty()) return;
  Hash problem;
  problem.add(std::string_view(what));
  const std::string title =
      fmt::format("# snug identify scene, points tried: cost, parameters; of problem {:016x}\n", problem.value());
  const auto refuse = [&](const char* got, const char* expected) {
    throw InputError(path.string(), "", got, expected);
  };
  // Not opened before it is known to be a file: a pipe would wait for a reader.
  const bool was_there = std::filesystem::exists(path);
  if (was_there) check_readable(path, "the log of a search", kLargestText);
  file_ = Descriptor(::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
  if (!file_.is_open()) refuse(std::strerror(errno), "a place for the log");
  if (!try_lock(file_.get(), LockByte::Writer, LockKind::Exclusive))
    refuse("a file that another run is writing", "one that nobody else writes");
  const std::size_t whole = was_there ? read(path, title) : 0;
  if (::ftruncate(file_.get(), static_cast<off_t>(whole)) != 0) refuse(std::strerror(errno), "a place for the log");
  if (whole == 0) write(title);
}

std::size_t SearchLog::read(const std::filesystem::path& path, const std::string& title) {
  const std::string text = read_file(path, "the log of a search");
  if (text.size() < title.size() && title.starts_with(text)) return 0;  // cut when it was begun
  if (!text.starts_with(title))
    throw InputError(path.string(), "", "the log of another task, or no log", "a log of this task, or a new file");
  std::size_t at = title.size();
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) break;  // cut when the program was
    const std::string_view line = std::string_view(text).substr(at, end - at);
    const auto numbers = read_line(line);
    if (!numbers || numbers->size() < 2)
      throw InputError(path.string(), "", "'" + std::string(line.substr(0, 60)) + "'", "numbers: cost, parameters");
    costs_.emplace(std::vector<double>(numbers->begin() + 1, numbers->end()), numbers->front());
    at = end + 1;
  }
  return at;
}

void SearchLog::write(const std::string& text) const {
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t count = ::write(file_.get(), text.data() + sent, text.size() - sent);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw OutputError(path_.string(), count < 0 ? std::strerror(errno) : "the disk is full");
    sent += static_cast<std::size_t>(count);
  }
}

std::optional<double> SearchLog::find(const Eigen::VectorXd& point) const {
  const auto found = costs_.find(as_key(point));
  if (found == costs_.end()) return std::nullopt;
  return found->second;
}

void SearchLog::add(const Eigen::VectorXd& point, double cost) {
  costs_.emplace(as_key(point), cost);
  if (!file_.is_open()) return;
  std::string line = fmt::format("{}", cost);
  for (const double value : point) line += fmt::format(",{}", value);
  write(line + "\n");
}

}  // namespace snug::identification::internal
