// cup: what wrench a deformation gives, and where a held box hangs, as JSON lines; a starting cup from a data sheet.
#pragma once

#include <optional>
#include <string>

#include "apps/snug/command_line/verb.hpp"

namespace snug::app {

struct CupOptions {
  std::string input = "-";  ///< file of JSON lines; "-": stdin
};

struct CupEstimateOptions {
  double diameter_mm = 0.0;
  double bellows = 1.5;
  std::string material = "silicone", lip = "plain";
  std::string vacuum = "-60kPa";
  std::optional<double> stroke_mm, mass_max;
  std::optional<std::string> output;
  bool json = false;
};

void add_cup(CLI::App& app, Action& action);
/// Answers line by line, so that it can stand in a pipe. Throws InputError with the line that cannot be used.
[[nodiscard]] int run_cup_evaluate(const CupOptions& options);
[[nodiscard]] int run_cup_settle(const CupOptions& options);
[[nodiscard]] int run_cup_estimate(const CupEstimateOptions& options);
[[nodiscard]] int run_cup_catalogue(bool json);

}  // namespace snug::app
