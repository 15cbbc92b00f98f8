// fold: what became of a session, made of its events.
#include "snug/session/fold.hpp"

#include <algorithm>
#include <utility>

namespace snug::session {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// What packing another box anew took is a part of what the item took.
void add(const ItemReport& own, ItemReport& report) {
  report.attempts += own.attempts;
  report.planning_wait += own.planning_wait;
  report.seconds += own.seconds;
  report.recoveries.insert(report.recoveries.end(), own.recoveries.begin(), own.recoveries.end());
}

}  // namespace

ItemReport* ResultFold::report_of(model::ItemIndex item) {
  if (!item.is_valid() || open_.empty() || open_.back().id != ids_[item.slot()]) return nullptr;
  return &open_.back();
}

void ResultFold::leave_out_of_plan(const std::string& id) {
  std::erase_if(result_.plan, [&](const packing::Placement& one) { return one.item == id; });
}

void ResultFold::take(const event::SessionStarted& one) {
  result_ = {};
  result_.sequence = one.sequence;
  result_.agent = one.agent;
  result_.plant = one.plant;
  result_.program.name = "pack";
  result_.program.tracking = one.tracking;
  places_are_chosen_ = one.places_are_chosen;
  for (const model::ParcelId& id : one.items) ids_.push_back(id.value);
}

void ResultFold::take(const event::DecidedBefore& one) {
  decided_before_.push_back(one.seconds);
  if (!one.is_infeasible) return;
  ItemReport& report = result_.items.emplace_back();
  report.id = ids_[one.item.slot()];
  report.end = ItemEnd::Infeasible;
  report.reason = one.reason;
}

void ResultFold::take(const event::ItemStarted& one) {
  ItemReport& report = open_.emplace_back();
  report.id = ids_[one.item.slot()];
  report.begin = one.time;
  if (!one.because_of) report.planning_wait = std::exchange(dropped_wait_, 0.0);
}

void ResultFold::take(const event::ItemLost& one) {
  const auto item = std::ranges::find(result_.items, ids_[one.item.slot()], &ItemReport::id);
  if (item == result_.items.end()) return;
  item->end = one.end;
  item->reason = one.reason;
  leave_out_of_plan(item->id);
}

void ResultFold::take(const event::Planned& one) {
  ItemReport* report = report_of(one.item);
  if (report == nullptr) return;
  report->attempts += one.attempts;
  report->stops += one.stops;
  report->decision_seconds += one.decision_seconds;
  report->rehearsal_seconds += one.rehearsal_seconds;
  report->planning_wait += one.waited;
  report->reason = one.reason;
  for (const planning::Tried& tried : one.tried) {
    if (tried.was_rehearsed() && tried.failure != planning::AttemptFailure::None) {
      report->failed_attempts.push_back(tried);
    }
  }
  if (!one.planned) return;
  report->planned = *one.planned;
  report->reorientation = one.reorientation;
  report->skill = one.skill;
  report->flips = one.flips;
  report->samples = one.samples;
  report->success_rate = one.success_rate;
  report->predicted_success = one.predicted_success;
  report->predicted = one.predicted;
}

void ResultFold::take(const event::Remedied& one) {
  ItemReport* report = report_of(one.item);
  if (report == nullptr) return;
  if (one.is_of_motion && !report->sends.empty() && report->sends.back().trouble == Trouble::None) {
    report->sends.back().trouble = one.trouble;
  }
  report->recoveries.push_back({one.time, report->id, one.trouble, one.remedy, one.detail});
}

void ResultFold::take(const event::Operated& one) {
  if (ItemReport* report = report_of(one.item))
    report->operator_steps.push_back({one.time, one.order, one.was_followed, one.text});
}

void ResultFold::take(const event::MotionStarted& one) {
  auto& all = result_.program.waypoints;
  all.insert(all.end(), one.waypoints.begin(), one.waypoints.end());
}

void ResultFold::take(const event::MotionEnded& one) {
  if (open_.empty()) return;
  ItemReport& report = open_.back();
  report.seconds += one.seconds;
  report.measured.force = std::max(report.measured.force, one.peak_force);
  report.measured.torque = std::max(report.measured.torque, one.peak_torque);
}

void ResultFold::take(const event::Sent& one) {
  ItemReport* report = report_of(one.item);
  if (report == nullptr) return;
  if (one.replaces_last) report->sends.pop_back();
  report->sends.push_back({one.time, one.predicted_success, one.planned, {}, Trouble::None});
}

void ResultFold::take(const event::SendEnded& one) {
  if (ItemReport* report = report_of(one.item)) report->sends.back().end = one.end;
}

void ResultFold::take(const event::Assessed& one) {
  ItemReport* report = report_of(one.item);
  if (report == nullptr) return;
  report->X_TP = one.X_TP;
  report->position_error = one.position_error;
  report->angle_error = one.angle_error;
  report->measured.displacement = std::max(report->measured.displacement, one.displacement);
}

void ResultFold::take(const event::ItemEnded& one) {
  ItemReport report = std::move(open_.back());
  open_.pop_back();
  if (!open_.empty()) return session::add(report, open_.back());
  report.end = one.end;
  report.reason = one.reason;
  report.done = one.time;
  if (report.end == ItemEnd::NoPlace && !places_are_chosen_ && !result_.percent_before_skips) {
    result_.percent_before_skips = result_.planned_percent;
  }
  if (report.is_packed()) result_.plan.push_back(report.planned);
  result_.items.push_back(std::move(report));
  for (const event::Repacked& again : std::exchange(repacked_, {})) {
    const auto item = std::ranges::find(result_.items, ids_[again.item.slot()], &ItemReport::id);
    if (item == result_.items.end() || !item->is_packed()) continue;
    item->planned = again.planned;
    item->X_TP = again.X_TP;
    leave_out_of_plan(item->id);
    result_.plan.push_back(again.planned);
  }
}

void ResultFold::take(const event::SessionEnded& one) {
  result_.duration = one.time;
  result_.failure = {one.failure, one.text};
  if (result_.failure) result_.stopped += "; " + one.text;
  std::vector<double> seconds = decided_before_;
  if (seconds.empty()) {
    for (const ItemReport& item : result_.items) seconds.push_back(item.decision_seconds);
  }
  result_.decision_seconds_median = median(std::move(seconds));
}

void ResultFold::add(const SessionEvent& one) {
  if (const auto* dropped = std::get_if<event::PlanDropped>(&one)) {
    dropped_wait_ += dropped->waited;
  } else if (const auto* again = std::get_if<event::Repacked>(&one)) {
    repacked_.push_back(*again);
    if (!open_.empty() && again->room_for) open_.back().made_room.push_back(again->planned);
  } else if (const auto* counted = std::get_if<event::Counted>(&one)) {
    result_.planned_percent = counted->planned_percent;
    result_.duration = counted->time;
    result_.obstacles = counted->obstacles;
  } else if (const auto* stopped = std::get_if<event::Stopped>(&one)) {
    result_.stop_reason = stopped->reason;
    result_.stopped = stopped->text;
  } else {
    std::visit(
        [&](const auto& event) {
          if constexpr (requires { take(event); }) take(event);  // others are of the path, for people
        },
        one);
  }
}

SessionResult fold(std::span<const SessionEvent> events) {
  ResultFold fold;
  for (const SessionEvent& one : events) fold.add(one);
  return fold.result();
}

}  // namespace snug::session
