// The page of a comparison: charts by agent, sequence and plant, every container from above; one file without scripts.
// scripts.
#include "apps/snug/compare/compare_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <limits>

#include "apps/snug/compare/dot_chart.hpp"
#include "snug/core/text.hpp"

namespace snug::app {
namespace {

using Point = std::array<double, 2>;

double cross(const Point& o, const Point& a, const Point& b) {
  return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

/// What is seen of points from above: the corners of their convex hull (Andrew's chains).
std::vector<Point> hull_of(std::vector<Point> points) {
  std::ranges::sort(points);
  std::vector<Point> hull;
  const auto walk = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (; first != last; ++first) {
      while (hull.size() >= start + 2 && cross(hull[hull.size() - 2], hull.back(), *first) <= 0.0) hull.pop_back();
      hull.push_back(*first);
    }
    hull.pop_back();
  };
  walk(points.begin(), points.end());
  walk(points.rbegin(), points.rend());
  return hull;
}

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// One number of each session; NaN where it has none.
struct Measure {
  const char* title;
  double (*value)(const CompareRow& row);
};

constexpr Measure kMeasures[] = {
    {"filling degree by the plant's truth, %", [](const CompareRow& row) { return row.executed_percent; }},
    {"items that end as planned, %",
     [](const CompareRow& row) { return row.items_sent > 0 ? 100.0 * row.items_as_planned / row.items_sent : kNone; }},
    {"boxes an hour of the plant's time", [](const CompareRow& row) { return row.boxes_per_hour; }},
    {"boxes an hour, the robot's waits for a plan included",
     [](const CompareRow& row) { return row.boxes_per_hour_with_planning; }},
    {"time to decide and rehearse an item, median, s",
     [](const CompareRow& row) { return row.decision_seconds_median; }},
};

/// Sessions that a line of a chart is of.
struct Group {
  std::string label;
  std::vector<const CompareRow*> rows;
};

template <class Label>
std::vector<Group> group_by(const std::vector<CompareSession>& sessions, const Label& label) {
  std::vector<Group> groups;
  for (const CompareSession& session : sessions) {
    const std::string name = label(session.row);
    auto found = std::ranges::find(groups, name, &Group::label);
    if (found == groups.end()) found = groups.insert(groups.end(), {name, {}});
    found->rows.push_back(&session.row);
  }
  return groups;
}

/// What is measured of a session that was interrupted says nothing about its agent.
std::vector<CompareSession> whole_sessions(const std::vector<CompareSession>& sessions) {
  std::vector<CompareSession> whole;
  std::ranges::copy_if(sessions, std::back_inserter(whole),
                       [](const CompareSession& session) { return !session.row.is_interrupted(); });
  return whole;
}

/// Every measure of these groups, in two columns.
std::string charts(const char* title, const std::vector<Group>& groups) {
  std::string text = fmt::format("<h2>{}</h2><div class=\"charts\">", title);
  for (const Measure& measure : kMeasures) {
    std::vector<DotLine> lines;
    for (const Group& group : groups) {
      lines.push_back({group.label, {}});
      for (const CompareRow* row : group.rows) {
        lines.back().dots.push_back({measure.value(*row), fmt::format("{}, sequence {}, plant {}", row->agent,
                                                                      row->sequence, row->plant_seed)});
      }
    }
    text += draw_dot_chart(measure.title, lines);
  }
  return text + "</div>";
}

/// Whether each plant packs one sequence only: then lines by plant would repeat those by sequence.
bool has_plants_of_their_own(const std::vector<CompareSession>& sessions) {
  for (const CompareSession& one : sessions) {
    for (const CompareSession& other : sessions) {
      if (one.row.plant_seed == other.row.plant_seed && one.row.sequence != other.row.sequence) return false;
    }
  }
  return !sessions.empty() && sessions.front().row.sequence != sessions.back().row.sequence;
}

/// The container's floor plan, y of T upwards; higher boxes are lighter and drawn later.
std::string plan_view(const Vector3& inner_size, const std::vector<BoxOutline>& boxes) {
  constexpr double kWidth = 210.0;
  const double scale = kWidth / inner_size.x(), height = scale * inner_size.y();
  const auto px = [&](const Point& p) {
    return fmt::format("{:.1f},{:.1f} ", 0.5 * kWidth + scale * p[0], 0.5 * height - scale * p[1]);
  };
  std::string svg = fmt::format(
      "<svg width=\"{0:.0f}\" height=\"{1:.0f}\" viewBox=\"-2 -2 {2:.0f} {3:.0f}\" role=\"img\">"
      "<rect width=\"{0:.0f}\" height=\"{1:.1f}\" class=\"floor\"/>",
      kWidth, height, kWidth + 4.0, height + 4.0);
  for (const BoxOutline& box : boxes) {
    svg += "<polygon points=\"";
    for (const Point& corner : box.corners_T) svg += px(corner);
    const double lightness = 50.0 + 42.0 * std::clamp(box.top / inner_size.z(), 0.0, 1.0);
    svg += fmt::format("\" style=\"fill:hsl(32 55% {:.0f}%)\"><title>{}, top at {:.0f} mm</title></polygon>", lightness,
                       escape_markup(box.id), 1e3 * box.top);
  }
  return svg + "</svg>";
}

/// A file as a link from another: relative, with what a URL cannot hold as %XX.
std::string link_to(const std::filesystem::path& file, const std::filesystem::path& from) {
  std::string url;
  const std::filesystem::path folder = std::filesystem::absolute(from).parent_path();
  for (const char c : std::filesystem::absolute(file).lexically_relative(folder).generic_string()) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || std::string_view("/.-_").find(c) != std::string_view::npos;
    url += is_plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return url;
}

std::string card(const Vector3& inner_size, const CompareSession& session, const std::filesystem::path& page) {
  const CompareRow& row = session.row;
  std::string text = fmt::format(
      "<div class=\"card\">{}<b>{:.2f} %</b> {} boxes<br>{}, plant {}<br><small>{} of {} sent as planned, {} lost, {} "
      "recoveries; {}</small>",
      plan_view(inner_size, session.boxes), row.executed_percent, row.executed_boxes, escape_markup(row.agent),
      row.plant_seed, row.items_as_planned, row.items_sent, row.boxes_lost, row.recoveries,
      escape_markup(row.failure.empty() ? row.stop_reason : row.failure));
  if (!session.report.empty()) {
    return text + fmt::format("<p><a href=\"{}\">open this run</a></p><code>{}</code></div>",
                              link_to(session.report, page), escape_markup(session.command));
  }
  return text + "<details><summary>see this run</summary><code>" + escape_markup(session.command) +
         " -o run.h5<br>snug report run.h5 -o run.html</code></details></div>";
}

constexpr const char* kStyle =
    "body{font:14px/1.45 system-ui,sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;color:#1d2733}"
    ".charts{display:flex;flex-wrap:wrap;gap:14px 20px}.floor{fill:#f4f1ec;stroke:#1d2733}"
    "polygon{stroke:#4a3a22;stroke-width:1}.cards{display:flex;flex-wrap:wrap;gap:18px}.card{width:230px}"
    "code{font-size:11px;overflow-wrap:anywhere}small{color:#56626e}";

}  // namespace

std::vector<BoxOutline> outline_boxes(const model::Scenario& scenario, const std::vector<PackedBox>& boxes) {
  std::vector<BoxOutline> outlines;
  for (const PackedBox& box : boxes) {
    const model::Parcel* parcel = model::find_parcel(scenario, box.id);
    if (parcel == nullptr) continue;
    BoxOutline outline;
    outline.id = box.id;
    std::vector<Point> corners;
    for (int i = 0; i < 8; ++i) {
      const Vector3 sign((i & 1) != 0 ? 0.5 : -0.5, (i & 2) != 0 ? 0.5 : -0.5, (i & 4) != 0 ? 0.5 : -0.5);
      const Vector3 p_T = box.X_TP * Vector3(sign.cwiseProduct(parcel->size));
      corners.push_back({p_T.x(), p_T.y()});
      outline.top = std::max(outline.top, p_T.z());
    }
    outline.corners_T = hull_of(std::move(corners));
    outlines.push_back(std::move(outline));
  }
  std::ranges::stable_sort(outlines, {}, &BoxOutline::top);
  return outlines;
}

std::string format_compare_page(const model::Scenario& scenario, const std::vector<CompareSession>& sessions,
                                const std::filesystem::path& page) {
  const std::vector<CompareSession> whole = whole_sessions(sessions);
  std::string text = fmt::format(
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}: "
      "comparison</title><style>{1}{2}</style>"
      "</head><body><h1>{0}: {3} sessions compared</h1><p>Each dot is a session: an agent packs a sequence in a plant "
      "of its own, and what is true of the plant counts. Bars are means.</p>",
      escape_markup(scenario.name), kStyle, kDotChartStyle, whole.size());
  if (whole.size() < sessions.size()) {
    text += fmt::format("<p>{} more were interrupted: they are shown below and not in the charts.</p>",
                        sessions.size() - whole.size());
  }
  text += charts("By agent", group_by(whole, [](const CompareRow& row) { return row.agent; }));
  std::vector<Group> groups =
      group_by(whole, [](const CompareRow& row) { return fmt::format("{}: {}", row.sequence, row.agent); });
  std::ranges::stable_sort(groups, {}, [](const Group& group) { return group.rows.front()->sequence; });
  text += charts("By sequence", groups);
  if (!has_plants_of_their_own(whole)) {
    groups =
        group_by(whole, [](const CompareRow& row) { return fmt::format("plant {}: {}", row.plant_seed, row.agent); });
    std::ranges::stable_sort(groups, {}, [](const Group& group) { return group.rows.front()->plant_seed; });
    text += charts("By seed of the plant", groups);
  }
  const Vector3 inner_size = model::find_container(scenario, scenario.target)->inner_size;
  text += "<h2>Containers from above</h2><p>Lighter boxes reach higher.</p>";
  for (const Group& sequence : group_by(sessions, [](const CompareRow& row) { return row.sequence; })) {
    text += "<h3>Sequence " + escape_markup(sequence.label) + "</h3><div class=\"cards\">";
    for (const CompareSession& session : sessions) {
      if (session.row.sequence == sequence.label) text += card(inner_size, session, page);
    }
    text += "</div>";
  }
  return text + "</body></html>\n";
}

}  // namespace snug::app
