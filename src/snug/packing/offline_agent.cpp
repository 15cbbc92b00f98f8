// Agent offline: knows the sequence and plans it in its order; an upper bound for those that do not.
#include <algorithm>
#include <iterator>

#include "snug/packing/internal/agents.hpp"
#include "snug/packing/internal/search.hpp"

namespace snug::packing::internal {

namespace {

class OfflineAgent : public Agent {
 public:
  /// Plans without interference: a box gives way only while it is held, so a whole plan that counts on it jams.
  explicit OfflineAgent(AgentInput input) : input_(std::move(input)) { input_.settings.planned_interference = 0.0; }
  std::string_view name() const override { return name_of(AgentKind::Offline); }

  Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item) override {
    const Planning planning = plan_for_contact(state, input_.settings);
    const Choice choice = make_choice(planning, item);
    if (const auto no = refuse(planning, item, choice)) return tl::unexpected(*no);
    const std::vector<Item> rest = rest_from(planning, item);
    const Layout layout = to_layout(planning, make_rules(planning, rest), state);
    if (!still_holds(planning, layout, rest)) replan(planning, layout, rest);
    return propose(planning, layout, item, choice);
  }

 private:
  /// The sequence from this item on, without later ones that nothing can be done with; the item alone when the sequence
  /// does not have it.
  [[nodiscard]] std::vector<Item> rest_from(const Planning& planning, const Item& item) const {
    const auto at =
        std::find_if(input_.sequence.begin(), input_.sequence.end(), [&](const Item& i) { return i.id == item.id; });
    std::vector<Item> rest{item};
    if (at == input_.sequence.end()) return rest;
    std::copy_if(at + 1, input_.sequence.end(), std::back_inserter(rest),
                 [&](const Item& later) { return !refuse(planning, later, make_choice(planning, later)); });
    return rest;
  }

  /// Whether all that is left of the plan can still be lowered where it was planned, on what stands there now.
  [[nodiscard]] bool still_holds(const Planning& planning, Layout layout, const std::vector<Item>& rest) {
    while (!plan_.empty() && plan_.front().item != rest.front().id) plan_.erase(plan_.begin());
    for (std::size_t i = 0; i < plan_.size(); ++i) {
      if (i >= rest.size() || plan_[i].item != rest[i].id) return false;
      const Choice choice = make_choice(planning, rest[i]);
      if (plan_[i].pose.orientation >= static_cast<int>(choice.piece.orientations.size())) return false;
      const auto candidate = place_item(planning, layout, rest[i], choice, plan_[i].pose, input_.is_reachable);
      if (!candidate) return false;
      CandidatePose pose;
      (void)layout.settle(choice.piece, plan_[i].pose.orientation, plan_[i].pose.x, plan_[i].pose.y, pose);
      layout.add(Layout::block_at(choice.piece, pose));
    }
    return !plan_.empty();
  }

  void replan(const Planning& planning, const Layout& layout, const std::vector<Item>& rest) {
    std::vector<Choice> choices;
    std::vector<Piece> pieces;
    for (const Item& item : rest) {
      Choice choice = make_choice(planning, item);
      pieces.push_back(choice.piece);
      choices.push_back(std::move(choice));
    }
    SearchSettings settings;
    settings.seed = input_.run.seed;
    settings.threads = input_.run.threads;
    settings.effort = work_for(input_.run.time) * static_cast<std::int64_t>(pieces.size());
    settings.accept = [&](const Layout& on, int index, const CandidatePose& pose) {
      const auto i = static_cast<std::size_t>(index);
      return place_item(planning, on, rest[i], choices[i], pose, input_.is_reachable).has_value();
    };
    plan_.clear();
    for (const CandidatePose& pose : plan_in_order(layout, make_policy(planning, rest), pieces, settings)) {
      plan_.push_back({rest[plan_.size()].id, pose});
    }
  }

  /// The planned place first, then by cost.
  [[nodiscard]] Expected<Decision, NoPlace> propose(const Planning& planning, const Layout& layout, const Item& item,
                                                    const Choice& choice) const {
    CandidatePoseList list;
    Refusal worst = Refusal::None;
    layout.find_poses(choice.piece, list, &worst);
    std::vector<CandidatePose>& poses = list.poses;
    std::vector<Item> kinds = input_.future.kinds;
    kinds.push_back(item);
    order_by_cost(layout, make_policy(planning, kinds), choice.piece, poses);
    if (!plan_.empty()) poses.insert(poses.begin(), plan_.front().pose);
    if (poses.empty()) return tl::unexpected(reason_of(worst));
    Decision decision;
    NoPlace reason = NoPlace::NoStablePlace;
    for (const CandidatePose& pose : poses) {
      if (static_cast<int>(decision.candidates.size()) >= input_.settings.max_candidates) break;
      auto candidate = place_item(planning, layout, item, choice, pose, input_.is_reachable);
      if (!candidate) {
        reason = candidate.error();
        continue;
      }
      candidate->score = -static_cast<double>(decision.candidates.size());
      decision.candidates.push_back(*candidate);
    }
    if (decision.candidates.empty()) return tl::unexpected(reason);
    return decision;
  }

  struct Planned {
    std::string item;
    CandidatePose pose;
  };

  AgentInput input_;
  std::vector<Planned> plan_;
};

}  // namespace

std::unique_ptr<Agent> make_offline_agent(AgentInput input) { return std::make_unique<OfflineAgent>(std::move(input)); }

}  // namespace snug::packing::internal
