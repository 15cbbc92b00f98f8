// Figures as text: a table for people, JSON for programs and back.
#include "bench/figures/figure_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace snug::bench {

std::string format_json(const std::vector<Figure>& figures) {
  nlohmann::ordered_json document = {{"results", nlohmann::ordered_json::array()}};
  for (const Figure& figure : figures) {
    document["results"].push_back({{"name", figure.name},
                                   {"value", figure.value},
                                   {"unit", figure.unit},
                                   {"target", figure.target},
                                   {"ok", figure.ok}});
    if (!figure.skipped.empty()) document["results"].back()["skipped"] = figure.skipped;
  }
  const model::SolverSettings solver;
  document["settings"] = {{"tolerance_m_s", solver.tolerance},
                          {"max_sweeps", solver.max_sweeps},
                          {"position_slop_m", solver.position_slop}};
  return document.dump(2) + "\n";
}

Figure read_figure(const nlohmann::ordered_json& json) {
  return {
      json.at("name").get<std::string>(), json.at("value").is_null() ? std::nan("") : json.at("value").get<double>(),
      json.at("unit").get<std::string>(), json.at("target").get<std::string>(),
      json.at("ok").get<bool>(),          json.value("skipped", std::string())};
}

std::string format_table(const std::vector<Figure>& figures) {
  std::string text = fmt::format("{:<34} {:>12} {:<6} {:<10} {}\n", "figure", "value", "unit", "target", "met");
  for (const Figure& figure : figures) {
    const std::string value = figure.skipped.empty() ? fmt::format("{:.4g}", figure.value) : "-";
    const std::string met = !figure.skipped.empty() ? "skipped: " + figure.skipped
                            : figure.target.empty() ? ""
                            : figure.ok             ? "yes"
                                                    : "NO";
    text += fmt::format("{:<34} {:>12} {:<6} {:<10} {}\n", figure.name, value, figure.unit, figure.target, met);
  }
  const model::SolverSettings solver;
  return text + fmt::format("\nsolver of every scenario: tolerance {} m/s, at most {} sweeps, slop {} m\n",
                            solver.tolerance, solver.max_sweeps, solver.position_slop);
}

}  // namespace snug::bench
