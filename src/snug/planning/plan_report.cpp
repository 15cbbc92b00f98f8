// Plan report: a decision for people and programs: what was tried and why it lost.
#include "snug/planning/plan_report.hpp"

#include <fmt/format.h>

#include "snug/planning/json_forms.hpp"

namespace snug::planning {
namespace {

std::string place_of(const packing::Placement& placement) {
  const Vector3 p = 1e3 * placement.X_TP.p;
  const char up = static_cast<char>('X' + static_cast<int>(placement.orientation.up));
  return fmt::format("{:7.1f} {:7.1f} {:7.1f}  {}{}{}", p.x(), p.y(), p.z(),
                     placement.orientation.up_sign < 0 ? '-' : '+', up, placement.orientation.yaw_quarter);
}

/// Why it lost, or what speaks for it.
std::string why(const Tried& one) {
  if (!one.reason.empty()) return one.reason;
  switch (one.verdict) {
    case Verdict::CannotWin:
      return "even if it were certain";
    case Verdict::SearchEnded:
      return "the best is good enough, or the limit of attempts is reached";
    case Verdict::LessUtility:
      return "another one is worth more";
    default:
      return {};
  }
}

JsonValue json_of(const Tried& one) {
  JsonWriter writer;
  writer("planned", one.planned);
  writer("verdict", std::string(name_of(one.verdict)));
  writer("expected_percent", one.expected_percent);
  writer("cost", one.cost);
  writer("utility", one.utility);
  if (one.was_rehearsed()) {
    writer("insertion", one.skill);
    writer("failure", one.failure);
    writer("succeeded", one.succeeded);
    writer("samples", one.samples);
    writer("success_rate", one.success_rate);
  }
  writer("reason", one.reason);
  return writer.take();
}

}  // namespace

std::string format_plan_table(const PlanRequest& request, const Plan& plan) {
  const BeliefSnapshot& belief = request.belief;
  std::string text =
      fmt::format("item          {} ({} of {}) of sequence {}, agent {}\n", belief.items[plan.item.slot()].id,
                  plan.item.value + 1, belief.items.size(), belief.sequence, belief.agent.name);
  text += fmt::format("belief        {:016x}, {} sampled worlds\n", hash(belief), belief.worlds.size() - 1);
  text += fmt::format("plan          {:016x}, {}{}{}\n", hash(plan), name_of(plan.outcome),
                      plan.reason.empty() ? "" : ": ", plan.reason);
  if (plan.best) {
    text +=
        fmt::format("place         {}   {}, {}, success {:.0f} %\n", place_of(plan.best->planned),
                    skills::name_of(plan.best->skill),
                    plan.best->reorientation == skills::Reorientation::None ? "not turned"
                                                                            : skills::name_of(plan.best->reorientation),
                    100.0 * plan.predicted_success);
  }
  text += fmt::format("attempts      {} rehearsed\n\n", plan.attempts);
  text += "      x       y       z  up   expected    cost  utility  insertion         samples  verdict\n";
  text += "                     mm             %       %        %\n";
  for (const Tried& one : plan.tried) {
    const std::string samples =
        one.was_rehearsed() && one.samples > 0 ? fmt::format("{:3.0f} %", 100.0 * one.success_rate) : "-";
    text +=
        fmt::format("{}  {:9.2f} {:7.2f} {:8.2f}  {:<17} {:>7}  {}{}{}\n", place_of(one.planned), one.expected_percent,
                    one.cost, one.utility, one.was_rehearsed() ? skills::name_of(one.skill) : "-", samples,
                    name_of(one.verdict), why(one).empty() ? "" : ": ", why(one));
  }
  return text;
}

std::string format_plan_json(const PlanRequest& request, const Plan& plan) {
  JsonWriter writer;
  writer("item", request.belief.items[plan.item.slot()].id);
  writer("sequence", request.belief.sequence);
  writer("agent", request.belief.agent.name);
  writer("belief_hash", fmt::format("{:016x}", hash(request.belief)));
  writer("plan_hash", fmt::format("{:016x}", hash(plan)));
  writer("outcome", std::string(name_of(plan.outcome)));
  writer("reason", plan.reason);
  writer("attempts", plan.attempts);
  writer("protective_stops", plan.stops);
  if (plan.best) {
    writer("planned", plan.best->planned);
    writer("insertion", plan.best->skill);
    writer("reorientation", plan.best->reorientation);
    writer("flips", plan.flips);
    writer("samples", plan.best->samples);
    writer("success_rate", plan.best->success_rate);
    writer("predicted_success", plan.predicted_success);
  }
  JsonValue::Object object = std::get<JsonValue::Object>(writer.take().value);
  JsonValue::Array tried;
  for (const Tried& one : plan.tried) tried.push_back(json_of(one));
  object.push_back({"tried", {std::move(tried)}});
  return format_json({std::move(object)}) + "\n";
}

}  // namespace snug::planning
