// Page: a validation as one HTML file that needs nothing else.
#include "snug/validation/page.hpp"

#include <fmt/format.h>

#include <cmath>

#include "snug/core/units.hpp"
#include "snug/report/page.hpp"
#include "snug/report/table.hpp"
#include "snug/validation/reported.hpp"

namespace snug::validation {
namespace {

using report::Markup;

/// Mean over the repetitions and the standard deviation of one.
Markup spread_cell(const std::vector<Errors>& errors, double Errors::*value, double scale, int decimals) {
  const Spread spread = spread_of(errors, value);
  return report::number(scale * spread.mean, scale * spread.deviation, decimals);
}

std::string box_name(const std::string& body) { return record::archive_name(body); }

std::string span_of(double start, double end) { return fmt::format("{:.1f}\u2013{:.1f}", start, end); }

Markup clocks_section(const Validation& validation) {
  report::Table table{{{"recording", true}, {"source", true}, {"shift [s]"}, {"rate [ppm]"}, {"correlation"}}, {}, {}};
  for (const Measurement& measurement : validation.repetitions) {
    for (const SourceClock& clock : measurement.clocks) {
      std::vector<Markup> row = {measurement.name, clock.source};
      if (!clock.fit) {
        row.emplace_back("not found: " + clock.failure);
      } else if (clock.fit->is_by_hand) {
        row.insert(row.end(), {report::number(clock.fit->shift, 4), "by hand"});
      } else {
        row.insert(row.end(), {report::number(clock.fit->shift, clock.fit->shift_error, 4),
                               report::number(1e6 * clock.fit->rate, 1e6 * clock.fit->rate_error, 0),
                               report::number(clock.fit->correlation, 3)});
      }
      table.rows.push_back(std::move(row));
      if (!clock.fit) continue;
      for (const ClockStep& step : clock.fit->steps)
        table.rows.push_back(
            {"", "slip at " + fmt::format("{:.1f} s", step.time), report::number(step.size, step.error, 4), "", ""});
    }
  }
  return report::heading(2, "Clocks") +
         report::paragraph(
             "Shift: clock of a source minus that of the simulation, in the middle of the run; found by "
             "cross-correlation over all bodies, with its standard error.") +
         as_markup(table);
}

Markup execution_section(const Validation& validation) {
  const std::string end = validation.protective_stop.empty()
                              ? "The simulated run ended without a protective stop."
                              : "The simulated run ended with a protective stop: " + validation.protective_stop + ".";
  report::Table table{{{"box", true}, {"simulated", true}}, {}, {}};
  for (const Measurement& measurement : validation.repetitions) table.columns.push_back({measurement.name, true});
  for (const BodyReport& body : validation.bodies) {
    std::vector<Markup> row = {box_name(body.body), body.simulated_state};
    for (const std::string& state : body.measured_states) row.emplace_back(state);
    table.rows.push_back(std::move(row));
  }
  return report::heading(2, "1. Execution") + report::paragraph(end) + as_markup(table);
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

report::Table error_table(const Validation& validation, const TablePlan& plan) {
  report::Table table{{{"box", true}, {"window [s]"}}, {}, {"mean", ""}};
  for (const char* form : {"clean", "report"}) {
    for (const char* unit : {plan.unit_first, plan.unit_second})
      table.columns.push_back({fmt::format("{} [{}]", form, unit)});
  }
  if (plan.shows_tracking) table.columns.insert(table.columns.end(), {{"tracked [%]"}, {"dropped [%]"}});
  for (const BodyReport& body : validation.bodies) {
    std::vector<Markup> row = {box_name(body.body), span_of(body.window.start, body.window.end)};
    for (const std::vector<Errors>* errors : {&body.errors.clean, &body.errors.report}) {
      row.push_back(spread_cell(*errors, plan.first, plan.scale_first, 2));
      row.push_back(spread_cell(*errors, plan.second, plan.scale_second, 2));
    }
    if (plan.shows_tracking) {
      row.push_back(report::number(100.0 * spread_of(body.errors.clean, &Errors::tracked).mean, 1));
      row.push_back(report::number(100.0 * spread_of(body.errors.report, &Errors::dropped).mean, 1));
    }
    table.rows.push_back(std::move(row));
  }
  for (const Means* means : {&validation.clean, &validation.report}) {
    table.foot.push_back(report::number(plan.scale_first * (means->*plan.mean_first), 2));
    table.foot.push_back(report::number(plan.scale_second * (means->*plan.mean_second), 2));
  }
  if (plan.shows_tracking) table.foot.insert(table.foot.end(), {"", ""});
  return table;
}

Markup error_section(const Validation& validation, const TablePlan& plan) {
  const std::string reported =
      fmt::format("The report's simulation beside its real cell: {:.2f} {}, {:.2f} {} (mean of all five sequences).",
                  plan.scale_first * (reported_means().*plan.mean_first), plan.unit_first,
                  plan.scale_second * (reported_means().*plan.mean_second), plan.unit_second);
  const std::string floor = plan.shows_tracking ? " With identical physics on both sides the report form gives 0.7 to "
                                                  "2.3 mm and 0.6 to 3.4 degrees: its floor."
                                                : "";
  return report::heading(2, plan.title) + report::paragraph(plan.text) + as_markup(error_table(validation, plan)) +
         report::paragraph(report::small(reported + floor));
}

Markup moments_section(const SimulatedRun& run, const Validation& validation) {
  if (validation.moments.empty()) return {};
  report::Table table{{{"box", true},
                       {"moment", true},
                       {"window [s]"},
                       {"rms [mm]"},
                       {"rms [deg]"},
                       {"rms [N]"},
                       {"rms [Nm]"},
                       {"at its end [mm]"}},
                      {},
                      {}};
  for (const MomentReport& moment : validation.moments) {
    const std::vector<Errors>& errors = moment.errors.clean;
    table.rows.push_back(
        {box_name(moment.window.body), moment.what, span_of(moment.window.start, moment.window.end),
         spread_cell(errors, &Errors::rms_position, kMm, 2), spread_cell(errors, &Errors::rms_rotation, kDegrees, 2),
         spread_cell(errors, &Errors::rms_force, 1.0, 2), spread_cell(errors, &Errors::rms_torque, 1.0, 2),
         spread_cell(errors, &Errors::rest_position, kMm, 2)});
  }
  Markup content = report::heading(2, "Key moments (Table 3)") + as_markup(table);
  for (const NamedFigure& one : make_figures(run, validation, true)) {
    content += report::figure(one.caption, report::picture(one.caption, report::draw_svg(one.figure)));
  }
  return content;
}

constexpr TablePlan kPlans[] = {
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

/// What is asked first: how far off are poses and forces, beside the published ones.
Markup summary(const Validation& validation) {
  const auto figure = [&](const char* label, double Means::*value, double scale, const char* unit) {
    const double mean = validation.clean.*value;
    const std::string text = std::isfinite(mean) ? fmt::format("{:.2f} {}", scale * mean, unit) : "n.a.";
    return report::KeyFigure{label, text, fmt::format("published: {:.2f} {}", scale * (reported_means().*value), unit)};
  };
  return report::key_figures({figure("rest position", &Means::rest_position, kMm, "mm"),
                              figure("position while moving", &Means::rms_position, kMm, "mm"),
                              figure("rotation while moving", &Means::rms_rotation, kDegrees, "deg"),
                              figure("force", &Means::rms_force, 1.0, "N"),
                              figure("torque", &Means::rms_torque, 1.0, "Nm")});
}

}  // namespace

std::string make_page(const SimulatedRun& run, const Validation& validation) {
  const std::size_t count = validation.repetitions.size();
  Markup content = summary(validation);
  content += report::paragraph(
      Markup(fmt::format("Sequence {}, {} of its experiment. Each value is the mean over the repetitions with the "
                         "standard deviation of one. ",
                         validation.sequence.empty() ? "of no name" : validation.sequence,
                         count == 1 ? "one repetition" : fmt::format("{} repetitions", count))) +
      report::bold("clean") + ": geodesic angle, nothing dropped or smoothed, lost markers counted. " +
      report::bold("report") + ": by the rules of the demonstrator's analysis.");
  content += clocks_section(validation) + execution_section(validation);
  for (const TablePlan& plan : kPlans) content += error_section(validation, plan);
  return report::make_page("Validation of " + validation.simulated, content + moments_section(run, validation));
}

}  // namespace snug::validation
