// The page of a comparison: charts by agent, sequence and plant, every container from above; one file without scripts.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/snug/compare/compare_report.hpp"

namespace snug::app {

/// A packed box from above.
struct BoxOutline {
  std::string id;
  std::vector<std::array<double, 2>> corners_T;  ///< m, x and y in the container, in the order of a walk around it
  double top = 0.0;                              ///< m over the container's floor
};

/// A box where it is in the end, by the plant's truth.
struct PackedBox {
  std::string id;
  Pose X_TP;  ///< in the container
};

/// One session: its row, what it left in the container, the `snug pack` that repeats it, its report page.
struct CompareSession {
  CompareRow row;
  std::vector<BoxOutline> boxes;
  std::string command;
  std::string report;  ///< file; empty: none was made
};

/// What is seen of them from above, the lowest first.
[[nodiscard]] std::vector<BoxOutline> outline_boxes(const model::Scenario& scenario,
                                                    const std::vector<PackedBox>& boxes);

/// `page`: the file that it will be; links to reports start at its folder.
[[nodiscard]] std::string format_compare_page(const model::Scenario& scenario,
                                              const std::vector<CompareSession>& sessions,
                                              const std::filesystem::path& page);

}  // namespace snug::app
