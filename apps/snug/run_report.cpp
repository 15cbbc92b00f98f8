// The result of a run as text: a table for people, JSON for programs.
#include "run_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

namespace snug::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMm = 1.0e3;  // per metre

Json pose_as_json(const Pose& X) {
  const Quaternion q(X.R);
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  return {{"p", {X.p.x(), X.p.y(), X.p.z()}}, {"quat_wxyz", {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()}}};
}

Json events_as_json(const std::vector<record::Event>& events) {
  Json list = Json::array();
  for (const record::Event& event : events) {
    Json item = {{"time_s", event.time}, {"kind", event.kind}, {"body", event.body}, {"text", event.text}};
    for (const record::EventNumber& number : event.numbers) item[number.name] = number.value;
    list.push_back(std::move(item));
  }
  return list;
}

Json box_as_json(const cell::BoxResult& box) {
  return {{"id", box.id},
          {"state", cell::name_of(box.state)},
          {"X_TP", pose_as_json(box.X_TP)},
          {"up", std::string(1, box.up)},
          {"outside_mm", box.outside * kMm},
          {"above_rim_mm", box.above_rim * kMm},
          {"events", events_as_json(box.events)}};
}

Json stop_as_json(const cell::ProtectiveStop& stop) {
  return {
      {"what", stop.what},         {"where", stop.where},          {"value", stop.value}, {"limit", stop.limit},
      {"unit", stop.unit},         {"time_s", stop.time},          {"row", stop.row + 1}, {"waypoint", stop.waypoint},
      {"touching", stop.touching}, {"limited_by", stop.limited_by}};
}

Json vector_as_json(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

Json contacts_as_json(const std::vector<cell::ContactResult>& contacts) {
  Json list = Json::array();
  for (const cell::ContactResult& contact : contacts) {
    list.push_back({{"bodies", {contact.body_a, contact.body_b}},
                    {"point_m", vector_as_json(contact.p_WQ)},
                    {"normal", vector_as_json(contact.n_AB_W)},
                    {"force_N", vector_as_json(contact.force_B_W)},
                    {"gap_mm", contact.phi * kMm},
                    {"slides", contact.slides}});
  }
  return list;
}

Json lost_as_json(const std::vector<cell::LostBody>& bodies) {
  Json list = Json::array();
  for (const cell::LostBody& lost : bodies) {
    list.push_back({{"body", lost.name},
                    {"time_s", lost.time},
                    {"position_m", vector_as_json(lost.p_W)},
                    {"velocity_m_s", vector_as_json(lost.v_W)}});
  }
  return list;
}

struct RepickOffsets {
  double mean = 0.0, worst = 0.0;  ///< m
};

RepickOffsets summarize(const std::vector<cell::Repick>& repicks) {
  RepickOffsets offsets;
  for (const cell::Repick& repick : repicks) {
    offsets.mean += repick.offset / static_cast<double>(repicks.size());
    offsets.worst = std::max(offsets.worst, repick.offset);
  }
  return offsets;
}

Json repicks_as_json(const std::vector<cell::Repick>& repicks) {
  Json list = Json::array();
  for (const cell::Repick& repick : repicks) {
    list.push_back({{"id", repick.id},
                    {"offset_mm", repick.offset * kMm},
                    {"up_before", std::string(1, repick.up_before)},
                    {"up_after", std::string(1, repick.up_after)},
                    {"up_intended", std::string(1, repick.up_intended)}});
  }
  return list;
}

/// "seal 4.2 s, release 9.8 s": the kinds of a box's events, in order; of many the beginning and the end.
std::string events_of(const cell::BoxResult& box) {
  constexpr std::size_t kFirst = 5, kLast = 2;
  const std::size_t count = box.events.size();
  const std::size_t left_out = count > kFirst + kLast + 1 ? count - kFirst - kLast : 0;
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    if (left_out > 0 && i == kFirst) {
      text += fmt::format(", ... {} more", left_out);
      i += left_out;
    }
    text += fmt::format("{}{} {:.1f} s", text.empty() ? "" : ", ", box.events[i].kind, box.events[i].time);
  }
  return text;
}

std::string boxes_table(const cell::RunResult& result) {
  std::string text = fmt::format("{:<8} {:<8} {:>7} {:>7} {:>7}  {:<2} {:>8} {:>8}  {}\n", "box", "state", "x_T mm",
                                 "y_T mm", "z_T mm", "up", "out mm", "rim mm", "how it got there");
  for (const cell::BoxResult& box : result.boxes) {
    const Vector3 p = box.X_TP.p * kMm;
    text += fmt::format("{:<8} {:<8} {:>7.1f} {:>7.1f} {:>7.1f}  {:<2} {:>8.1f} {:>8.1f}  {}\n", box.id,
                        cell::name_of(box.state), p.x(), p.y(), p.z(), box.up, box.outside * kMm, box.above_rim * kMm,
                        events_of(box));
  }
  const auto packed = std::count_if(result.boxes.begin(), result.boxes.end(),
                                    [](const cell::BoxResult& box) { return box.state == cell::BoxState::Packed; });
  text += fmt::format("\npacked             {} of {} boxes\n", packed, result.boxes.size());
  text += fmt::format("filling degree     {:.2f} %\n", result.filling_degree_percent);
  if (!result.repicks.empty()) {
    const RepickOffsets offsets = summarize(result.repicks);
    text += fmt::format("re-picks           {}, offset mean {:.1f} mm, worst {:.1f} mm\n", result.repicks.size(),
                        offsets.mean * kMm, offsets.worst * kMm);
  }
  return text;
}

/// How often the arm touched something with its links, and the worst.
std::string arm_contacts(const std::vector<record::Event>& events) {
  const record::Event* worst = nullptr;
  int count = 0;
  const auto force_of = [](const record::Event& event) { return event.numbers.front().value; };
  for (const record::Event& event : events) {
    if (event.kind != "arm_contact_end") continue;
    ++count;
    if (worst == nullptr || force_of(event) > force_of(*worst)) worst = &event;
  }
  if (worst == nullptr) return "";
  return fmt::format("arm contacts       {}; {}: {}, at {:.1f} s\n", count, worst->body, worst->text, worst->time);
}

std::string bodies_table(const cell::RunResult& result) {
  std::string text =
      fmt::format("{:<16} {:>9} {:>9} {:>9} {:>10}\n", "body", "x_W mm", "y_W mm", "z_W mm", "speed m/s");
  for (const cell::BodyResult& body : result.bodies) {
    const Vector3 p = body.X_WB.p * kMm;
    text += fmt::format("{:<16} {:>9.2f} {:>9.2f} {:>9.2f} {:>10.2e}\n", body.name, p.x(), p.y(), p.z(), body.speed);
  }
  return text + "\n";
}

}  // namespace

std::string format_table(const cell::RunResult& result) {
  std::string text = result.boxes.empty() ? bodies_table(result) : boxes_table(result);
  text += fmt::format("simulated          {:.2f} s in {:.2f} s, real-time factor {:.0f}{}\n", result.duration,
                      result.wall, result.real_time_factor, result.is_interrupted ? ", ended early" : "");
  text += fmt::format("contact solver     {} steps, {} not converged, worst residual {:.1e} m/s, penetration {:.3f} mm",
                      result.solver.steps, result.solver.not_converged, result.solver.worst_residual,
                      result.solver.worst_penetration * kMm);
  if (result.solver.worst_compliant_depth > 0.0) {
    text += fmt::format(" (compliant contacts {:.3f} mm)", result.solver.worst_compliant_depth * kMm);
  }
  text += "\n";
  text += arm_contacts(result.events);
  for (const cell::LostBody& lost : result.lost) {
    text += fmt::format("out of the cell    {} at t = {:.3f} s, ({:.0f}, {:.0f}, {:.0f}) m, {:.0f} m/s\n", lost.name,
                        lost.time, lost.p_W.x(), lost.p_W.y(), lost.p_W.z(), lost.v_W.norm());
  }
  for (const std::string& warning : result.warnings) text += "warning            " + warning + "\n";
  if (!result.failure.empty()) text += "failed             " + result.failure + "\n";
  return text + fmt::format("state hash         {:016x}\n", result.state_hash);
}

std::string format_json(const cell::RunResult& result) {
  const RepickOffsets offsets = summarize(result.repicks);
  Json document = {{"duration_s", result.duration},
                   {"wall_s", result.wall},
                   {"real_time_factor", result.real_time_factor},
                   {"filling_degree_percent", result.filling_degree_percent},
                   {"boxes", Json::array()},
                   {"bodies", Json::array()},
                   {"events", events_as_json(result.events)},
                   {"repick_offset_mean_mm", offsets.mean * kMm},
                   {"repick_offset_worst_mm", offsets.worst * kMm},
                   {"repicks", repicks_as_json(result.repicks)}};
  for (const cell::BoxResult& box : result.boxes) document["boxes"].push_back(box_as_json(box));
  for (const cell::BodyResult& body : result.bodies) {
    document["bodies"].push_back({{"name", body.name}, {"X_WB", pose_as_json(body.X_WB)}, {"speed_m_s", body.speed}});
  }
  document["solver"] = {{"steps", result.solver.steps},
                        {"not_converged", result.solver.not_converged},
                        {"worst_residual_m_s", result.solver.worst_residual},
                        {"worst_penetration_mm", result.solver.worst_penetration * kMm},
                        {"worst_compliant_penetration_mm", result.solver.worst_compliant_depth * kMm},
                        {"mean_sweeps", result.solver.mean_sweeps}};
  document["state_hash"] = fmt::format("{:016x}", result.state_hash);
  document["contacts"] = contacts_as_json(result.contacts);
  document["lost"] = lost_as_json(result.lost);
  document["protective_stop"] = result.stop ? stop_as_json(*result.stop) : Json(nullptr);
  document["interrupted"] = result.is_interrupted;
  if (!result.ended_by.empty()) document["ended_by"] = result.ended_by;
  document["warnings"] = result.warnings;
  document["failure"] = result.failure;
  return document.dump(2) + "\n";
}

}  // namespace snug::app
