// SearchLog: points that a search has tried, in a file that outlives it.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace snug::identification::internal {

class SearchLog {
 public:
  /// An empty path keeps the points in memory only. `what` tells one problem from another (names, bounds, recordings):
  /// a file that was written for another one is refused (InputError), a last line that was cut is taken away.
  SearchLog(const std::filesystem::path& path, const std::string& what);
  [[nodiscard]] std::optional<double> find(const Eigen::VectorXd& point) const;
  void add(const Eigen::VectorXd& point, double cost);
  [[nodiscard]] std::size_t size() const { return costs_.size(); }

 private:
  std::map<std::vector<double>, double> costs_;
  std::ofstream file_;
};

}  // namespace snug::identification::internal
