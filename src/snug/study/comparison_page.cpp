// The page of a comparison: charts by agent, sequence and plant, every container from above; one file without scripts.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "snug/report/chart.hpp"
#include "snug/report/page.hpp"
#include "snug/report/plan_view.hpp"
#include "snug/report/table.hpp"
#include "snug/study/comparison.hpp"

namespace snug::study {
namespace {

using report::Markup;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// One number of each session; NaN where it has none.
struct Measure {
  const char* title;
  double (*value)(const SessionRow& row);
};

constexpr Measure kMeasures[] = {
    {"filling degree by the plant's truth, %", [](const SessionRow& row) { return row.executed_percent; }},
    {"items that end as planned, %",
     [](const SessionRow& row) { return row.items_sent > 0 ? 100.0 * row.items_as_planned / row.items_sent : kNone; }},
    {"boxes an hour of the plant's time", [](const SessionRow& row) { return row.boxes_per_hour; }},
    {"boxes an hour, including the robot's waits for a plan",
     [](const SessionRow& row) { return row.boxes_per_hour_with_planning; }},
    {"time to decide and rehearse an item, median, s",
     [](const SessionRow& row) { return row.decision_seconds_median; }},
};

/// Sessions that a line of a chart is of.
struct Group {
  std::string label;
  std::vector<const SessionRow*> rows;
};

template <class Label>
std::vector<Group> group_by(const std::vector<ComparedSession>& sessions, const Label& label) {
  std::vector<Group> groups;
  for (const ComparedSession& session : sessions) {
    const std::string name = label(session.row);
    auto found = std::ranges::find(groups, name, &Group::label);
    if (found == groups.end()) found = groups.insert(groups.end(), {name, {}});
    found->rows.push_back(&session.row);
  }
  return groups;
}

/// What is measured of a session that was interrupted says nothing about its agent.
std::vector<ComparedSession> whole_sessions(const std::vector<ComparedSession>& sessions) {
  std::vector<ComparedSession> whole;
  std::ranges::copy_if(sessions, std::back_inserter(whole),
                       [](const ComparedSession& session) { return !session.row.is_interrupted(); });
  return whole;
}

/// Every measure of these groups.
Markup charts(const char* title, const std::vector<Group>& groups) {
  std::vector<Markup> parts;
  for (const Measure& measure : kMeasures) {
    report::Chart chart;
    chart.title = measure.title;
    for (const Group& group : groups) {
      chart.lines.push_back({group.label, {}, {}});
      for (const SessionRow* row : group.rows) {
        chart.lines.back().dots.push_back(
            {measure.value(*row),
             fmt::format("{}, sequence {}, plant {}", row->point.agent, row->point.sequence, row->point.plant_seed)});
      }
    }
    parts.push_back(as_markup(chart));
  }
  return report::heading(2, title) + report::side_by_side(parts);
}

/// Whether each plant packs one sequence only: then lines by plant would repeat those by sequence.
bool has_plants_of_their_own(const std::vector<ComparedSession>& sessions) {
  for (const ComparedSession& one : sessions) {
    for (const ComparedSession& other : sessions) {
      if (one.row.point.plant_seed == other.row.point.plant_seed && one.row.point.sequence != other.row.point.sequence)
        return false;
    }
  }
  return !sessions.empty() && sessions.front().row.point.sequence != sessions.back().row.point.sequence;
}

/// A file as seen from the folder of another.
std::string relative_path(const std::filesystem::path& file, const std::filesystem::path& from) {
  const std::filesystem::path folder = std::filesystem::absolute(from).parent_path();
  return std::filesystem::absolute(file).lexically_relative(folder).generic_string();
}

Markup plan_view(const model::Scenario& scenario, const std::vector<PackedBox>& packed) {
  std::vector<report::BoxOutline> outlines;
  for (const PackedBox& box : packed) {
    const model::Parcel* parcel = model::find_parcel(scenario, box.id);
    if (parcel != nullptr) outlines.push_back(report::outline_of(box.id, parcel->size, box.X_TP));
  }
  return report::plan_view(model::find_container(scenario, scenario.target)->inner_size, std::move(outlines));
}

/// One session: its container and what became of its boxes.
Markup card(const model::Scenario& scenario, const ComparedSession& session, const std::filesystem::path& page) {
  const SessionRow& row = session.row;
  Markup content = plan_view(scenario, row.packed);
  content += report::line_break() + report::bold(fmt::format("{:.2f} %", row.executed_percent)) +
             fmt::format(" {} boxes", row.executed_boxes) + report::line_break() +
             fmt::format("{}, plant {}", row.point.agent, row.point.plant_seed) + report::line_break() +
             report::small(fmt::format("{} of {} sent as planned, {} lost, {} recoveries; {}", row.items_as_planned,
                                       row.items_sent, row.boxes_lost, row.recoveries,
                                       row.failure.empty() ? row.stop_name() : row.failure));
  if (!session.report.empty()) {
    return content + report::paragraph(report::link(relative_path(session.report, page), "open this run")) +
           report::code(session.command);
  }
  return content + report::details("see this run", report::code(session.command + " -o run.h5") + report::line_break() +
                                                       report::code("snug report run.h5 -o run.html"));
}

/// Means of each agent: what is asked first.
Markup agents_table(const std::vector<SessionRow>& rows, const std::vector<Group>& agents) {
  report::Table table{{{"agent", true},
                       {"sessions"},
                       {"filling [%]"},
                       {"boxes an hour"},
                       {"sent as planned"},
                       {"lost"},
                       {"recoveries"}},
                      {},
                      {}};
  for (const Group& agent : agents) {
    const AgentSummary all = summarize(rows, agent.label);
    table.rows.push_back({agent.label, std::to_string(all.count),
                          report::number(all.executed, all.count > 1 ? all.deviation : kNone, 2),
                          report::number(all.boxes_per_hour, 0), fmt::format("{} of {}", all.as_planned, all.sent),
                          std::to_string(all.lost), std::to_string(all.recoveries)});
  }
  return as_markup(table);
}

}  // namespace

std::string format_compare_page(const model::Scenario& scenario, const std::vector<ComparedSession>& sessions,
                                const std::filesystem::path& page) {
  const std::vector<ComparedSession> whole = whole_sessions(sessions);
  const std::vector<Group> agents = group_by(whole, [](const SessionRow& row) { return row.point.agent; });
  Markup content =
      report::paragraph(fmt::format("{} sessions compared. Each dot is a session: an agent packs a sequence in a plant "
                                    "of its own, and the true state of the plant counts. Bars are means.",
                                    whole.size()));
  if (whole.size() < sessions.size()) {
    content += report::paragraph(fmt::format("{} more were interrupted: they are shown below and not in the charts.",
                                             sessions.size() - whole.size()));
  }
  std::vector<SessionRow> rows;
  for (const ComparedSession& session : whole) rows.push_back(session.row);
  content += agents_table(rows, agents) + charts("By agent", agents);
  std::vector<Group> groups =
      group_by(whole, [](const SessionRow& row) { return fmt::format("{}: {}", row.point.sequence, row.point.agent); });
  std::ranges::stable_sort(groups, {}, [](const Group& group) { return group.rows.front()->point.sequence; });
  content += charts("By sequence", groups);
  if (!has_plants_of_their_own(whole)) {
    groups = group_by(whole, [](const SessionRow& row) {
      return fmt::format("plant {}: {}", row.point.plant_seed, row.point.agent);
    });
    std::ranges::stable_sort(groups, {}, [](const Group& group) { return group.rows.front()->point.plant_seed; });
    content += charts("By seed of the plant", groups);
  }
  content += report::heading(2, "Containers from above") + report::paragraph("Lighter boxes reach higher.");
  for (const Group& sequence : group_by(sessions, [](const SessionRow& row) { return row.point.sequence; })) {
    std::vector<Markup> parts;
    for (const ComparedSession& session : sessions) {
      if (session.row.point.sequence == sequence.label) parts.push_back(card(scenario, session, page));
    }
    content += report::heading(3, "Sequence " + sequence.label) + report::cards(parts);
  }
  return report::make_page(scenario.name + ": comparison", content);
}

}  // namespace snug::study
