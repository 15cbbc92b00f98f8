// Scene page: tables of a fit, made of the pieces that all pages have.
#include "snug/identification/scene_page.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "snug/report/page.hpp"
#include "snug/report/table.hpp"

namespace snug::identification {
namespace {

using report::Markup;

std::string four_digits(double value) { return std::isfinite(value) ? fmt::format("{:.4g}", value) : "not told"; }

Markup improvement(const SceneFit& fit) {
  report::Table table{
      {{"recordings", true}, {"numbers", true}, {"count"}, {"position [mm]"}, {"rotation [deg]"}, {"at the end [mm]"}},
      {},
      {}};
  const auto add = [&](const char* which, const char* when, const SceneError& error) {
    if (error.recordings == 0) return;
    table.rows.push_back({which, when, std::to_string(error.recordings), report::number(error.position_mm, 3),
                          report::number(error.rotation_deg, 3), report::number(error.end_position_mm, 3)});
  };
  add("held back", "before", fit.held_back_before);
  add("held back", "found", fit.held_back);
  add("fitted", "before", fit.before);
  add("fitted", "found", fit.fitted);
  return report::heading(2, "What improved") +
         report::paragraph(
             "Mean distance and angle between simulated and recorded bodies. Recordings that are held "
             "back had no part in the fit.") +
         as_markup(table);
}

Markup numbers(const SceneExperiment& experiment, const SceneFit& fit) {
  report::Table table{
      {{"number", true}, {"before"}, {"found"}, {"standard error"}, {"verdict", true}, {"remark", true}}, {}, {}};
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const Parameter& one = fit.parameters[i];
    const model::TaskParameter& asked = experiment.task().parameters[i];
    table.rows.push_back({one.name, four_digits(asked.value), four_digits(one.value),
                          asked.is_fixed ? Markup("fixed") : Markup(four_digits(one.standard_error)),
                          asked.is_fixed ? Markup() : Markup(name_of(one.verdict)), one.advice});
  }
  const std::string misfit = fmt::format(
      "Misfit: chi2 per degree of freedom {:.3g} with the noise that the task declares. {}", fit.chi2_per_dof,
      !fit.is_trusted     ? "The simulation misses the recordings by far more than noise: do not use these numbers."
      : fit.is_systematic ? "The remaining error is not noise: no number is called identified."
      : fit.chi2_per_dof > kExplained ? "This is more than noise: no number is called identified."
                                      : "The simulation explains the recordings.");
  return report::heading(2, "Numbers") + report::paragraph(misfit) + as_markup(table);
}

Markup what_is_left(const std::vector<UncertaintyChange>& changes) {
  const Markup title = report::heading(2, "What stays uncertain");
  if (changes.empty()) return title + report::paragraph("The uncertainty of the scenario does not change.");
  report::Table table{{{"key of uncertainty", true}, {"before"}, {"found"}}, {}, {}};
  for (const UncertaintyChange& change : changes)
    table.rows.push_back({report::code(change.key), four_digits(change.before), four_digits(change.after)});
  return title + report::paragraph("Half widths of uniform draws, for plants, sampled worlds and Monte Carlo runs.") +
         as_markup(table);
}

}  // namespace

std::string make_page(const SceneExperiment& experiment, const SceneFit& fit,
                      const std::vector<UncertaintyChange>& changes) {
  std::vector<report::KeyFigure> figures;
  if (fit.held_back.recordings > 0) {
    figures.push_back({"error on recordings held back", fmt::format("{:.2f} mm", fit.held_back.position_mm),
                       fmt::format("{:.2f} mm before", fit.held_back_before.position_mm)});
  }
  int identified = 0;
  for (const Parameter& one : fit.parameters) identified += one.verdict == Verdict::Identified ? 1 : 0;
  figures.push_back({"numbers identified", std::to_string(identified), fmt::format("of {}", fit.parameters.size())});
  return report::make_page(
      "Identification of " + experiment.task().scenario.filename().string(),
      report::key_figures(figures) + improvement(fit) + numbers(experiment, fit) + what_is_left(changes));
}

}  // namespace snug::identification
