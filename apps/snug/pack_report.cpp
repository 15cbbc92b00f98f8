// The result of packing as text: a table for people, JSON for programs.
#include "pack_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace snug::app {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kDegree = std::numbers::pi / 180.0;

/// To so many decimals, and no negative zero: digits beyond what is meant do not help people who compare files.
double rounded(double value, double decimals) {
  const double scale = std::pow(10.0, decimals);
  return std::round(value * scale) / scale + 0.0;
}

Json as_json(const Vector3& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// m, to a micrometre.
Json position_as_json(const Vector3& p) {
  return Json::array({rounded(p.x(), 6), rounded(p.y(), 6), rounded(p.z(), 6)});
}

Json as_json(const packing::Placement& placement) {
  const Quaternion q(placement.X_TP.R);
  return {
      {"box", placement.item},
      {"position", position_as_json(placement.X_TP.p)},
      {"quaternion_wxyz", Json::array({rounded(q.w(), 9), rounded(q.x(), 9), rounded(q.y(), 9), rounded(q.z(), 9)})},
      {"up", std::string(1, static_cast<char>('X' + static_cast<int>(placement.orientation.up)))},
      {"up_sign", placement.orientation.up_sign},
      {"yaw_quarter", placement.orientation.yaw_quarter}};
}

Json as_json(const task::AttemptForces& forces) {
  return {{"force_N", forces.force}, {"torque_Nm", forces.torque}, {"displacement_mm", 1e3 * forces.displacement}};
}

Json as_json(const task::ItemReport& item) {
  Json json{{"box", item.id}, {"placed", item.is_placed}};
  if (!item.is_placed) json["reason"] = item.reason;
  if (item.is_placed) {
    json["planned"] = as_json(item.planned);
    json["manner"] = task::name_of(item.manner);
    json["flips"] = item.flips;
    json["turned"] = task::name_of(item.turn);
    json["position_error_mm"] = 1e3 * item.position_error;
    json["angle_error_deg"] = item.angle_error / kDegree;
    json["samples"] = item.samples;
    json["samples_succeeded"] = item.samples > 0 ? Json(item.share) : Json();
    json["predicted"] = item.samples > 0 ? as_json(item.predicted) : Json();
    json["happened"] = as_json(item.happened);
  }
  json["attempts"] = item.attempts;
  json["protective_stops"] = item.stops;
  json["decision_seconds"] = item.decision_seconds;
  json["prediction_seconds"] = item.prediction_seconds;
  return json;
}

Json as_json(const task::ExecutionResult& executions) {
  Json items = Json::array();
  for (const task::ItemSpread& item : executions.items) {
    items.push_back({{"box", item.id},
                     {"succeeded", item.succeeded},
                     {"deviation_mm", as_json(1e3 * item.deviation)},
                     {"worst_distance_mm", 1e3 * item.worst_distance}});
  }
  return {{"count", executions.count},
          {"failed", executions.failed},
          {"success_percent", executions.success_percent},
          {"mean_filling_percent", executions.mean_filling_percent},
          {"lowest_filling_percent", executions.lowest_filling_percent},
          {"items", items}};
}

std::string item_line(const task::ItemReport& item) {
  if (!item.is_placed) {
    return fmt::format("{:<8} {}  (decided in {:.2f} s, {} attempts)\n", item.id, item.reason, item.decision_seconds,
                       item.attempts);
  }
  const Vector3 p = 1e3 * item.planned.X_TP.p;
  const auto of_samples = [&](double value, const char* form) {
    return item.samples > 0 ? fmt::format(fmt::runtime(form), value) : std::string("-");
  };
  return fmt::format(
      "{:<8} {:7.1f} {:7.1f} {:7.1f}  {}{}  {:<9}  {:<8} {:6.1f} {:6.1f} {:8.2f} {:>6.2f} {:5} {:>6} "
      "{:>5} {:5.0f} {:>6} {:6.1f}\n",
      item.id, p.x(), p.y(), p.z(), item.planned.orientation.up_sign > 0 ? '+' : '-',
      static_cast<char>('X' + static_cast<int>(item.planned.orientation.up)), task::name_of(item.turn),
      task::name_of(item.manner), 1e3 * item.position_error, item.angle_error / kDegree, item.decision_seconds,
      item.prediction_seconds, item.attempts, of_samples(100.0 * item.share, "{:.0f}%"),
      of_samples(item.predicted.force, "{:.0f}"), item.happened.force,
      of_samples(1e3 * item.predicted.displacement, "{:.1f}"), 1e3 * item.happened.displacement);
}

}  // namespace

std::string format_table(const task::SessionResult& result, const task::ExecutionResult& executions) {
  std::string text =
      "                 planned place, mm       turned     placed   error, of pose   decided  tried        samples "
      "peak force, N  moved, mm\n"
      "box          x_T     y_T     z_T  up                           mm    deg        s      s  times   good "
      "pred. happ.  pred.  happ.\n";
  for (const task::ItemReport& item : result.items) text += item_line(item);
  text += fmt::format("\nstopped            {}\n", result.stopped);
  text += fmt::format("planned            {} boxes, {:.2f} %\n", result.planned_boxes, result.planned_percent);
  text += fmt::format("executed           {} boxes, {:.2f} %\n", result.executed_boxes, result.executed_percent);
  int stops = 0;
  for (const task::ItemReport& item : result.items) stops += item.stops;
  if (stops > 0) text += fmt::format("protective stops   {} attempts that were given up\n", stops);
  text += fmt::format("decision           {:.2f} s an item (median), agent {}\n", result.decision_seconds_median,
                      result.agent);
  text += fmt::format("simulated          {:.1f} s, {} rows\n", result.duration, result.program.waypoints.size());
  text += fmt::format("state hash         {:016x}\n", result.state_hash);
  if (executions.count == 0) return text;
  text += fmt::format("\nopen loop, {} executions under sampled uncertainty\n", executions.count);
  text += "box      succeeded   deviation x, y, z, mm   farthest, mm\n";
  for (const task::ItemSpread& item : executions.items) {
    text += fmt::format("{:<8} {:4} of {:<4} {:6.1f} {:6.1f} {:6.1f}      {:8.1f}\n", item.id, item.succeeded,
                        executions.count, 1e3 * item.deviation.x(), 1e3 * item.deviation.y(), 1e3 * item.deviation.z(),
                        1e3 * item.worst_distance);
  }
  if (executions.failed > 0) text += fmt::format("did not end        {} of {}\n", executions.failed, executions.count);
  text += fmt::format("items that succeed {:.1f} %\n", executions.success_percent);
  text += fmt::format("filling degree     mean {:.2f} %, lowest {:.2f} %\n", executions.mean_filling_percent,
                      executions.lowest_filling_percent);
  return text;
}

std::string format_json(const task::SessionResult& result, const task::ExecutionResult& executions) {
  Json json{{"sequence", result.sequence},
            {"agent", result.agent},
            {"planned_boxes", result.planned_boxes},
            {"planned_percent", result.planned_percent},
            {"executed_boxes", result.executed_boxes},
            {"executed_percent", result.executed_percent},
            {"decision_seconds_median", result.decision_seconds_median},
            {"stopped", result.stopped},
            {"failure", result.failure},
            {"duration", result.duration},
            {"state_hash", fmt::format("{:016x}", result.state_hash)}};
  json["items"] = Json::array();
  for (const task::ItemReport& item : result.items) json["items"].push_back(as_json(item));
  if (executions.count > 0) json["executions"] = as_json(executions);
  return json.dump(2) + "\n";
}

std::string format_plan(const task::SessionResult& result) {
  Json plan{{"sequence", result.sequence}, {"agent", result.agent}};
  plan["placements"] = Json::array();
  for (const packing::Placement& placement : result.plan) plan["placements"].push_back(as_json(placement));
  return plan.dump(2) + "\n";
}

}  // namespace snug::app
