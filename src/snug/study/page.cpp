// The page of a study: tables and drawings for people, in one file without scripts.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "snug/report/chart.hpp"
#include "snug/report/page.hpp"
#include "snug/report/table.hpp"
#include "snug/study/effects.hpp"

namespace snug::study {
namespace {

using report::Markup;

std::string number(double value) { return fmt::format("{:.4g}", value); }
std::string percent(double part) { return fmt::format("{:.1f} %", 100.0 * std::max(0.0, part)); }

/// Means of the levels with two standard errors to either side.
report::Chart chart_of(const MainEffect& effect, std::pair<double, double> range) {
  report::Chart chart;
  chart.title = fmt::format("{}: {}", effect.factor, effect.is_seen ? percent(effect.share) : "none");
  chart.shows_means = false;
  chart.range = range;
  for (const Level& level : effect.levels) {
    const std::string about = fmt::format("{}, +- {} ({} rows)", level.label, number(level.error), level.count);
    chart.lines.push_back({level.label,
                           {{level.mean, about}},
                           std::pair(level.mean - 2.0 * level.error, level.mean + 2.0 * level.error)});
  }
  return chart;
}

Markup main_effects(const OutputEffects& effects) {
  if (effects.main.empty()) return {};
  double low = effects.mean, high = effects.mean;
  for (const MainEffect& effect : effects.main) {
    for (const Level& level : effect.levels) {
      low = std::min(low, level.mean - 2.0 * level.error);
      high = std::max(high, level.mean + 2.0 * level.error);
    }
  }
  std::vector<Markup> charts;
  for (const MainEffect& effect : effects.main) charts.push_back(as_markup(chart_of(effect, {low, high})));
  return report::heading(3, "Main effects") +
         report::paragraph(
             "Mean of each level with two standard errors, and the part of the variance that the factor alone "
             "explains; none: no more than chance or the error of the computation.") +
         (effects.is_noise ? report::paragraph("Rows differ by no more than the error of the computation.")
                           : Markup{}) +
         report::side_by_side(charts);
}

Markup interactions(const OutputEffects& effects) {
  if (effects.interactions.empty()) return {};
  report::Table table{{{"factor", true}, {"factor", true}, {"part of the variance"}}, {}, {}};
  for (const Interaction& pair : effects.interactions) {
    table.rows.push_back({pair.first, pair.second, pair.is_seen ? percent(pair.share) : "none"});
  }
  return report::heading(3, "Interactions") +
         report::paragraph(
             "The part that a pair of factors explains beyond both alone; few rows in a cell make it uncertain.") +
         as_markup(table);
}

Markup quantiles(const OutputEffects& effects) {
  report::Table table{{{"rows"}, {"mean"}, {"deviation"}}, {}, {}};
  std::vector<Markup> row = {std::to_string(effects.count), number(effects.mean), number(effects.deviation)};
  for (std::size_t i = 0; i < kQuantilePercents.size(); ++i) {
    table.columns.push_back({fmt::format("{} %", kQuantilePercents[i])});
    row.emplace_back(number(effects.quantiles[i]));
  }
  table.rows.push_back(std::move(row));
  return as_markup(table);
}

/// With which the verb of the study leaves a recording, if it does.
std::string replay_of(const Study& study, const Row& row) {
  const bool records = study.verb == "pack" || study.verb == "simulate";
  return command_of(study, row) + (records ? fmt::format(" -o row-{}.h5", row.index) : "");
}

Markup worst(const Study& study, const OutputEffects& effects) {
  report::Table table{{{"row"}, {"value"}, {"command that repeats it", true}}, {}, {}};
  for (std::size_t i = 0; i < effects.worst.size(); ++i) {
    table.rows.push_back({std::to_string(effects.worst[i]), number(effects.worst_values[i]),
                          report::code(replay_of(study, row_of(study, effects.worst[i])))});
  }
  return report::heading(3, "Worst rows") + as_markup(table);
}

const char* name_of(Design design) {
  constexpr std::array kNames = {"grid", "list", "random", "sobol"};
  return kNames[static_cast<std::size_t>(design)];
}

}  // namespace

std::string make_page(const Study& study, const Status& status, const std::vector<OutputEffects>& effects) {
  Markup content = report::key_figures(
      {{"rows done", fmt::format("{} of {} rows", status.done, status.rows), ""},
       {"failed", fmt::format("{}", status.failed), ""},
       {"design", name_of(study.design),
        fmt::format("{} points with {} repetitions, seed {}", study.point_count, study.repeat, study.seed)}});
  content += report::paragraph(Markup("Each row is a run of ") + report::code("snug " + study.verb) + ".");
  if (effects.empty()) content += report::paragraph("No output varies from row to row.");
  for (const OutputEffects& output : effects) {
    content += report::section(report::heading(2, output.output) + quantiles(output) + main_effects(output) +
                               interactions(output) + worst(study, output));
  }
  content += report::section(report::heading(2, "The study") + report::preformatted(study.text));
  return report::make_page(study.name, content);
}

}  // namespace snug::study
