// Instances: problems of loading a container, read from the public text form and from orders.
#include "snug/packing/instances.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/read_file.hpp"
#include "snug/core/text.hpp"

namespace snug::packing {
namespace {

constexpr int kMostProblems = 100000;

/// Whole numbers separated by blanks, and the line each stands in.
class Numbers {
 public:
  Numbers(std::string_view text, std::string name) : text_(text), name_(std::move(name)) {}

  int next(const char* what, int low, int high) {
    skip_blanks();
    if (text_.empty()) throw InputError(where(), what, "the end of the file", "a whole number");
    const std::size_t end = std::min(text_.find_first_of(" \t\r\n"), text_.size());
    const std::string_view word = text_.substr(0, end);
    text_.remove_prefix(end);
    long long value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || stop != word.data() + word.size() || value < low || value > high) {
      throw InputError(where(), what, "'" + std::string(word.substr(0, 40)) + "'",
                       "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    }
    return static_cast<int>(value);
  }
  void expect_end() {
    skip_blanks();
    if (!text_.empty()) throw InputError(where(), "", "more numbers", "the end of the file");
  }

 private:
  [[nodiscard]] std::string where() const { return name_ + ":" + std::to_string(line_); }
  void skip_blanks() {
    while (!text_.empty() &&
           (text_.front() == ' ' || text_.front() == '\t' || text_.front() == '\r' || text_.front() == '\n')) {
      if (text_.front() == '\n') ++line_;
      text_.remove_prefix(1);
    }
  }
  std::string_view text_;
  std::string name_;
  int line_ = 1;
};

constexpr int kLongest = 100000;

}  // namespace

std::vector<LoadProblem> parse_instances(std::string_view text, const std::string& name) {
  check_utf8(text, name);
  Numbers numbers(text, name);
  const int count = numbers.next("number of problems", 1, kMostProblems);
  std::vector<LoadProblem> problems;
  for (int i = 0; i < count; ++i) {
    LoadProblem problem;
    const int index = numbers.next("problem", 0, kMostProblems);
    problem.name = std::filesystem::path(name).stem().string() + " " + std::to_string(index);
    (void)numbers.next("seed", 0, 2000000000);
    for (int& edge : problem.container) edge = numbers.next("edge of the container", 1, kLongest);
    const int types = numbers.next("number of box types", 1, 1000);
    for (int t = 0; t < types; ++t) {
      CargoType type;
      type.name = std::to_string(numbers.next("box type", 0, kMostProblems));
      for (std::size_t d = 0; d < 3; ++d) {
        type.size[d] = numbers.next("edge of a box", 1, kLongest);
        type.may_be_vertical[d] = numbers.next("whether it may stand upright", 0, 1) == 1;
      }
      type.count = numbers.next("number of boxes", 0, 5000);
      problem.types.push_back(type);
    }
    problems.push_back(problem);
  }
  numbers.expect_end();
  return problems;
}

std::vector<LoadProblem> load_instances(const std::filesystem::path& path) {
  return parse_instances(read_file(path, "instances in the thpack form"), path.string());
}

std::vector<LoadProblem> problems_of(const std::vector<model::OrderLine>& lines, const Vector3& container) {
  // What is measured in parts of a millimetre must still fit: boxes count as larger, the container as smaller.
  constexpr double kRounding = 1e-6;  // mm, of the conversion from metres
  const auto up = [](double metres) { return static_cast<int>(std::ceil(1e3 * metres - kRounding)); };
  const auto down = [](double metres) { return static_cast<int>(std::floor(1e3 * metres + kRounding)); };
  if (!(container.minCoeff() > 0.0 && container.maxCoeff() <= 1e-3 * kLongest)) {
    throw InputError("command line", "--container", "a length out of range", "lengths above 0, at most 1 km");
  }
  std::vector<LoadProblem> problems;
  using Kind = std::tuple<std::size_t, std::array<int, 3>, std::array<bool, 3>, std::string>;  // of which problem
  std::map<std::string, std::size_t> of_orders;
  std::map<Kind, std::size_t> of_kinds;
  for (const model::OrderLine& line : lines) {
    const auto [order, is_new_order] = of_orders.try_emplace(line.order, problems.size());
    if (is_new_order) {
      problems.push_back({line.order, {}, {}});
      for (int d = 0; d < 3; ++d) problems.back().container[static_cast<std::size_t>(d)] = down(container[d]);
    }
    LoadProblem& problem = problems[order->second];
    if (line.handling.no_stack || line.handling.max_load) {
      throw InputError(line.order, line.article, "a box that must not carry any load",
                       "boxes without no_stack and max_load_kg: loads are not looked at here (snug pack does)");
    }
    CargoType type;
    type.name = line.article;
    for (int d = 0; d < 3; ++d) type.size[static_cast<std::size_t>(d)] = up(line.size[d]);
    if (line.handling.upright_only) type.may_be_vertical = {false, false, true};
    const auto [kind, is_new] =
        of_kinds.try_emplace({order->second, type.size, type.may_be_vertical, type.name}, problem.types.size());
    if (is_new) problem.types.push_back(std::move(type));
    problem.types[kind->second].count += line.count;
  }
  return problems;
}

int drop_load_limits(std::vector<model::OrderLine>& lines) {
  int limited = 0;
  for (model::OrderLine& line : lines) {
    if (!line.handling.no_stack && !line.handling.max_load) continue;
    limited += line.count;
    line.handling.no_stack = false;
    line.handling.max_load.reset();
  }
  return limited;
}

}  // namespace snug::packing
