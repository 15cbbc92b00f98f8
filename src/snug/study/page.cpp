// The page of a study: tables and drawings for people, in one file without scripts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "snug/core/text.hpp"
#include "snug/study/effects.hpp"

namespace snug::study {
namespace {

std::string cell(const std::string& text) { return "<td>" + text + "</td>"; }
std::string number(double value) { return fmt::format("{:.4g}", value); }
std::string percent(double share) { return fmt::format("{:.1f} %", 100.0 * std::max(0.0, share)); }

/// Means of the levels with two standard errors to either side.
std::string drawing_of(const MainEffect& effect, double low, double high) {
  constexpr double kWidth = 340.0, kLine = 22.0, kLabel = 150.0, kPlot = kWidth - kLabel - 10.0;
  const double span = high > low ? high - low : 1.0;
  const auto x = [&](double value) { return kLabel + kPlot * std::clamp((value - low) / span, 0.0, 1.0); };
  const double height = kLine * static_cast<double>(effect.levels.size()) + 20.0;
  std::string svg = fmt::format("<svg width=\"{}\" height=\"{}\" role=\"img\" aria-label=\"means by level of {}\">",
                                kWidth, height, escape_markup(effect.factor));
  double y = 14.0;
  for (const Level& level : effect.levels) {
    svg += fmt::format("<text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLabel - 8.0, y + 4.0,
                       escape_markup(level.label.substr(0, 24)));
    svg += fmt::format("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>",
                       x(level.mean - 2.0 * level.error), x(level.mean + 2.0 * level.error), y, y);
    svg += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\"><title>{} +- {} ({} rows)</title></circle>",
                       x(level.mean), y, number(level.mean), number(level.error), level.count);
    y += kLine;
  }
  svg += fmt::format(
      "<text x=\"{:.0f}\" y=\"{:.1f}\">{}</text><text x=\"{:.0f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text></svg>",
      kLabel, height - 2.0, number(low), kLabel + kPlot, height - 2.0, number(high));
  return svg;
}

std::string main_effects(const OutputEffects& effects) {
  if (effects.main.empty()) return "";
  double low = effects.mean, high = effects.mean;
  for (const MainEffect& effect : effects.main) {
    for (const Level& level : effect.levels) {
      low = std::min(low, level.mean - 2.0 * level.error);
      high = std::max(high, level.mean + 2.0 * level.error);
    }
  }
  std::string text =
      "<h3>Main effects</h3><p>Mean of each level with two standard errors; the part of the variance that the "
      "factor explains by itself.</p><div class=\"effects\">";
  for (const MainEffect& effect : effects.main) {
    text += fmt::format("<figure><figcaption>{} <b>{}</b></figcaption>{}</figure>", escape_markup(effect.factor),
                        percent(effect.share), drawing_of(effect, low, high));
  }
  return text + "</div>";
}

std::string interactions(const OutputEffects& effects) {
  if (effects.interactions.empty()) return "";
  std::string text =
      "<h3>Interactions</h3><p>What a pair explains beyond both by themselves; few rows in a cell make it "
      "uncertain.</p><table><tr><th>factor</th><th>factor</th><th>part of the variance</th></tr>";
  for (const Interaction& pair : effects.interactions) {
    text += "<tr>" + cell(escape_markup(pair.first)) + cell(escape_markup(pair.second)) + cell(percent(pair.share)) +
            "</tr>";
  }
  return text + "</table>";
}

std::string quantiles(const OutputEffects& effects) {
  std::string head = "<table><tr><th>rows</th><th>mean</th><th>deviation</th>", body = "<tr>";
  body += cell(std::to_string(effects.count)) + cell(number(effects.mean)) + cell(number(effects.deviation));
  for (std::size_t i = 0; i < kQuantilePercents.size(); ++i) {
    head += fmt::format("<th>{} %</th>", kQuantilePercents[i]);
    body += cell(number(effects.quantiles[i]));
  }
  return head + "</tr>" + body + "</tr></table>";
}

/// With which the verb of the study leaves a recording, if it does.
std::string replay_of(const Study& study, const Row& row) {
  const bool records = study.verb == "pack" || study.verb == "simulate";
  return command_of(study, row) + (records ? fmt::format(" -o row-{}.h5", row.index) : "");
}

std::string worst(const Study& study, const OutputEffects& effects) {
  std::string text = "<h3>Worst rows</h3><table><tr><th>row</th><th>value</th><th>command that repeats it</th></tr>";
  for (std::size_t i = 0; i < effects.worst.size(); ++i) {
    text += "<tr>" + cell(std::to_string(effects.worst[i])) + cell(number(effects.worst_values[i])) +
            cell("<code>" + escape_markup(replay_of(study, row_of(study, effects.worst[i]))) + "</code>") + "</tr>";
  }
  return text + "</table>";
}

constexpr const char* kStyle =
    "body{font:14px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em;color:#1d2733}"
    "table{border-collapse:collapse;margin:.5em 0}td,th{padding:.2em .7em;border-bottom:1px solid "
    "#d5dce3;text-align:right}"
    "td:last-child,th:last-child{text-align:left}code{font-size:12px;overflow-wrap:anywhere}.effects{display:flex;flex-"
    "wrap:wrap;"
    "gap:1em}figure{margin:0}svg text{font-size:11px;fill:#44505c}svg line{stroke:#2b6cb0;stroke-width:2}svg "
    "circle{fill:#2b6cb0}"
    "section{border-top:2px solid #1d2733;margin-top:2em}";

}  // namespace

std::string make_page(const Study& study, const Status& status, const std::vector<OutputEffects>& effects) {
  const char* const designs[] = {"grid", "list", "random", "sobol"};
  std::string text = fmt::format(
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title><style>{1}</style></head><body>"
      "<h1>{0}</h1><p>{2} of {3} rows, {4} failed; design {5}, {6} points with {7} repetitions, seed {8}; <code>snug "
      "{9}</code>.</p>",
      escape_markup(study.name), kStyle, status.done, status.rows, status.failed,
      designs[static_cast<int>(study.design)], study.point_count, study.repeat, study.seed, escape_markup(study.verb));
  if (effects.empty()) text += "<p>No number varies from row to row.</p>";
  for (const OutputEffects& output : effects) {
    text += "<section><h2>" + escape_markup(output.output) + "</h2>" + quantiles(output) + main_effects(output) +
            interactions(output) + worst(study, output) + "</section>";
  }
  return text + "<section><h2>The study</h2><pre>" + [&] {
    std::string lines;
    for (const char c : study.text) lines += c == '\n' ? std::string("\n") : escape_markup(std::string(1, c));
    return lines;
  }() + "</pre></section></body></html>\n";
}

}  // namespace snug::study
