// DecisionList: what a session decided, item by item: candidates, why others lost, predicted against what happened.
#include "snug/workspace/decision_list.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <variant>
#include <vector>

#include "snug/core/text.hpp"
#include "snug/session/event_log.hpp"

namespace snug::workspace {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kMostCandidates = 60;  // of one decision, for people
constexpr std::array<std::string_view, 6> kUnread = {"stepped",      "item brought",   "perceived",
                                                     "plan dropped", "motion started", "decided before"};

bool is_unread(std::string_view line) {
  constexpr std::string_view kBegin = "{\"event\":\"";
  if (!line.starts_with(kBegin)) return false;
  const std::string_view kind = line.substr(kBegin.size(), line.find('"', kBegin.size()) - kBegin.size());
  return std::ranges::find(kUnread, kind) != kUnread.end();
}

ordered_json millimetres(const Vector3& p) { return {1e3 * p.x(), 1e3 * p.y(), 1e3 * p.z()}; }

/// The edges along the container's axes as the box stands there; those of a box that leans are those around it.
ordered_json extent_mm(const Matrix3& R_TP, const Vector3& size) { return millimetres(R_TP.cwiseAbs() * size); }

ordered_json forces_json(const planning::AttemptForces& forces) {
  return {{"force_N", forces.force}, {"torque_Nm", forces.torque}, {"displacement_mm", 1e3 * forces.displacement}};
}

class DecisionFold {
 public:
  void add(const session::SessionEvent& one) {
    std::visit(
        [&](const auto& event) {
          if constexpr (requires { take(event); }) take(event);
        },
        one);
  }
  ordered_json json() const {
    return {{"items", items_}, {"decisions", decisions_}, {"standing", standing_}, {"held", held_}, {"now", now_}};
  }

 private:
  std::string id_of(model::ItemIndex item) const {
    return item.is_valid() && item.slot() < ids_.size() ? ids_[item.slot()] : std::string();
  }
  /// Of the last decision for the item; nullptr: there is none.
  ordered_json* last_of(model::ItemIndex item) {
    const std::string id = id_of(item);
    for (auto one = decisions_.rbegin(); one != decisions_.rend(); ++one) {
      if ((*one)["item"] == id) return &*one;
    }
    return nullptr;
  }

  void take(const session::event::SessionStarted& one) {
    *this = {};
    for (const model::ParcelId& id : one.items) {
      ids_.push_back(id.value);
      items_.push_back(id.value);
    }
  }
  void take(const session::event::ItemStarted& one) { now_ = id_of(one.item); }
  void take(const session::event::Planned& one) {
    ordered_json decision = {{"item", id_of(one.item)},
                             {"time", one.time},
                             {"outcome", planning::name_of(one.outcome)},
                             {"reason", one.reason},
                             {"planning_seconds", one.decision_seconds + one.rehearsal_seconds},
                             {"waited_seconds", one.waited}};
    ordered_json tried = ordered_json::array();
    for (const planning::Tried& two : one.tried) {
      if (tried.size() == kMostCandidates) break;
      tried.push_back({{"position_mm", millimetres(two.planned.X_TP.p)},
                       {"verdict", planning::name_of(two.verdict)},
                       {"insertion", skills::name_of(two.skill)},
                       {"expected_percent", two.expected_percent},
                       {"cost", two.cost},
                       {"utility", two.utility},
                       {"samples", two.samples},
                       {"success_rate", two.success_rate},
                       {"failure", planning::name_of(two.failure)},
                       {"reason", two.reason}});
    }
    decision["candidates"] = std::move(tried);
    decision["candidates_in_all"] = one.tried.size();
    decision["extent_mm"] = nullptr;
    if (one.planned) {
      if (one.item.is_valid()) planned_[one.item.slot()] = one.planned->X_TP.R;
      decision["planned"] = {{"position_mm", millimetres(one.planned->X_TP.p)},
                             {"insertion", skills::name_of(one.skill)},
                             {"reorientation", skills::name_of(one.reorientation)},
                             {"predicted_success", one.predicted_success},
                             {"samples", one.samples}};
      decision["predicted"] = forces_json(one.predicted);
    }
    decision["happened"] = nullptr;
    decision["end"] = "";
    decision["end_reason"] = "";
    decision["troubles"] = ordered_json::array();
    decision["operator"] = ordered_json::array();
    decisions_.push_back(std::move(decision));
  }
  void take(const session::event::MotionEnded& one) {
    ordered_json* decision = one.item.is_valid() ? last_of(one.item) : nullptr;
    if (decision == nullptr) return;
    ordered_json& happened = happened_of(*decision);
    happened["force_N"] = std::max(happened["force_N"].get<double>(), one.peak_force);
    happened["torque_Nm"] = std::max(happened["torque_Nm"].get<double>(), one.peak_torque);
  }
  void take(const session::event::Assessed& one) {
    ordered_json* decision = last_of(one.item);
    if (decision == nullptr) return;
    ordered_json& happened = happened_of(*decision);
    happened["position_mm"] = millimetres(one.X_TP.p);
    happened["position_error_mm"] = 1e3 * one.position_error;
    happened["angle_error_deg"] = one.angle_error * 180.0 / std::numbers::pi;
    happened["displacement_mm"] = 1e3 * one.displacement;
  }
  void take(const session::event::Remedied& one) {
    ordered_json* decision = last_of(one.item);
    if (decision == nullptr) return;
    (*decision)["troubles"].push_back({{"time", one.time},
                                       {"trouble", session::name_of(one.trouble)},
                                       {"remedy", session::name_of(one.remedy)},
                                       {"detail", one.detail}});
  }
  void take(const session::event::Operated& one) {
    const bool is_hold = one.order.ends_with(" hold");
    if (is_hold && one.was_followed) held_ = id_of(one.item);
    if (one.order.ends_with(" go") || one.order.ends_with(" skip")) held_ = "";
    if (ordered_json* decision = last_of(one.item); decision != nullptr) {
      (*decision)["operator"].push_back(
          {{"time", one.time}, {"order", one.order}, {"was_followed", one.was_followed}, {"text", one.text}});
    }
  }
  void take(const session::event::Sent& /*one*/) { held_ = ""; }
  void take(const session::event::ItemEnded& one) {
    if (ordered_json* decision = last_of(one.item); decision != nullptr) {
      (*decision)["end"] = session::name_of(one.end);
      (*decision)["end_reason"] = one.reason;
    }
  }
  void take(const session::event::ItemLost& one) {
    if (ordered_json* decision = last_of(one.item); decision != nullptr) {
      (*decision)["end"] = session::name_of(one.end);
      (*decision)["end_reason"] = one.reason;
    }
  }
  /// Where boxes are believed to be, in W.
  void take(const session::event::Counted& one) {
    standing_ = ordered_json::array();
    for (const session::event::Standing& box : one.boxes) {
      standing_.push_back({{"item", id_of(box.item)},
                           {"position_mm", millimetres(box.X_WP.p)},
                           {"extent_mm", extent_mm(box.X_WP.R, box.size)}});
      ordered_json* decision = last_of(box.item);
      const auto planned = planned_.find(box.item.slot());
      if (decision != nullptr && planned != planned_.end())
        (*decision)["extent_mm"] = extent_mm(planned->second, box.size);
    }
  }
  static ordered_json& happened_of(ordered_json& decision) {
    ordered_json& happened = decision["happened"];
    if (happened.is_null()) {
      happened = {{"force_N", 0.0},
                  {"torque_Nm", 0.0},
                  {"position_mm", nullptr},
                  {"position_error_mm", nullptr},
                  {"angle_error_deg", nullptr},
                  {"displacement_mm", nullptr}};
    }
    return happened;
  }

  std::vector<std::string> ids_;
  ordered_json items_ = ordered_json::array();
  std::vector<ordered_json> decisions_;
  ordered_json standing_ = ordered_json::array();
  std::map<std::size_t, Matrix3> planned_;  ///< R_TP, by item
  std::string held_, now_;
};

}  // namespace

std::string format_decisions(std::string_view log, const std::string& name) {
  DecisionFold fold;
  int number = 0;
  for (std::size_t end = log.find('\n'); end != std::string_view::npos; end = log.find('\n')) {
    const std::string_view line = log.substr(0, end);
    ++number;
    if (!is_unread(line)) {
      check_utf8(line, name);
      fold.add(session::parse_event(line, name, number));
    }
    log.remove_prefix(end + 1);
  }
  return fold.json().dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace snug::workspace
