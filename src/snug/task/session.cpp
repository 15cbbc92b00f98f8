// PackingSession: item after item, decide, try in what could be, do it, look, go on.
#include "snug/task/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/task/executor.hpp"
#include "snug/task/reach.hpp"
#include "snug/task/surroundings.hpp"

namespace snug::task {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

/// The items of the sequence as they stand at the aligner, seen from the container.
std::vector<packing::Item> items_of(const model::Scenario& scenario, const model::Sequence& sequence) {
  std::vector<packing::Item> items = packing::make_items(scenario, sequence);
  for (std::size_t i = 0; i < items.size(); ++i) {
    const Matrix3 R_AP = scenario.aligner->X_WA.R.transpose() * arrival_pose(scenario, sequence.items[i]).R;
    items[i].arrival = packing::nearest_orientation(R_AP);
  }
  return items;
}

class PackingSession {
 public:
  PackingSession(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options)
      : scenario_(scenario),
        options_(options),
        container_(*model::find_container(scenario, scenario.target)),
        executor_(scenario, sequence, options),
        items_(items_of(scenario, executor_.real().simulation().sequence())),
        state_(packing::make_container_state(container_)),
        noise_(Rng(options.packing.seed).split("perception")) {
    result_.sequence = sequence;
    result_.agent = options.agent;
  }

  SessionResult pack(const Progress& progress) {
    packing::AgentInput input;
    input.settings = options_.packing;
    // Plans that are made on paper first have no other place to try.
    if (!plans_on_paper()) input.settings.last_squeeze = options_.last_squeeze;
    input.future = options_.future ? *options_.future : packing::make_future_model(scenario_);
    input.sequence = items_;
    input.ask = options_.ask;
    input.is_reachable = make_reach(scenario_, executor_.layout(), executor_.real().simulation().sequence());
    const std::unique_ptr<packing::Agent> agent = packing::make_agent(options_.agent, std::move(input));
    if (plans_on_paper()) return execute(plan_on_paper(*agent), progress);
    for (std::size_t i = 0; i < items_.size() && result_.stopped.empty(); ++i) {
      ItemReport report;
      report.id = items_[i].id;
      const auto start = std::chrono::steady_clock::now();
      const auto decision = agent->decide(state_, items_[i]);
      report.decision_seconds = seconds_since(start);
      if (decision) {
        place(static_cast<int>(i), decision->candidates, report);
      } else {
        report.reason = packing::describe(decision.error());
        if (!packing::is_hopeless(decision.error())) result_.stopped = fmt::format("{}: {}", report.id, report.reason);
      }
      finish_item(std::move(report));
      if (progress) progress(result_, static_cast<int>(i) + 1, static_cast<int>(items_.size()));
    }
    return finish();
  }

  /// What an agent that re-arranges, or knows the sequence, arrives at before anything is done.
  std::vector<packing::Placement> plan_on_paper(packing::Agent& agent) {
    packing::ContainerState paper = packing::make_container_state(container_);
    for (const packing::Item& item : items_) {
      const auto start = std::chrono::steady_clock::now();
      const auto decision = agent.decide(paper, item);
      paper_seconds_.push_back(seconds_since(start));
      if (!decision && decision.error() == packing::NoPlace::NotPlanned) continue;
      if (!decision && packing::is_hopeless(decision.error())) {
        ItemReport report;
        report.id = item.id;
        report.reason = packing::describe(decision.error());
        result_.items.push_back(std::move(report));
        continue;
      }
      if (!decision) {
        ending_ = fmt::format("{}: {}", item.id, packing::describe(decision.error()));
        break;
      }
      paper = packing::with_candidate(std::move(paper), item, decision->candidates.front());
    }
    std::vector<packing::Placement> plan;
    for (const packing::PlacedBox& box : paper.boxes) {
      const packing::Orientation orientation = packing::nearest_orientation(box.X_TP.R);
      plan.push_back({box.item.id, box.X_TP, orientation, packing::count_flips(box.item.arrival, orientation)});
    }
    return plan;
  }

  /// Every box of the plan; one that does not come to its place is left out.
  SessionResult execute(const std::vector<packing::Placement>& plan, const Progress& progress) {
    int done = 0;
    result_.plan = plan;
    is_planned_ = true;
    for (const packing::Placement& placement : plan) {
      const auto item = std::ranges::find(items_, placement.item, &packing::Item::id);
      if (item == items_.end()) {
        throw InputError("plan", "item", placement.item, "an item of sequence " + result_.sequence);
      }
      ItemReport report;
      report.id = placement.item;
      packing::Candidate candidate;
      candidate.placement = placement;
      place(static_cast<int>(item - items_.begin()), {candidate}, report);
      finish_item(std::move(report));
      result_.stopped.clear();
      if (progress) progress(result_, ++done, static_cast<int>(plan.size()));
    }
    result_.stopped = ending_;
    return finish();
  }

 private:
  [[nodiscard]] bool plans_on_paper() const {
    return !options_.ask && (options_.agent == "manual" || options_.agent == "offline");
  }

  /// Percent in the end, on average, when this share of the courses of events goes well and the others end here.
  [[nodiscard]] double worth_of(const packing::Candidate& candidate, double share) const {
    const double expected = candidate.expected_percent > 0.0 ? candidate.expected_percent : 100.0;
    return share * expected + (1.0 - share) * packing::filling_percent(state_);
  }

  [[nodiscard]] bool is_enough(const std::optional<Attempt>& best, int attempts) const {
    const double share = best ? best->share : -1.0;
    return share >= options_.accepted_share || attempts >= options_.most_attempts ||
           (attempts >= options_.max_attempts && share >= options_.good_share);
  }

  void place(int index, const std::vector<packing::Candidate>& candidates, ItemReport& report) {
    const auto start = std::chrono::steady_clock::now();
    const packing::Item& item = items_[static_cast<std::size_t>(index)];
    const double top = highest_top(state_);
    std::optional<Attempt> best;
    double best_worth = 0.0;
    executor_.begin(index);
    for (const packing::Candidate& candidate : candidates) {
      if (best && best_worth >= worth_of(candidate, 1.0)) break;
      const packing::Candidate placed = measured(state_, candidate, item.size, scenario_.parcel_clearance);
      const Vector3 collision = item.size - Vector3::Constant(scenario_.parcel_clearance);
      for (const PlaceVariant& variant : choose_variants(placed, collision)) {
        if (is_enough(best, report.attempts)) break;
        Attempt attempt = executor_.attempt(placed, variant, top);
        report.attempts += attempt.was_simulated ? 1 : 0;
        report.stops += attempt.was_simulated && attempt.was_stopped ? 1 : 0;
        if (!attempt.was_simulated) break;
        if (report.reason.empty()) report.reason = attempt.reason;
        if (!attempt.succeeded) continue;
        const double worth = worth_of(placed, attempt.share);
        if (best && worth <= best_worth + 1e-9) continue;
        best_worth = worth;
        best = std::move(attempt);
      }
      if (is_enough(best, report.attempts)) break;
    }
    report.prediction_seconds = seconds_since(start);
    if (!best || best->share < options_.least_share) {
      if (report.reason.empty()) report.reason = "no place where it would come to rest as planned";
      result_.stopped = fmt::format("{}: {}", report.id, report.reason);
      return;
    }
    report.is_placed = true;
    report.reason.clear();
    report.planned = best->planned;
    report.turn = best->turn;
    report.manner = best->manner;
    report.flips = packing::count_flips(item.arrival, best->planned.orientation);
    report.samples = options_.samples;
    report.share = best->share;
    report.predicted = best->predicted;
    report.happened = best->happened;
    report.position_error = best->position_error;
    report.angle_error = best->angle_error;
    if (!is_planned_) result_.plan.push_back(best->planned);
    state_.boxes.push_back({item, best->planned.X_TP});
    executor_.take(std::move(*best));
  }

  void finish_item(ItemReport report) {
    result_.items.push_back(std::move(report));
    look();
    count();
  }

  /// What is believed of the container's boxes from now on.
  void look() {
    if (options_.perception == Perception::DeadReckoning) return;
    const Pose X_TW = executor_.layout().X_WT.inverse();
    for (packing::PlacedBox& box : state_.boxes) {
      const std::optional<Pose> X_WP = executor_.real().pose_of(index_of(box.item.id));
      if (!X_WP) continue;
      box.X_TP = X_TW * *X_WP;
      if (options_.perception != Perception::Noisy) continue;
      const double width = options_.perception_noise;
      const auto draw = [&] { return noise_.uniform(-width, width); };
      const double x = draw(), y = draw(), z = draw();
      const double rx = draw() / 0.1, ry = draw() / 0.1, rz = draw() / 0.1;
      box.X_TP.p += Vector3(x, y, z);
      box.X_TP.R = exp_rotation(Vector3(rx, ry, rz)) * box.X_TP.R;
    }
  }

  [[nodiscard]] int index_of(const std::string& id) const {
    return static_cast<int>(std::ranges::find(items_, id, &packing::Item::id) - items_.begin());
  }

  [[nodiscard]] double percent(const std::vector<std::string>& ids) const {
    return model::compute_filling_degree_percent(scenario_, container_, ids);
  }

  void count() {
    std::vector<std::string> planned, packed;
    for (const packing::Placement& placement : result_.plan) planned.push_back(placement.item);
    result_.boxes = executor_.real().simulation().boxes(executor_.real().state());
    for (const cell::BoxResult& box : result_.boxes) {
      if (box.state == cell::BoxState::Packed) packed.push_back(box.id);
    }
    result_.planned_boxes = static_cast<int>(planned.size());
    result_.executed_boxes = static_cast<int>(packed.size());
    result_.planned_percent = percent(planned);
    result_.executed_percent = percent(packed);
  }

  SessionResult finish() {
    if (result_.stopped.empty()) result_.stopped = items_.empty() ? "no items" : no_more_items();
    const Episode last = executor_.finish();
    if (!last.failure.empty()) result_.failure = "on the way home: " + last.failure;
    if (!last.failure.empty()) result_.stopped += "; " + result_.failure;
    if (last.failure.empty() && !last.arm_contact.empty()) result_.stopped += "; on the way home " + last.arm_contact;
    count();
    result_.duration = last.duration;
    if (!executor_.program().waypoints.empty()) {
      result_.state_hash = executor_.real().simulation().hash(executor_.real().state());
    }
    std::vector<double> seconds = std::move(paper_seconds_);
    if (!is_planned_)
      for (const ItemReport& item : result_.items) seconds.push_back(item.decision_seconds);
    result_.decision_seconds_median = median(std::move(seconds));
    result_.program = executor_.program();
    return std::move(result_);
  }

  [[nodiscard]] std::string no_more_items() const {
    const auto left = std::ranges::count(result_.items, false, &ItemReport::is_placed);
    return left == 0 ? "all items are packed" : fmt::format("no more items, {} not packed", left);
  }

  const model::Scenario& scenario_;
  SessionOptions options_;
  const model::Container& container_;
  Executor executor_;
  std::vector<packing::Item> items_;
  packing::ContainerState state_;
  Rng noise_;
  bool is_planned_ = false;            ///< the plan was made before
  std::vector<double> paper_seconds_;  ///< of its decisions
  std::string ending_;                 ///< why it ended
  SessionResult result_;
};

}  // namespace

SessionResult pack(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options,
                   const Progress& progress) {
  (void)make_layout(scenario);  // says what is missing
  return PackingSession(scenario, sequence, options).pack(progress);
}

SessionResult execute(const model::Scenario& scenario, const std::string& sequence,
                      const std::vector<packing::Placement>& plan, const SessionOptions& options,
                      const Progress& progress) {
  (void)make_layout(scenario);
  return PackingSession(scenario, sequence, options).execute(plan, progress);
}

}  // namespace snug::task
