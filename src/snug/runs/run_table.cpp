// The result of a run as a table for people.
#include "snug/runs/run_table.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "snug/core/units.hpp"

namespace snug::runs {
namespace {

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

std::string boxes_table(const RunResult& result) {
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

std::string bodies_table(const RunResult& result) {
  std::string text =
      fmt::format("{:<16} {:>9} {:>9} {:>9} {:>10}\n", "body", "x_W mm", "y_W mm", "z_W mm", "speed m/s");
  for (const BodyResult& body : result.bodies) {
    const Vector3 p = body.X_WB.p * kMm;
    text += fmt::format("{:<16} {:>9.2f} {:>9.2f} {:>9.2f} {:>10.2e}\n", body.name, p.x(), p.y(), p.z(), body.speed);
  }
  return text + "\n";
}

}  // namespace

std::string format_table(const RunResult& result) {
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
  if (result.failure) text += "failed             " + result.failure.text + "\n";
  return text + fmt::format("state hash         {:016x}\n", result.state_hash);
}

}  // namespace snug::runs
