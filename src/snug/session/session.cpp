// Session: packs a plant, item after item: look, decide, rehearse, send, look, recover.
#include "snug/session/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "snug/core/input_error.hpp"
#include "snug/core/stopwatch.hpp"
#include "snug/session/packer.hpp"
#include "snug/session/reach.hpp"

namespace snug::session {
namespace {

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::ranges::sort(values);
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : 0.5 * (values[middle - 1] + values[middle]);
}

bool plans_on_paper(const SessionOptions& options) {
  return !options.ask && (options.agent == "manual" || options.agent == "offline");
}

/// Of one item alone, whose place was chosen before.
class ChosenPlace : public packing::Agent {
 public:
  explicit ChosenPlace(const packing::Placement& placement) {
    decision_.candidates.emplace_back().placement = placement;
  }
  [[nodiscard]] std::string_view name() const override { return "chosen place"; }
  [[nodiscard]] Expected<packing::Decision, packing::NoPlace> decide(const packing::ContainerState& /*state*/,
                                                                     const packing::Item& /*item*/) override {
    return decision_;
  }

 private:
  packing::Decision decision_;
};

class Session {
 public:
  Session(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options,
          plant::Plant& plant, const Progress& progress)
      : scenario_(scenario), options_(options), progress_(progress), packer_(scenario, sequence, options, plant) {
    result_.sequence = sequence;
    result_.agent = options.agent;
    result_.plant = plant.describe().name;
  }

  SessionResult pack() {
    packing::AgentInput input;
    input.settings = scenario_.packing;
    input.run = options_.decision;
    input.run.tries_places = !plans_on_paper(options_);  // plans made on paper first have no other place to try
    input.future = options_.future ? *options_.future : packing::make_future_model(scenario_);
    input.sequence = packer_.items();
    input.ask = options_.ask;
    input.is_reachable = make_reach(scenario_, packer_.layout(), packer_.belief().sequence());
    const std::unique_ptr<packing::Agent> agent = packing::make_agent(options_.agent, std::move(input));
    if (plans_on_paper(options_)) return execute(plan_on_paper(*agent));
    const int count = static_cast<int>(packer_.items().size());
    std::vector<ComingItem> coming;
    for (int i = 0; i < count; ++i) coming.push_back({i, agent.get()});
    packer_.expect(std::move(coming));
    for (int i = 0; i < count && !is_over(); ++i) {
      ItemReport report = packer_.bring_in(i, *agent);
      const bool has_no_place = report.end == ItemEnd::NoPlace;
      if (has_no_place && !result_.percent_before_skips) result_.percent_before_skips = result_.planned_percent;
      if (packer_.skips_left() < 0) {
        stop(StopReason::NoPlace, fmt::format("{}: {}", report.id, report.reason));
      }
      finish_item(std::move(report), i + 1, count);
    }
    return finish();
  }

  /// Every box of the plan; one that does not come to its place is left out.
  SessionResult execute(const std::vector<packing::Placement>& plan) {
    std::vector<ChosenPlace> agents(plan.begin(), plan.end());
    std::vector<ComingItem> coming;
    for (std::size_t i = 0; i < plan.size(); ++i) {
      const auto& items = packer_.items();
      const auto item = std::ranges::find(items, plan[i].item, &packing::Item::id);
      if (item == items.end()) {
        throw InputError("plan", "item", plan[i].item, "an item of sequence " + result_.sequence);
      }
      coming.push_back({static_cast<int>(item - items.begin()), &agents[i]});
    }
    packer_.expect(coming);
    int done = 0;
    for (const ComingItem& one : coming) {
      if (is_over()) break;
      finish_item(packer_.bring_in(one.item, *one.agent), ++done, static_cast<int>(plan.size()));
    }
    return finish();
  }

 private:
  void heed_packer() {
    if (!is_stopped_ && packer_.stop_reason()) stop(*packer_.stop_reason(), name_of(*packer_.stop_reason()));
  }

  /// To be asked before every item.
  [[nodiscard]] bool is_over() {
    heed_packer();
    if (!is_stopped_ && options_.is_interrupted && options_.is_interrupted()) {
      stop(StopReason::Interrupted, "interrupted");
    }
    return is_stopped_;
  }

  void stop(StopReason reason, std::string text) {
    is_stopped_ = true;
    result_.stop_reason = reason;
    result_.stopped = std::move(text);
  }

  /// What an agent that re-arranges, or knows the sequence, arrives at before anything is done.
  std::vector<packing::Placement> plan_on_paper(packing::Agent& agent) {
    packing::ContainerState paper = packer_.container_state();
    for (const packing::Item& item : packer_.items()) {
      const auto start = std::chrono::steady_clock::now();
      const auto decision = agent.decide(paper, item);
      paper_seconds_.push_back(seconds_since(start));
      if (!decision && packing::is_hopeless(decision.error())) {
        ItemReport report;
        report.id = item.id;
        report.end = ItemEnd::Hopeless;
        report.reason = packing::describe(decision.error());
        result_.items.push_back(std::move(report));
        continue;
      }
      if (!decision) {
        paper_end_ = fmt::format("{}: {}", item.id, packing::describe(decision.error()));
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

  void finish_item(ItemReport report, int item, int items) {
    if (report.is_packed()) result_.plan.push_back(report.planned);
    result_.items.push_back(std::move(report));
    for (const Repacked& again : packer_.take_repacked()) plan_anew(again);
    review();
    count();
    if (progress_) progress_(result_, item, items);
  }

  void leave_out_of_plan(const std::string& id) {
    std::erase_if(result_.plan, [&](const packing::Placement& one) { return one.item == id; });
  }

  void plan_anew(const Repacked& again) {
    const auto item = std::ranges::find(result_.items, again.planned.item, &ItemReport::id);
    if (item == result_.items.end() || !item->is_packed()) return;
    item->planned = again.planned;
    item->X_TP = again.X_TP;
    leave_out_of_plan(item->id);
    result_.plan.push_back(again.planned);
  }

  /// What was packed before, and is seen outside or nowhere now, is not packed any more.
  void review() {
    for (ItemReport& item : result_.items) {
      if (!item.is_packed()) continue;
      const bool is_gone = packer_.is_gone(item.id);
      if (!is_gone && !packer_.is_seen_outside(item.id)) continue;
      const bool was_returned = packer_.was_returned(item.id);
      item.end = was_returned ? ItemEnd::Returned : is_gone ? ItemEnd::Gone : ItemEnd::Left;
      item.reason = was_returned ? "it was moved, and no other place was found for it"
                    : is_gone    ? "it is not seen any more"
                                 : "it is seen outside the container";
      leave_out_of_plan(item.id);
    }
  }

  void count() {
    std::vector<std::string> packed;
    for (const ItemReport& item : result_.items) {
      if (item.is_packed()) packed.push_back(item.id);
    }
    const model::Container& container = *model::find_container(scenario_, scenario_.target);
    result_.planned_percent = model::compute_filling_degree_percent(scenario_, container, packed);
    result_.duration = packer_.time();
    result_.program = packer_.sent();
    result_.obstacles = packer_.belief().obstacles().reports();
  }

  SessionResult finish() {
    heed_packer();
    if (!is_stopped_ && !paper_end_.empty()) stop(StopReason::NoPlace, paper_end_);
    if (!is_stopped_) {
      const auto left = std::ranges::count_if(result_.items, [](const ItemReport& item) { return !item.is_packed(); });
      if (packer_.items().empty()) {
        stop(StopReason::NoItems, "no items");
      } else if (left == 0) {
        stop(StopReason::AllPacked, "all items are packed");
      } else {
        stop(StopReason::NoMoreItems, fmt::format("no more items, {} not packed", left));
      }
    }
    if (!packer_.sent().waypoints.empty()) result_.failure = packer_.go_home();
    if (result_.failure) result_.stopped += "; " + result_.failure.text;
    count();
    std::vector<double> seconds = std::move(paper_seconds_);
    if (seconds.empty()) {
      for (const ItemReport& item : result_.items) seconds.push_back(item.decision_seconds);
    }
    result_.decision_seconds_median = median(std::move(seconds));
    return std::move(result_);
  }

  const model::Scenario& scenario_;
  SessionOptions options_;
  const Progress& progress_;
  Packer packer_;
  bool is_stopped_ = false;
  std::vector<double> paper_seconds_;  ///< of the decisions of a plan on paper
  std::string paper_end_;
  SessionResult result_;
};

}  // namespace

SessionResult pack(const model::Scenario& scenario, const std::string& sequence, const SessionOptions& options,
                   plant::Plant& plant, const Progress& progress) {
  return Session(scenario, sequence, options, plant, progress).pack();
}

}  // namespace snug::session
