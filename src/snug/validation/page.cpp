// Page: a validation as one HTML file that needs nothing else.
#include "snug/validation/page.hpp"

#include <fmt/format.h>

#include <cmath>

#include "snug/core/base64.hpp"
#include "snug/core/text.hpp"
#include "snug/core/units.hpp"
#include "snug/replay/page.hpp"
#include "snug/validation/reported.hpp"

namespace snug::validation {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light dark; }
body { font: 15px/1.5 system-ui, "Helvetica Neue", Arial, sans-serif; max-width: 62rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.5rem; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
table { border-collapse: collapse; margin: .6rem 0; font-variant-numeric: tabular-nums; }
th, td { padding: .2rem .7rem; text-align: right; border-bottom: 1px solid #8884; }
th:first-child, td:first-child, td.text, th.text { text-align: left; }
thead th { border-bottom: 2px solid #8888; font-weight: 600; } tfoot td { font-weight: 600; }
small, .na { color: #888; } img { width: 100%; background: #fff; } figure { margin: 1.2rem 0; }
.scroll { overflow-x: auto; }
)";

std::string number_text(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "<span class=\"na\">n.a.</span>";
}

/// "4.31 +- 0.12": mean over the repetitions and the standard deviation of one.
std::string spread_cell(const std::vector<Errors>& errors, double Errors::*value, double scale, int decimals) {
  const Spread spread = spread_of(errors, value);
  std::string text = number_text(scale * spread.mean, decimals);
  if (std::isfinite(spread.deviation))
    text += fmt::format(" <small>\u00b1 {:.{}f}</small>", scale * spread.deviation, decimals);
  return "<td>" + text + "</td>";
}

std::string clocks_section(const Validation& validation) {
  std::string html =
      "<h2>Clocks</h2>\n<p>Shift: what a source's clock shows less the simulation's, in the middle of the run; found "
      "by "
      "cross-correlation over all bodies, with its standard error.</p>\n<div "
      "class=\"scroll\"><table><thead><tr><th>recording"
      "</th><th class=\"text\">source</th><th>shift [s]</th><th>rate "
      "[ppm]</th><th>correlation</th></tr></thead><tbody>\n";
  for (const Measurement& measurement : validation.repetitions) {
    for (const SourceClock& clock : measurement.clocks) {
      html += fmt::format("<tr><td>{}</td><td class=\"text\">{}</td>", escape_markup(measurement.name), clock.source);
      if (!clock.fit) {
        html += "<td colspan=\"3\" class=\"text\">not found: " + escape_markup(clock.failure) + "</td></tr>\n";
      } else if (clock.fit->is_by_hand) {
        html += fmt::format("<td>{:.4f}</td><td colspan=\"2\" class=\"text\">by hand</td></tr>\n", clock.fit->shift);
      } else {
        html += fmt::format(
            "<td>{:.4f} <small>\u00b1 {:.4f}</small></td><td>{:.0f} <small>\u00b1 "
            "{:.0f}</small></td><td>{:.3f}</td></tr>\n",
            clock.fit->shift, clock.fit->shift_error, 1e6 * clock.fit->rate, 1e6 * clock.fit->rate_error,
            clock.fit->correlation);
      }
    }
  }
  return html + "</tbody></table></div>\n";
}

std::string execution_section(const Validation& validation) {
  std::string html = "<h2>1. Execution</h2>\n";
  html += validation.protective_stop.empty()
              ? "<p>The simulated run ended without a protective stop.</p>\n"
              : "<p>The simulated run ended with a protective stop: " + escape_markup(validation.protective_stop) +
                    ".</p>\n";
  html += "<div class=\"scroll\"><table><thead><tr><th>box</th><th class=\"text\">simulated</th>";
  for (const Measurement& measurement : validation.repetitions)
    html += "<th class=\"text\">" + escape_markup(measurement.name) + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const BodyReport& body : validation.bodies) {
    html += fmt::format("<tr><td>{}</td><td class=\"text\">{}</td>", escape_markup(record::archive_name(body.body)),
                        escape_markup(body.simulated_state));
    for (const std::string& state : body.measured_states)
      html += "<td class=\"text\">" + escape_markup(state) + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

/// One of Tables 4 to 6: two quantities, both forms.
struct TablePlan {
  const char* title;
  const char* text;
  double Errors::*first;
  double Errors::*second;
  double scale_first, scale_second;
  const char* unit_first;
  const char* unit_second;
  double Means::*mean_first;
  double Means::*mean_second;
  bool shows_tracking;
};

std::string error_section(const Validation& validation, const TablePlan& plan) {
  std::string html = fmt::format(
      "<h2>{}</h2>\n<p>{}</p>\n<div class=\"scroll\"><table><thead><tr><th>box</th><th>window [s]</th><th>clean "
      "[{}]</th>"
      "<th>clean [{}]</th><th>report [{}]</th><th>report [{}]</th>{}</tr></thead><tbody>\n",
      plan.title, plan.text, plan.unit_first, plan.unit_second, plan.unit_first, plan.unit_second,
      plan.shows_tracking ? "<th>tracked [%]</th><th>dropped [%]</th>" : "");
  for (const BodyReport& body : validation.bodies) {
    html += fmt::format("<tr><td>{}</td><td>{:.1f}\u2013{:.1f}</td>", escape_markup(record::archive_name(body.body)),
                        body.window.start, body.window.end);
    for (const std::vector<Errors>* errors : {&body.errors.clean, &body.errors.report}) {
      html += spread_cell(*errors, plan.first, plan.scale_first, 2);
      html += spread_cell(*errors, plan.second, plan.scale_second, 2);
    }
    if (plan.shows_tracking) {
      html += "<td>" + number_text(100.0 * spread_of(body.errors.clean, &Errors::tracked).mean, 1) + "</td><td>" +
              number_text(100.0 * spread_of(body.errors.report, &Errors::dropped).mean, 1) + "</td>";
    }
    html += "</tr>\n";
  }
  html += "</tbody><tfoot><tr><td>mean</td><td></td>";
  for (const Means* means : {&validation.clean, &validation.report})
    html += "<td>" + number_text(plan.scale_first * (means->*plan.mean_first), 2) + "</td><td>" +
            number_text(plan.scale_second * (means->*plan.mean_second), 2) + "</td>";
  html += fmt::format(
      "</tr></tfoot></table></div>\n<p><small>The report's simulation beside its real cell: {:.2f} {}, "
      "{:.2f} {} (mean of all five sequences).</small></p>\n",
      plan.scale_first * (reported_means().*plan.mean_first), plan.unit_first,
      plan.scale_second * (reported_means().*plan.mean_second), plan.unit_second);
  return html;
}

std::string moments_section(const SimulatedRun& run, const Validation& validation) {
  if (validation.moments.empty()) return "";
  std::string html =
      "<h2>Key moments (Table 3)</h2>\n<div class=\"scroll\"><table><thead><tr><th>box</th><th "
      "class=\"text\">moment</th>"
      "<th>window [s]</th><th>rms [mm]</th><th>rms [deg]</th><th>rms [N]</th><th>rms [Nm]</th><th>at its end [mm]</th>"
      "</tr></thead><tbody>\n";
  for (const MomentReport& moment : validation.moments) {
    const std::vector<Errors>& errors = moment.errors.clean;
    html += fmt::format("<tr><td>{}</td><td class=\"text\">{}</td><td>{:.1f}\u2013{:.1f}</td>",
                        escape_markup(record::archive_name(moment.window.body)), moment.what, moment.window.start,
                        moment.window.end);
    html += spread_cell(errors, &Errors::rms_position, kMm, 2) +
            spread_cell(errors, &Errors::rms_rotation, kDegrees, 2) + spread_cell(errors, &Errors::rms_force, 1.0, 2) +
            spread_cell(errors, &Errors::rms_torque, 1.0, 2) + spread_cell(errors, &Errors::rest_position, kMm, 2) +
            "</tr>\n";
  }
  html += "</tbody></table></div>\n";
  for (const NamedFigure& figure : make_figures(run, validation, true)) {
    // As pictures, so that their parts cannot be taken for each other's.
    html += fmt::format(
        "<figure><figcaption>{}</figcaption><img alt=\"{}\" src=\"data:image/svg+xml;base64,{}\"></figure>\n",
        escape_markup(figure.caption), escape_markup(figure.caption), base64(replay::draw_svg(figure.figure)));
  }
  return html;
}

}  // namespace

std::string make_page(const SimulatedRun& run, const Validation& validation) {
  std::string html = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width\"><title>Validation of {0}</title><style>{1}</style></head><body>\n"
      "<h1>Validation of {0}</h1>\n<p>Sequence {2}, {3} of its experiment. Each value is the mean over the repetitions "
      "with the standard deviation of one. <b>clean</b>: geodesic angle, nothing dropped or smoothed, lost markers "
      "counted. <b>report</b>: by the rules of the demonstrator's analysis.</p>\n",
      escape_markup(validation.simulated), kStyle,
      validation.sequence.empty() ? "of no name" : escape_markup(validation.sequence),
      validation.repetitions.size() == 1 ? "one repetition"
                                         : fmt::format("{} repetitions", validation.repetitions.size()));
  html += clocks_section(validation) + execution_section(validation);
  const TablePlan plans[] = {
      {"2. Rest poses (Table 4)", "Clean: mean over the last 0.5 s of the window. Report: its last sample.",
       &Errors::rest_position, &Errors::rest_rotation, kMm, kDegrees, "mm", "deg", &Means::rest_position,
       &Means::rest_rotation, false},
      {"3. Poses over the motion (Table 5)",
       "Root mean square over the window. A box tracked for less than half of it is n.a.; dropped: samples that the "
       "report's rules leave out (beyond 150 mm or 15 deg).",
       &Errors::rms_position, &Errors::rms_rotation, kMm, kDegrees, "mm", "deg", &Means::rms_position,
       &Means::rms_rotation, true},
      {"4. Wrenches (Table 6)",
       "Root mean square of force and torque errors at the flange, without the sensor's bias (which is the median of "
       "measured less simulated while nothing is held).",
       &Errors::rms_force, &Errors::rms_torque, 1.0, 1.0, "N", "Nm", &Means::rms_force, &Means::rms_torque, false}};
  for (const TablePlan& plan : plans) html += error_section(validation, plan);
  return html + moments_section(run, validation) + "</body></html>\n";
}

}  // namespace snug::validation
