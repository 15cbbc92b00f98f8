// SearchLog: points that a search has tried, in a file that outlives it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "snug/core/descriptor.hpp"

namespace snug::identification::internal {

class SearchLog {
 public:
  /// An empty path keeps the points in memory only. `what` tells one problem from another (names, bounds, recordings):
  /// a file that was written for another one, or that another search writes, is refused (InputError), a last line that
  /// was cut is taken away. Nothing else of the file is ever written again.
  SearchLog(const std::filesystem::path& path, const std::string& what);
  [[nodiscard]] std::optional<double> find(const Eigen::VectorXd& point) const;
  void add(const Eigen::VectorXd& point, double cost);
  [[nodiscard]] std::size_t size() const { return costs_.size(); }

 private:
  /// The points of a file; returns how many of its bytes are whole lines.
  std::size_t read(const std::filesystem::path& path, const std::string& title);
  void write(const std::string& text) const;

  std::map<std::vector<double>, double> costs_;
  std::filesystem::path path_;
  Descriptor file_;
};

}  // namespace snug::identification::internal
