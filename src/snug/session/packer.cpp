// Packer: what is known of an item, where it goes, and which way of bringing it there is sent.
#include "snug/session/packer.hpp"
#include "snug/plant/wait.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <utility>

#include "snug/cell/drawn_scenario.hpp"
#include "snug/cell/joint_pace.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/stopwatch.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/session/reach.hpp"
#include "snug/skills/primitives.hpp"
#include "snug/skills/surroundings.hpp"

namespace snug::session {
namespace {

const model::Scenario& checked(const model::Scenario& scenario, const std::string& sequence) {
  (void)skills::make_layout(scenario, cell::find_pan_axis(scenario));  // says what is missing
  if (model::find_sequence(scenario, sequence) == nullptr) {
    throw InputError(scenario.source_name, "--sequence", "'" + sequence + "'", "a sequence of the scenario");
  }
  return scenario;
}

BeliefSettings settings_of(const SessionOptions& options) {
  BeliefSettings settings;
  settings.samples = options.samples;
  settings.seed = options.decision.seed;
  settings.threads = options.threads;
  settings.simulation = options.simulation;
  return settings;
}

}  // namespace

Packer::Packer(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options,
               plant::Plant& plant)
    : scenario_(checked(scenario, sequence)),
      options_(options),
      limits_(scenario.place_limits),
      plant_(plant),
      layout_(skills::make_layout(scenario, cell::find_pan_axis(scenario))),
      reaches_(make_tool_reach(scenario)),
      belief_(scenario, sequence, settings_of(options)),
      items_(packing::make_items(belief_.nominal(), belief_.sequence())),
      skips_left_(options.skips.value_or(scenario.recovery.skips)),
      robot_(plant.read()) {
  const Matrix3 R_AW = scenario.aligner->X_WA.R.transpose();
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const Pose X_WP = cell::arrival_pose(belief_.nominal(), belief_.sequence().items[i]);
    items_[i].arrival = packing::nearest_orientation(R_AW * X_WP.R);
  }
  sent_.name = "pack";
  const bool is_fast = motion::is_fast(options.simulation.tracking);
  layout_.is_fast = is_fast;
  sent_.tracking = options.simulation.tracking;
  if (!is_fast) limits_.hold_factor = limits_.hold_guard = 0.0;
}

packing::ContainerState Packer::container_state() const {
  packing::ContainerState state = packing::make_container_state(*model::find_container(scenario_, scenario_.target));
  const Pose X_TW = layout_.X_WT.inverse();
  const Vector3 half = 0.5 * state.inner_size + Vector3::Constant(scenario_.recovery.footprint);
  for (const int item : order_) {
    const std::optional<BelievedBox>& box = belief_.box(item);
    if (!box) continue;
    const Pose X_TP = X_TW * box->X_WP;
    if (std::abs(X_TP.p.x()) > half.x() || std::abs(X_TP.p.y()) > half.y() || X_TP.p.z() < 0.0) continue;
    state.boxes.push_back({items_[static_cast<std::size_t>(item)], X_TP});
  }
  state.obstacles = obstacle_extents();
  state.skipped = skipped_;
  state.skips_left = std::max(0, skips_left_);
  return state;
}

std::vector<packing::Extent> Packer::obstacle_extents() const {
  std::vector<packing::Extent> extents;
  for (const geometry::Aabb& region : belief_.obstacles().regions()) {
    const geometry::Aabb in_T = in_container(layout_.X_WT, region);
    extents.push_back({in_T.lower, in_T.upper});
  }
  return extents;
}

bool Packer::is_under_obstacle(int item) const {
  const packing::Extent box = packing::bounding_extent(
      {items_[static_cast<std::size_t>(item)], layout_.X_WT.inverse() * belief_.box(item)->X_WP});
  return std::ranges::any_of(obstacle_extents(), [&](const packing::Extent& one) {
    const Vector3 shared = box.high.cwiseMin(one.high) - box.low.cwiseMax(one.low);
    return shared.head<2>().minCoeff() > scenario_.recovery.under_obstacle && one.high.z() > box.high.z();
  });
}

double Packer::obstacle_top(int item) const {
  const Pose X_TW = layout_.X_WT.inverse();
  double top = 0.0;
  for (const packing::Extent& one : obstacle_extents()) top = std::max(top, one.high.z());
  for (std::size_t i = 0; i < items_.size(); ++i) {
    const std::optional<BelievedBox>& box = belief_.box(static_cast<int>(i));
    if (!box || static_cast<int>(i) == item) continue;
    top = std::max(top, packing::bounding_extent({items_[i], X_TW * box->X_WP}).high.z());
  }
  return top;
}

cell::ContainerFit Packer::fit_of(int item, const Pose& X_WP) const {
  const skills::PlannedBox box = skills::make_planned_box(belief_.nominal(), belief_.sequence(), item);
  const Vector3 inner = model::find_container(scenario_, scenario_.target)->inner_size;
  return cell::fit_in(inner, box.size, layout_.X_WT.inverse() * X_WP);
}

int Packer::index_of(const std::string& id) const {
  return static_cast<int>(std::ranges::find(items_, id, &packing::Item::id) - items_.begin());
}

bool Packer::is_seen_outside(const std::string& id) const {
  const int item = index_of(id);
  const std::optional<BelievedBox>& box = belief_.box(item);
  if (!box || !box->was_seen) return false;
  const double slack = 2.0 * std::sqrt(std::max(0.0, box->covariance(0, 0)));
  const cell::ContainerFit fit = fit_of(item, box->X_WP);
  return locate(item) != Location::Container || fit.outside > cell::kPackedBeyondWall + slack ||
         fit.above_rim > cell::kPackedAboveRim + slack;
}

perception::Observation Packer::take_picture(std::span<const perception::Expectation> expected, bool stays,
                                             ItemReport& report) {
  perception::Observation seen = plant::observe(plant_, expected);
  Situation at;
  while (seen.fault != perception::LookFault::None && !stop_reason_) {
    const bool is_blocked = seen.fault == perception::LookFault::ViewBlocked;
    at.trouble = is_blocked ? Trouble::ViewBlocked : Trouble::BadPicture;
    at.is_held = stays || is_holding();
    ++at.pictures;
    const Remedy remedy = choose_remedy(at, scenario_.recovery);
    report.recoveries.push_back({robot_.time, report.id, at.trouble, remedy, {}});
    if (remedy == Remedy::Stop) stop_reason_ = StopReason::ViewBlocked;
    if (remedy == Remedy::Stop || remedy == Remedy::Believe) break;
    if (remedy == Remedy::MoveAway) move_home(report);
    seen = plant::observe(plant_, expected);
  }
  return seen;
}

double Packer::size_off(int item) const {
  const std::string& id = items_[static_cast<std::size_t>(item)].id;
  return (model::find_parcel(belief_.nominal(), id)->size - model::find_parcel(scenario_, id)->size)
      .cwiseAbs()
      .maxCoeff();
}

bool Packer::is_wrong(int item) const { return belief_.box(item) && size_off(item) > scenario_.recovery.wrong_size; }

void Packer::take_in(const perception::Observation& seen, const ItemReport& report) {
  const std::size_t known = belief_.obstacles().reports().size();
  belief_.see(seen);
  // It is not seen, and something that was not there stands higher over its place: that is the box, or lies on it.
  const int own = index_of(report.id);
  const bool has_news = belief_.obstacles().reports().size() > known;
  if (has_news && belief_.box(own) && !belief_.box(own)->was_seen && is_under_obstacle(own)) belief_.forget(own);
  // It could be anywhere: neither where it was nor where it was to go.
  if (let_go_ >= 0 && belief_.box(let_go_) && !belief_.box(let_go_)->was_seen) belief_.forget(let_go_);
  let_go_ = -1;
  for (std::size_t i = 0; i < items_.size(); ++i) {
    if (belief_.box(static_cast<int>(i))) {
      items_[i].size = model::find_parcel(belief_.nominal(), items_[i].id)->size;
    }
  }
}

void Packer::look(ItemReport& report, bool stays) {
  const std::vector<perception::Expectation> expected = belief_.expectations();
  perception::Observation seen = take_picture(expected, stays, report);
  if (!seen.missing.empty() || belief_.has_new_obstacle(seen)) {  // one picture may be bad
    const perception::Observation before = std::move(seen);
    seen = take_picture(expected, stays, report);
    std::erase_if(seen.missing,
                  [&](const std::string& id) { return std::ranges::find(before.missing, id) == before.missing.end(); });
    belief_.drop_unconfirmed(seen, before);
  }
  take_in(seen, report);
}

Location Packer::locate(int item) const {
  const Pose& X_WP = belief_.box(item)->X_WP;
  const skills::PlannedBox box = skills::make_planned_box(belief_.nominal(), belief_.sequence(), item);
  const Pose X_AW = scenario_.aligner->X_WA.inverse();
  const auto corner_at_plates = [&](const Pose& X_WB) {  // of its extents, whatever face it stands on
    const Pose X_AB = X_AW * X_WB;
    return Vector3(X_AB.p - 0.5 * (X_AB.R.cwiseAbs() * box.size));
  };
  const Pose arrival = cell::arrival_pose(belief_.nominal(), belief_.sequence().items[static_cast<std::size_t>(item)]);
  const double off = (corner_at_plates(X_WP) - corner_at_plates(arrival)).norm();
  if (off < scenario_.recovery.at_aligner && is_upright(X_WP.R, scenario_.skills.pick.max_lean))
    return Location::Aligner;
  const Vector3 p_TP = layout_.X_WT.inverse() * X_WP.p;
  const Vector3 half = 0.5 * model::find_container(scenario_, scenario_.target)->inner_size;
  if (std::abs(p_TP.x()) < half.x() + scenario_.recovery.footprint &&
      std::abs(p_TP.y()) < half.y() + scenario_.recovery.footprint) {
    return Location::Container;
  }
  if (layout_.flip_place) {
    const Vector3 p_FP = X_WP.p - layout_.flip_place->p_WF;
    const double bottom = p_FP.z() + skills::lowest_corner(X_WP.R, box.size);
    if (p_FP.head<2>().norm() < scenario_.recovery.on_bench && std::abs(bottom) < scenario_.recovery.on_surface)
      return Location::Bench;
  }
  return Location::Elsewhere;
}

bool Packer::can_be_picked(int item) const {
  const std::optional<BelievedBox>& box = belief_.box(item);
  if (!box || !is_upright(box->X_WP.R, scenario_.skills.pick.max_lean) || is_under_obstacle(item)) return false;
  if (!reaches_) return true;
  const skills::PlannedBox planned = skills::make_planned_box(belief_.nominal(), belief_.sequence(), item);
  const auto rows = plan_pick(belief_.nominal(), layout_, planned, box->X_WP, box->X_WP,
                              travel_bottom(layout_, obstacle_top(item)), skills::PickKind::FromAfar);
  return std::ranges::all_of(rows, [&](const motion::Waypoint& row) { return reaches_({row.X_WE, row.X_WE}); });
}

/// Percent in the end, on average, when this share of the worlds goes well and the others end here, less what turning
/// the box costs.
double Packer::utility_of(const packing::Candidate& candidate, double rate, double cost) const {
  const double expected = (candidate.expected_percent > 0.0 ? candidate.expected_percent : 100.0) - cost;
  return rate * expected + (1.0 - rate) * packing::filling_percent(container_state());
}

std::optional<GraspOutline> Packer::outline_of(const Standing& box, const packing::Orientation& orientation) const {
  const skills::PlannedBox planned = skills::make_planned_box(belief_.nominal(), belief_.sequence(), box.item);
  const Pose X_WE_over{motion::upright_tool(layout_.neutral_yaw), layout_.X_WT.p};
  const motion::Waypoint from = motion::make_waypoint(motion::MotionClass::PostPlace, {}, X_WE_over);
  return outline_grasp({belief_.nominal(),
                        layout_,
                        {},
                        {},
                        {},
                        from,
                        planned,
                        box.X_WP,
                        box.location,
                        obstacle_top(box.item),
                        options_.threads,
                        reaches_},
                       orientation);
}

double Packer::cost_of(const Standing& box, const packing::Placement& placement) const {
  if (!layout_.is_fast || placement.flips == 0) return 0.0;
  const settings::RehearsalSettings& settings = scenario_.rehearsal;
  const auto outline = outline_of(box, placement.orientation);
  const bool is_by_side = outline && outline->reorientation == skills::Reorientation::SideGrasp;
  return is_by_side ? settings.side_grasp_cost : settings.reorientation_cost;
}

void Packer::sort(const Standing& box, std::vector<packing::Candidate>& candidates) const {
  if (!layout_.is_fast) return;  // they are in the agent's order
  std::vector<std::pair<double, packing::Candidate>> ordered;
  for (packing::Candidate& one : candidates) {
    const double utility = utility_of(one, 1.0, cost_of(box, one.placement));
    ordered.emplace_back(utility, std::move(one));
  }
  std::ranges::stable_sort(ordered, std::greater(), [](const auto& one) { return one.first; });
  std::ranges::transform(ordered, candidates.begin(), [](auto& one) { return std::move(one.second); });
}

bool Packer::is_enough(const std::optional<Attempt>& best, int attempts) const {
  const settings::RehearsalSettings& settings = scenario_.rehearsal;
  const double rate = best ? best->success_rate : -1.0;
  return rate >= settings.accepted_rate || attempts >= settings.most_attempts ||
         (attempts >= settings.max_attempts && rate >= settings.good_rate);
}

std::optional<Attempt> Packer::best_attempt(const RehearsalTask& task, double least_percent,
                                            const std::vector<packing::Candidate>& candidates, ItemReport& report) {
  const int item = task.item;
  const packing::ContainerState state = state_without(item);
  const double top = obstacle_top(item);
  Rehearsal rehearsal(belief_, layout_, reaches_, limits_, options_.threads, task);
  std::optional<Attempt> best;
  double best_utility = least_percent;
  const double clearance = belief_.nominal().parcel_clearance;
  const int before = report.attempts;  // when it was planned before
  for (const packing::Candidate& candidate : candidates) {
    const double cost = cost_of({item, task.X_WP, task.location}, candidate.placement);
    if (best_utility >= utility_of(candidate, 1.0, cost)) break;
    const packing::Candidate placed = skills::measured(state, candidate, items_[static_cast<std::size_t>(item)].size,
                                                       clearance, scenario_.skills.insertion);
    for (const skills::Insertion& insertion :
         skills::choose_insertions(placed, rehearsal.box().size, scenario_.skills.insertion)) {
      if (is_enough(best, report.attempts - before)) break;
      Attempt attempt = rehearsal.attempt(placed, insertion, top);
      report.attempts += attempt.was_rehearsed ? 1 : 0;
      report.stops += attempt.was_rehearsed && attempt.was_stopped ? 1 : 0;
      if (!attempt.was_rehearsed) break;
      if (report.reason.empty()) report.reason = attempt.text;
      if (attempt.failure != AttemptFailure::None) {
        report.failed_attempts.push_back(
            {attempt.planned, attempt.skill, attempt.failure, attempt.succeeded, attempt.success_rate, attempt.text});
      }
      if (!attempt.succeeded) continue;
      const double utility = utility_of(placed, attempt.success_rate, cost);
      if (utility <= best_utility + 1e-9) continue;
      best_utility = utility;
      best = std::move(attempt);
    }
    if (is_enough(best, report.attempts - before)) break;
  }
  if (best && best->success_rate < scenario_.rehearsal.least_rate) best.reset();
  return best;
}

packing::ContainerState Packer::state_without(int item) const {
  packing::ContainerState state = container_state();
  const std::string& id = items_[static_cast<std::size_t>(item)].id;
  std::erase_if(state.boxes, [&](const packing::PlacedBox& box) { return box.item.id == id; });
  return state;
}

packing::Item Packer::item_as_it_stands(int item) const {
  packing::Item one = items_[static_cast<std::size_t>(item)];
  const Matrix3& R = locate(item) == Location::Aligner ? scenario_.aligner->X_WA.R : layout_.X_WT.R;
  one.arrival = packing::nearest_orientation(R.transpose() * belief_.box(item)->X_WP.R);
  return one;
}

std::optional<double> Packer::expected_percent(int item, packing::Agent& agent) const {
  if (locate(item) != Location::Container || !fit_of(item, belief_.box(item)->X_WP).is_in) return std::nullopt;
  return agent.expected_percent(container_state());
}

double Packer::gain_elsewhere(int item, packing::Agent& agent) const {
  const std::optional<double> here = expected_percent(item, agent);
  if (!here) return 0.0;
  const auto decision = agent.decide(state_without(item), item_as_it_stands(item));
  return decision ? decision->candidates.front().expected_percent - *here : 0.0;
}

Packer::PlanResult Packer::plan(int item, packing::Agent& agent, const plant::Feedback& robot, ItemReport& report) {
  packing::Item& one = items_[static_cast<std::size_t>(item)];
  one = item_as_it_stands(item);
  const packing::ContainerState state = state_without(item);
  auto start = std::chrono::steady_clock::now();
  const std::optional<double> here = expected_percent(item, agent);
  const double least = here ? *here + scenario_.recovery.gain_elsewhere : 0.0;
  const auto decision = agent.decide(state, one);
  if (!decision) {
    report.decision_seconds += seconds_since(start);
    report.reason = packing::describe(decision.error());
    report.end = packing::is_hopeless(decision.error()) ? ItemEnd::Hopeless : ItemEnd::NoPlace;
    return std::nullopt;
  }
  RehearsalTask task{item, belief_.box(item)->X_WP, locate(item), robot, {}};
  std::vector<packing::Candidate> candidates = decision->candidates;
  const Standing standing{item, task.X_WP, task.location};
  sort(standing, candidates);
  task.X_WE_after = tool_after(item, packing::with_candidate(state, one, candidates.front()));
  report.decision_seconds += seconds_since(start);
  start = std::chrono::steady_clock::now();
  report.reason.clear();
  std::optional<Attempt> best = best_attempt(task, least, candidates, report);
  report.rehearsal_seconds += seconds_since(start);
  if (!best && !decision->is_pressed) {
    start = std::chrono::steady_clock::now();
    auto pressed = agent.decide_pressed(state, one);
    report.decision_seconds += seconds_since(start);
    start = std::chrono::steady_clock::now();
    if (pressed) {
      sort(standing, pressed->candidates);
      best = best_attempt(task, least, pressed->candidates, report);
    }
    report.rehearsal_seconds += seconds_since(start);
  }
  if (!best) {
    report.end = ItemEnd::NoPlace;
    if (report.reason.empty()) report.reason = "no place where it would come to rest as planned";
    return std::nullopt;
  }
  report.reason.clear();
  report.planned = best->planned;
  report.reorientation = best->reorientation;
  report.skill = best->skill;
  report.flips = packing::count_flips(one.arrival, best->planned.orientation);
  report.samples = best->samples;
  report.success_rate = best->success_rate;
  report.predicted_success =
      (best->success_rate * best->samples + scenario_.rehearsal.prior_rate * scenario_.rehearsal.prior_count) /
      (best->samples + scenario_.rehearsal.prior_count);
  report.predicted = best->predicted;
  return Planned{std::move(*best), skills::make_planned_box(belief_.nominal(), belief_.sequence(), item)};
}

}  // namespace snug::session
