// The page of a comparison: charts by agent and sequence, and every container from above, in one file without scripts.
#include "compare_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "snug/core/text.hpp"
#include "snug/replay/page.hpp"

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

/// One number of each session, on an axis that all charts share; NaN where it has none.
struct Measure {
  const char* title;
  double (*value)(const CompareRow& row);
};

constexpr Measure kMeasures[] = {
    {"filling degree by the plant's truth, %", [](const CompareRow& row) { return row.executed_percent; }},
    {"items that end as planned, %",
     [](const CompareRow& row) { return row.items_sent > 0 ? 100.0 * row.items_as_planned / row.items_sent : kNone; }},
    {"boxes an hour of the plant's time", [](const CompareRow& row) { return row.boxes_per_hour; }},
    {"time to decide and rehearse an item, median, s",
     [](const CompareRow& row) { return row.decision_seconds_median; }},
};

/// Sessions that a line of a chart is of.
struct Group {
  std::string label;
  std::vector<const CompareRow*> rows;
};

/// A line for each group: a dot for each session, a bar at their mean.
std::string chart(const Measure& measure, const std::vector<Group>& groups) {
  double low = 0.0, high = 1.0;
  bool is_first = true;
  for (const Group& group : groups) {
    for (const CompareRow* row : group.rows) {
      const double value = measure.value(*row);
      if (std::isnan(value)) continue;
      low = is_first ? value : std::min(low, value);
      high = is_first ? value : std::max(high, value);
      is_first = false;
    }
  }
  const double margin = std::max(0.05 * (high - low), 1e-3 * std::abs(high) + 1e-6);
  low = std::max(0.0, low - margin);  // nothing here is negative
  high += margin;
  constexpr double kLabel = 190.0, kPlot = 430.0, kMean = 90.0, kLine = 22.0;
  const auto x = [&](double value) { return kLabel + kPlot * (value - low) / (high - low); };
  const double height = kLine * static_cast<double>(groups.size()) + 22.0;
  std::string svg = fmt::format("<figure><figcaption>{}</figcaption><svg width=\"{}\" height=\"{}\" role=\"img\">",
                                measure.title, kLabel + kPlot + kMean, height);
  double y = 14.0;
  for (const Group& group : groups) {
    double sum = 0.0;
    int count = 0;
    svg += fmt::format(
        "<text x=\"{}\" y=\"{:.0f}\" text-anchor=\"end\">{}</text><line x1=\"{}\" x2=\"{}\" y1=\"{:.0f}\" "
        "y2=\"{:.0f}\" class=\"rule\"/>",
        kLabel - 8.0, y + 4.0, escape_markup(group.label), kLabel, kLabel + kPlot, y, y);
    for (const CompareRow* row : group.rows) {
      const double value = measure.value(*row);
      if (std::isnan(value)) continue;
      sum += value;
      ++count;
      svg += fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.0f}\" r=\"4\"><title>{}, sequence {}, plant {}: {:.4g}</title>"
          "</circle>",
          x(value), y, escape_markup(row->agent), escape_markup(row->sequence), row->plant_seed, value);
    }
    if (count > 0) {
      const double mean = sum / count;
      svg += fmt::format(
          "<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:.0f}\" y2=\"{2:.0f}\" class=\"mean\"/>"
          "<text x=\"{3}\" y=\"{4:.0f}\">mean {5:.3g}</text>",
          x(mean), y - 9.0, y + 9.0, kLabel + kPlot + 8.0, y + 4.0, mean);
    }
    y += kLine;
  }
  return svg + fmt::format(
                   "<text x=\"{}\" y=\"{:.0f}\">{:.4g}</text><text x=\"{}\" y=\"{:.0f}\" text-anchor=\"end\">"
                   "{:.4g}</text></svg></figure>",
                   kLabel, height - 4.0, low, kLabel + kPlot, height - 4.0, high);
}

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

std::string card(const Vector3& inner_size, const CompareSession& session) {
  const CompareRow& row = session.row;
  std::string text = fmt::format(
      "<div class=\"card\">{}<b>{:.2f} %</b> {} boxes<br>{}, plant {}<br><small>{} of {} sent as planned, {} lost, {} "
      "recoveries; {}</small>",
      plan_view(inner_size, session.boxes), row.executed_percent, row.executed_boxes, escape_markup(row.agent),
      row.plant_seed, row.items_as_planned, row.items_sent, row.boxes_lost, row.recoveries,
      escape_markup(row.failure.empty() ? row.stop_reason : row.failure));
  return text + "<details><summary>see this run</summary><code>" + escape_markup(session.command) +
         " -o run.h5<br>snug report run.h5 -o run.html</code></details></div>";
}

constexpr const char* kStyle =
    "body{font:14px/1.45 system-ui,sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;color:#1d2733}"
    "figure{margin:1em 0}figcaption{font-weight:600}svg text{font-size:11px;fill:#44505c}circle{fill:#2b6cb0;"
    "fill-opacity:.65}.rule{stroke:#e3e8ed}.mean{stroke:#c05621;stroke-width:3}.floor{fill:#f4f1ec;stroke:#1d2733}"
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

std::string format_compare_page(const model::Scenario& scenario, const std::vector<CompareSession>& sessions) {
  const std::vector<Group> agents = group_by(sessions, [](const CompareRow& row) { return row.agent; });
  std::string text = fmt::format(
      "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}: comparison</title><style>{1}</style>"
      "</head><body><h1>{0}: {2} sessions compared</h1><p>Each dot is a session: an agent packs a sequence in a plant "
      "of its own, and what is true of the plant counts. Bars are means.</p><h2>By agent</h2>",
      escape_markup(scenario.name), kStyle, sessions.size());
  for (const Measure& measure : kMeasures) text += chart(measure, agents);
  text += "<h2>By sequence</h2>";
  std::vector<Group> both =
      group_by(sessions, [](const CompareRow& row) { return fmt::format("{}: {}", row.sequence, row.agent); });
  std::ranges::stable_sort(both, {}, [](const Group& group) { return group.rows.front()->sequence; });
  text += chart(kMeasures[0], both);
  const Vector3 inner_size = model::find_container(scenario, scenario.target)->inner_size;
  text += "<h2>Containers from above</h2><p>Lighter boxes reach higher.</p>";
  for (const Group& sequence : group_by(sessions, [](const CompareRow& row) { return row.sequence; })) {
    text += "<h3>Sequence " + escape_markup(sequence.label) + "</h3><div class=\"cards\">";
    for (const CompareSession& session : sessions) {
      if (session.row.sequence == sequence.label) text += card(inner_size, session);
    }
    text += "</div>";
  }
  return text + "</body></html>\n";
}

}  // namespace snug::app
