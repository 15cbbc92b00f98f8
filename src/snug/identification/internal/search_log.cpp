// SearchLog: one line a point, numbers that read back to the same double.
#include "snug/identification/internal/search_log.hpp"

#include <fmt/format.h>

#include <charconv>

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

SearchLog::SearchLog(const std::filesystem::path& path, const std::string& what) {
  if (path.empty()) return;
  Hash problem;
  problem.add(std::string_view(what));
  const std::string title =
      fmt::format("# snug identify scene, points tried: cost, parameters; of problem {:016x}\n", problem.value());
  std::string kept = title;
  if (std::filesystem::exists(path)) {
    const std::string text = read_file(path, "the log of a search");
    if (!text.starts_with(title))
      throw InputError(path.string(), "", "the log of another task, or no log", "a log of this task, or a new file");
    for (std::size_t at = title.size(); at < text.size();) {
      const std::size_t end = text.find('\n', at);
      if (end == std::string::npos) break;  // cut when the program was
      const std::string_view line = std::string_view(text).substr(at, end - at);
      const auto numbers = read_line(line);
      if (!numbers || numbers->size() < 2)
        throw InputError(path.string(), "", "'" + std::string(line.substr(0, 60)) + "'", "numbers: cost, parameters");
      costs_.emplace(std::vector<double>(numbers->begin() + 1, numbers->end()), numbers->front());
      at = end + 1;
      kept = text.substr(0, at);
    }
  }
  file_.open(path, std::ios::binary | std::ios::trunc);
  file_ << kept << std::flush;
  if (!file_) throw InputError(path.string(), "", "a file that cannot be written", "a place for the log");
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
  file_ << line << "\n" << std::flush;
  if (!file_) throw OutputError("the log of the search", "could not be written");
}

}  // namespace snug::identification::internal
