// The map of what is reached as text: JSON for programs, a table for people.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "snug/runs/reach_map.hpp"

namespace snug::runs {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson in_metres(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

/// Of the points of a layer that are not reached, what keeps the tool from most of them: "gripper - tote (12)".
std::string main_reasons(const ReachMap& map, const ReachLayer& layer) {
  constexpr std::size_t kMostReasons = 3;
  std::map<std::string, int> counts;
  for (const ReachPoint& point : layer.points) {
    if (point.verdict == ReachVerdict::Reached) continue;
    const std::string& what = map.whats[static_cast<std::size_t>(point.what)];
    ++counts[what.empty() ? name_of(point.verdict) : std::string(name_of(point.verdict)) + ": " + what];
  }
  std::vector<std::pair<std::string, int>> sorted(counts.begin(), counts.end());
  std::ranges::stable_sort(sorted, std::greater{}, &std::pair<std::string, int>::second);
  if (sorted.size() > kMostReasons) sorted.resize(kMostReasons);
  std::vector<std::string> parts;
  for (const auto& [reason, count] : sorted) parts.push_back(fmt::format("{} ({})", reason, count));
  return fmt::format("{}", fmt::join(parts, ", "));
}

}  // namespace

std::string format_json(const ReachMap& map) {
  const Quaternion quat = Quaternion(map.X_WT.R);
  OrderedJson json = {
      {"robot", map.robot},
      {"container", map.container},
      {"pose", {map.X_WT.p.x(), map.X_WT.p.y(), map.X_WT.p.z(), quat.w(), quat.x(), quat.y(), quat.z()}},
      {"inner_size", in_metres(map.inner_size)},
      {"columns", map.columns},
      {"rows", map.rows},
      {"tool_yaw", map.tool_yaw},
      {"verdicts", OrderedJson::array()},
      {"whats", map.whats},
      {"counts", OrderedJson::object()},
      {"layers", OrderedJson::array()},
      {"picks", OrderedJson::array()}};
  for (int i = 0; i < kReachVerdicts; ++i) {
    const char* name = name_of(static_cast<ReachVerdict>(i));
    json["verdicts"].push_back(name);
    json["counts"][name] = map.counts[static_cast<std::size_t>(i)];
  }
  for (const ReachLayer& layer : map.layers) {
    OrderedJson verdicts = OrderedJson::array(), whats = OrderedJson::array();
    for (const ReachPoint& point : layer.points) {
      verdicts.push_back(static_cast<int>(point.verdict));
      whats.push_back(point.what);
    }
    json["layers"].push_back({{"name", layer.name},
                              {"height", layer.height},
                              {"verdicts", std::move(verdicts)},
                              {"whats", std::move(whats)}});
  }
  for (const ReachPick& pick : map.picks) {
    json["picks"].push_back({{"item", pick.item},
                             {"count", pick.count},
                             {"position", in_metres(pick.p_WS)},
                             {"verdict", static_cast<int>(pick.point.verdict)},
                             {"what", pick.point.what}});
  }
  return json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

std::string format_table(const ReachMap& map) {
  std::string text = fmt::format("{} over {}, tool straight down, cup in the middle of each cell ({} x {}):\n",
                                 map.robot, map.container, map.columns, map.rows);
  for (const ReachLayer& layer : map.layers) {
    const auto reached = std::ranges::count(layer.points, ReachVerdict::Reached, &ReachPoint::verdict);
    text += fmt::format("  {:<22} {:>6.0f} mm  {:>4} of {:<4} reached", layer.name, 1e3 * layer.height, reached,
                        layer.points.size());
    const std::string reasons = main_reasons(map, layer);
    text += reasons.empty() ? "\n" : "  " + reasons + "\n";
  }
  for (const ReachPick& pick : map.picks) {
    const std::string& what = map.whats[static_cast<std::size_t>(pick.point.what)];
    text += fmt::format("  pick of {:<14} {:>6.3f} {:>6.3f} {:>6.3f}  {}{}{}\n",
                        pick.count > 1 ? fmt::format("{} and {}", pick.item, pick.count - 1) : pick.item, pick.p_WS.x(),
                        pick.p_WS.y(), pick.p_WS.z(), name_of(pick.point.verdict), what.empty() ? "" : ": ", what);
  }
  return text;
}

}  // namespace snug::runs
