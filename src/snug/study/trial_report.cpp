// The result of packing as text: a table for people, JSON for programs.
#include "snug/study/trial_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "snug/study/calibration_json.hpp"

namespace snug::study {
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

Json as_json(const planning::AttemptForces& forces) {
  return {{"force_N", forces.force}, {"torque_Nm", forces.torque}, {"displacement_mm", 1e3 * forces.displacement}};
}

Json as_json(const plant::End& end) {
  return {{"reason", plant::name_of(end.reason)},
          {"waypoint", end.waypoint ? end.waypoint->value : -1},
          {"value", end.value},
          {"limit", end.limit},
          {"where", end.where}};
}

Json sends_as_json(const session::ItemReport& item, const study::TrueItem& truth) {
  Json sends = Json::array();
  for (std::size_t i = 0; i < item.sends.size(); ++i) {
    const session::Send& send = item.sends[i];
    sends.push_back({{"time", send.time},
                     {"predicted_success", send.predicted_success},
                     {"succeeded", i < truth.succeeded.size() && truth.succeeded[i]},
                     {"end", as_json(send.end)},
                     {"trouble", session::name_of(send.trouble)}});
  }
  return sends;
}

Json recoveries_as_json(const std::vector<session::Recovery>& recoveries) {
  Json list = Json::array();
  for (const session::Recovery& one : recoveries) {
    list.push_back({{"time", one.time},
                    {"trouble", session::name_of(one.trouble)},
                    {"remedy", session::name_of(one.remedy)},
                    {"detail", one.detail}});
  }
  return list;
}

Json steps_as_json(const std::vector<session::OperatorStep>& steps) {
  Json list = Json::array();
  for (const session::OperatorStep& one : steps) {
    list.push_back({{"time", one.time}, {"order", one.order}, {"was_followed", one.was_followed}, {"text", one.text}});
  }
  return list;
}

Json attempts_as_json(const std::vector<planning::Tried>& attempts) {
  Json list = Json::array();
  for (const planning::Tried& one : attempts) {
    list.push_back({{"planned", as_json(one.planned)},
                    {"insertion", skills::name_of(one.skill)},
                    {"failure", planning::name_of(one.failure)},
                    {"succeeded", one.succeeded},
                    {"samples_succeeded", one.success_rate},
                    {"reason", one.reason}});
  }
  return list;
}

Json as_json(const session::ItemSeconds& seconds) {
  return {{"travel", rounded(seconds.travel, 6)},   {"carry", rounded(seconds.carry, 6)},
          {"regrasp", rounded(seconds.regrasp, 6)}, {"insert", rounded(seconds.insert, 6)},
          {"push", rounded(seconds.push, 6)},       {"wait", rounded(seconds.wait, 6)},
          {"total", rounded(seconds.total(), 6)}};
}

Json as_json(const session::ItemReport& item, const study::TrueItem& truth) {
  Json json{{"box", item.id}, {"placed", item.is_packed()}, {"end", session::name_of(item.end)}};
  if (!item.reason.empty()) json["reason"] = item.reason;
  if (!item.sends.empty()) {
    json["planned"] = as_json(item.planned);
    json["believed"] = item.X_TP ? position_as_json(item.X_TP->p) : Json();
    json["insertion"] = skills::name_of(item.skill);
    json["flips"] = item.flips;
    json["reorientation"] = skills::name_of(item.reorientation);
    json["as_planned"] = truth.is_as_planned;
    json["position_error_mm"] = 1e3 * truth.position_error;
    json["angle_error_deg"] = truth.angle_error / kDegree;
    json["samples"] = item.samples;
    json["samples_succeeded"] = item.samples > 0 ? Json(item.success_rate) : Json();
    json["predicted_success"] = item.predicted_success;
    json["predicted"] = item.samples > 0 ? as_json(item.predicted) : Json();
    json["happened"] = as_json(item.measured);
    const simulated_plant::MotionTruth& motion = truth.motion;
    const bool was_held = std::isfinite(motion.hold_factor);
    json["hold_factor"] = was_held ? Json(rounded(motion.hold_factor, 6)) : Json();
    json["swing_mm"] = was_held ? Json(1e3 * motion.swing) : Json();
    json["swing_deg"] = was_held ? Json(motion.swing_angle / kDegree) : Json();
    json["joint_speed_share"] = motion.joint_speed;
    json["joint_acceleration_share"] = motion.joint_acceleration;
    json["sends"] = sends_as_json(item, truth);
  }
  for (const packing::Placement& one : item.made_room) json["made_room"].push_back(as_json(one));
  if (!item.sends.empty() || !item.recoveries.empty()) json["recoveries"] = recoveries_as_json(item.recoveries);
  if (!item.operator_steps.empty()) json["operator"] = steps_as_json(item.operator_steps);
  json["seconds"] = as_json(item.seconds);
  json["attempts"] = item.attempts;
  json["failed_attempts"] = attempts_as_json(item.failed_attempts);
  json["protective_stops"] = item.stops;
  json["decision_seconds"] = item.decision_seconds;
  json["rehearsal_seconds"] = item.rehearsal_seconds;
  json["planning_wait"] = item.planning_wait;
  return json;
}

Json as_json(const session::ObstacleReport& one) {
  return {{"number", one.number},
          {"seen", one.seen},
          {"gone", one.gone ? Json(*one.gone) : Json()},
          {"low_T", position_as_json(one.low_T)},
          {"high_T", position_as_json(one.high_T)},
          {"height_mm", rounded(1e3 * one.high_T.z(), 3)}};
}

/// By the plant's truth.
Json as_json(const simulated_plant::ForeignObject& one) {
  const Quaternion q(one.X_TB.R);
  return {{"name", one.name},
          {"size", as_json(simulated_plant::kForeignSize)},
          {"is_in", one.is_in},
          {"X_TB", {{"p", as_json(one.X_TB.p)}, {"quat_wxyz", {q.w(), q.x(), q.y(), q.z()}}}},
          {"moved_mm", 1e3 * (one.X_TB.p - one.X_TB_put.p).norm()},
          {"peak_force_N", one.peak_force}};
}

/// By the plant's truth.
Json as_json(const cell::BoxResult& box) {
  const Quaternion q(box.X_TP.R);
  return {{"id", box.id},
          {"state", cell::name_of(box.state)},
          {"X_TP", {{"p", as_json(box.X_TP.p)}, {"quat_wxyz", {q.w(), q.x(), q.y(), q.z()}}}}};
}

session::ItemSeconds sum_of_seconds(const session::SessionResult& result) {
  session::ItemSeconds sum;
  for (const session::ItemReport& item : result.items) sum += item.seconds;
  return sum;
}

Json as_json(const study::MonteCarloResult& repeated) {
  Json items = Json::array();
  for (const study::ItemSpread& item : repeated.items) {
    items.push_back({{"box", item.id},
                     {"succeeded", item.succeeded},
                     {"deviation_mm", as_json(1e3 * item.deviation)},
                     {"worst_distance_mm", 1e3 * item.worst_distance}});
  }
  return {{"count", repeated.count},
          {"failed", repeated.failed},
          {"success_percent", repeated.success_percent},
          {"mean_filling_percent", repeated.mean_filling_percent},
          {"lowest_filling_percent", repeated.lowest_filling_percent},
          {"items", items}};
}

/// "12.3 s a box that is not turned (9 of 14), tempo 1"
std::string how_fast(const study::Trial& trial) {
  const cell::SimulationOptions& how = trial.plant.simulation;
  std::string text = trial.unturned_cycle > 0.0
                         ? fmt::format("{:.1f} s a box that is not turned, ", trial.unturned_cycle)
                         : std::string();
  return text + (motion::is_fast(how.tracking) ? fmt::format("tempo {:g}", motion::tempo_of(how.tracking))
                                               : std::string("with the demonstrator's lag"));
}

std::string describe_hold(const study::Trial& trial) {
  const auto worst =
      std::ranges::min_element(trial.items, {}, [](const study::TrueItem& one) { return one.motion.hold_factor; });
  if (worst == trial.items.end() || !std::isfinite(worst->motion.hold_factor)) return {};
  return fmt::format("hold of the cup    {:.1f} times its load, at the worst instant ({})\n", worst->motion.hold_factor,
                     worst->id);
}

/// "         tried  100.6, 238.7, 116.1 mm, +Y up, tilted: it would stick out", a line for each
std::string describe(const std::vector<planning::Tried>& attempts) {
  std::string text;
  for (const planning::Tried& one : attempts) {
    const Vector3 p = 1e3 * one.planned.X_TP.p;
    const std::string rate =
        one.succeeded ? fmt::format(", {:.0f} % of the samples succeed", 100.0 * one.success_rate) : std::string();
    text += fmt::format("         tried {:7.1f} {:7.1f} {:7.1f} mm, {}{} up, {}{}: {}\n", p.x(), p.y(), p.z(),
                        one.planned.orientation.up_sign > 0 ? '+' : '-',
                        static_cast<char>('X' + static_cast<int>(one.planned.orientation.up)),
                        skills::name_of(one.skill), rate, one.reason);
  }
  return text;
}

}  // namespace

std::string format_pack_head(const std::string& sequence, const session::SessionOptions& session,
                             const simulated_plant::SimulatedPlantOptions& plant, const std::string& address) {
  const std::string& robot = plant.simulation.robot;
  return fmt::format(
      "sequence {}, agent {}, seed {}; plant {}, perception {}, robot {}, {} samples\n\n"
      "                 planned place, mm       turned      insertion          success  error, true pose  peak force, "
      "N  "
      "moved  decided, rehearsed         seconds of the plant\n"
      "box          x_T     y_T     z_T  up                                  predicted     mm    deg     pred.  meas.  "
      "   "
      "mm      s      s  times  cycle travel  carry regrasp insert  push  wait\n",
      sequence, session.agent, session.decision.seed, address.empty() ? fmt::format("seed {}", plant.seed) : address,
      perception::name_of(plant.perception), robot.empty() ? "none" : robot, session.samples);
}

std::string format_item(const session::ItemReport& item, const study::TrueItem& truth) {
  std::string text;
  if (item.sends.empty()) {
    text = fmt::format("{:<8} {}: {}  (decided in {:.2f} s, {} attempts)\n", item.id, session::name_of(item.end),
                       item.reason, item.decision_seconds, item.attempts);
    text += describe(item.failed_attempts);
  } else {
    const Vector3 p = 1e3 * item.planned.X_TP.p;
    text = fmt::format(
        "{:<8} {:7.1f} {:7.1f} {:7.1f}  {}{}  {:<11} {:<17} {:>9}  {:6.1f} {:6.1f}    {:>6} {:6.0f} {:6.1f} "
        "{:6.2f} {:6.2f} {:6}  {:5.1f} {:6.1f} {:6.1f} {:7.1f} {:6.1f} {:5.1f} {:5.1f}{}\n",
        item.id, p.x(), p.y(), p.z(), item.planned.orientation.up_sign > 0 ? '+' : '-',
        static_cast<char>('X' + static_cast<int>(item.planned.orientation.up)), skills::name_of(item.reorientation),
        skills::name_of(item.skill),
        item.samples > 0 ? fmt::format("{:.0f} %", 100.0 * item.predicted_success) : std::string("-"),
        1e3 * truth.position_error, truth.angle_error / kDegree,
        item.samples > 0 ? fmt::format("{:.0f}", item.predicted.force) : std::string("-"), item.measured.force,
        1e3 * truth.displacement, item.decision_seconds, item.rehearsal_seconds, item.attempts, item.seconds.total(),
        item.seconds.travel, item.seconds.carry, item.seconds.regrasp, item.seconds.insert, item.seconds.push,
        item.seconds.wait,
        item.end == session::ItemEnd::Placed ? std::string() : fmt::format("  {}", session::name_of(item.end)));
  }
  if (!item.made_room.empty()) text += "         " + session::describe_room(item) + "\n";
  for (const session::OperatorStep& one : item.operator_steps) {
    text += fmt::format("         at {:.1f} s operator: {}\n", one.time, describe(one));
  }
  for (const session::Recovery& one : item.recoveries) {
    text += fmt::format("         at {:.1f} s {}: {}{}\n", one.time, session::name_of(one.trouble),
                        session::name_of(one.remedy), one.detail.empty() ? "" : " (" + one.detail + ")");
  }
  return text;
}

std::string format_summary(const study::Trial& trial, const study::MonteCarloResult& repeated) {
  const session::SessionResult& result = trial.session;
  std::string text =
      fmt::format("\nstopped            {} ({})\n", result.stopped, session::name_of(result.stop_reason));
  text += fmt::format("planned            {} boxes, {:.2f} %\n", result.plan.size(), result.planned_percent);
  text += fmt::format("executed           {} boxes, {:.2f} %\n", trial.executed_boxes, trial.executed_percent);
  if (result.percent_before_skips) {
    text += fmt::format("before skipping    {:.2f} %\n", *result.percent_before_skips);
  }
  text += fmt::format("items              {} sent, {} as planned, {} lost, {} recoveries\n", trial.items_sent,
                      trial.items_as_planned, trial.boxes_lost, trial.recoveries);
  for (const session::ObstacleReport& one : result.obstacles) {
    text += fmt::format("obstacle {:<10}at {:.1f} s {}{}\n", one.number, one.seen, session::describe(one),
                        one.gone ? fmt::format(", gone at {:.1f} s", *one.gone) : std::string());
  }
  int stops = 0;
  for (const session::ItemReport& item : result.items) stops += item.stops;
  if (stops > 0) text += fmt::format("protective stops   {} attempts that were given up\n", stops);
  text += fmt::format("decision           {:.2f} s an item (median), agent {}\n", result.decision_seconds_median,
                      result.agent);
  text += fmt::format("plant              {:.1f} s, {} waypoints\n", result.duration, result.program.waypoints.size());
  text += fmt::format("speed              {:.0f} boxes an hour, {:.0f} with the waits for a plan, {}\n",
                      trial.boxes_per_hour, trial.boxes_per_hour_with_planning, how_fast(trial));
  text += describe_hold(trial);
  if (!trial.is_elsewhere) text += fmt::format("state hash         {:016x}\n", trial.state_hash);
  if (repeated.count == 0) return text;
  text += fmt::format("\nopen loop, {} runs in cells drawn from the scenario's uncertainty\n", repeated.count);
  text += "box      succeeded   deviation x, y, z, mm   farthest, mm\n";
  for (const study::ItemSpread& item : repeated.items) {
    text += fmt::format("{:<8} {:4} of {:<4} {:6.1f} {:6.1f} {:6.1f}      {:8.1f}\n", item.id, item.succeeded,
                        repeated.count, 1e3 * item.deviation.x(), 1e3 * item.deviation.y(), 1e3 * item.deviation.z(),
                        1e3 * item.worst_distance);
  }
  if (repeated.failed > 0) text += fmt::format("did not end        {} of {}\n", repeated.failed, repeated.count);
  text += fmt::format("items that succeed {:.1f} %\n", repeated.success_percent);
  text += fmt::format("filling degree     mean {:.2f} %, lowest {:.2f} %\n", repeated.mean_filling_percent,
                      repeated.lowest_filling_percent);
  return text;
}

std::string format_json(const study::Trial& trial, const study::MonteCarloResult& repeated) {
  const session::SessionResult& result = trial.session;
  Json json{{"sequence", result.sequence},
            {"agent", result.agent},
            {"seed", trial.seed},
            {"plant", result.plant},
            {"plant_seed", trial.is_elsewhere ? Json() : Json(trial.plant_seed)},
            {"perception", perception::name_of(trial.plant.perception)},
            {"robot", trial.plant.simulation.robot.empty() ? "none" : trial.plant.simulation.robot},
            {"planned_boxes", result.plan.size()},
            {"planned_percent", result.planned_percent},
            {"executed_boxes", trial.executed_boxes},
            {"executed_percent", trial.executed_percent},
            {"percent_before_skips", result.percent_before_skips ? Json(*result.percent_before_skips) : Json()},
            {"items_sent", trial.items_sent},
            {"items_as_planned", trial.items_as_planned},
            {"boxes_lost", trial.boxes_lost},
            {"recoveries", trial.recoveries},
            {"decision_seconds_median", result.decision_seconds_median},
            {"stop_reason", session::name_of(result.stop_reason)},
            {"stopped", result.stopped},
            {"failure", result.failure.text},
            {"failure_kind", session::name_of(result.failure.kind)},
            {"duration", result.duration},
            {"controller", motion::name_of(trial.plant.simulation.tracking)},
            {"tempo", motion::is_fast(trial.plant.simulation.tracking)
                          ? Json(motion::tempo_of(trial.plant.simulation.tracking))
                          : Json()},
            {"boxes_per_hour", trial.boxes_per_hour},
            {"boxes_per_hour_with_planning", trial.boxes_per_hour_with_planning},
            {"unturned_cycle_seconds", trial.unturned_cycle > 0.0 ? Json(trial.unturned_cycle) : Json()},
            {"seconds", as_json(sum_of_seconds(result))},
            {"state_hash", trial.is_elsewhere ? Json() : Json(fmt::format("{:016x}", trial.state_hash))}};
  json["items"] = Json::array();
  for (const session::ItemReport& item : result.items) {  // those left out when planned have no truth
    const auto truth = std::ranges::find(trial.items, item.id, &study::TrueItem::id);
    json["items"].push_back(as_json(item, truth != trial.items.end() ? *truth : study::TrueItem{}));
  }
  json["boxes"] = Json::array();
  for (const cell::BoxResult& box : trial.boxes) json["boxes"].push_back(as_json(box));
  json["obstacles"] = Json::array();
  for (const session::ObstacleReport& one : result.obstacles) json["obstacles"].push_back(as_json(one));
  if (!trial.objects.empty()) {
    json["objects"] = Json::array();
    for (const simulated_plant::ForeignObject& one : trial.objects) json["objects"].push_back(as_json(one));
  }
  study::Calibration calibration;
  calibration.add(trial);
  json["calibration"] = study::calibration_json(calibration);
  if (repeated.count > 0) json["monte_carlo"] = as_json(repeated);
  json["of_clock"] = {"decision_seconds_median", "boxes_per_hour_with_planning", "decision_seconds",
                      "rehearsal_seconds", "planning_wait"};
  return json.dump(2) + "\n";
}

std::string format_plan(const session::SessionResult& result, bool is_complete) {
  Json plan{{"sequence", result.sequence}, {"agent", result.agent}};
  if (!is_complete) plan["complete"] = false;
  plan["placements"] = Json::array();
  for (const packing::Placement& placement : result.plan) plan["placements"].push_back(as_json(placement));
  return plan.dump(2) + "\n";
}

std::string find_failure(const session::SessionResult& result, const MonteCarloResult& repeated, bool wants_program) {
  if (!result.failure.text.empty()) return result.failure.text;
  const std::vector<std::string> rejected = session::rejected_items(result);
  if (!rejected.empty()) return fmt::format("the load is not accepted: {}", fmt::join(rejected, "; "));
  if (result.stop_reason == session::StopReason::NoFrame && !result.stopped.empty()) return result.stopped;
  if (repeated.failed > 0) return fmt::format("{} of {} repeated runs did not finish", repeated.failed, repeated.count);
  if (wants_program && result.program.waypoints.empty()) return "nothing was packed: no program, no recording";
  return {};
}

}  // namespace snug::study
