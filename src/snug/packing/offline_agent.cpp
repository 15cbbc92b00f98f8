// Agent offline: knows the sequence and plans it in its order; an upper bound for those that do not.
#include <algorithm>
#include <iterator>

#include "snug/packing/internal/agents.hpp"
#include "snug/packing/internal/search.hpp"

namespace snug::packing::internal {

namespace {

class OfflineAgent : public Agent {
 public:
  explicit OfflineAgent(AgentInput input) : input_(std::move(input)) {}
  std::string_view name() const override { return "offline"; }

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
      if (plan_[i].spot.stance >= static_cast<int>(choice.piece.stances.size())) return false;
      const auto candidate = place_item(planning, layout, rest[i], choice, plan_[i].spot, input_.is_reachable);
      if (!candidate) return false;
      Spot spot;
      (void)layout.settle(choice.piece, plan_[i].spot.stance, plan_[i].spot.x, plan_[i].spot.y, spot);
      layout.add(Layout::block_at(choice.piece, spot));
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
    settings.seed = input_.settings.seed;
    settings.threads = input_.settings.threads;
    settings.effort = work_for(input_.settings.decision_time) * static_cast<std::int64_t>(pieces.size());
    settings.accept = [&](const Layout& on, int index, const Spot& spot) {
      const auto i = static_cast<std::size_t>(index);
      return place_item(planning, on, rest[i], choices[i], spot, input_.is_reachable).has_value();
    };
    plan_.clear();
    for (const Spot& spot : plan_in_order(layout, make_policy(planning, rest), pieces, settings)) {
      plan_.push_back({rest[plan_.size()].id, spot});
    }
  }

  /// The planned place first, then what the policy likes.
  [[nodiscard]] Expected<Decision, NoPlace> propose(const Planning& planning, const Layout& layout, const Item& item,
                                                    const Choice& choice) const {
    SpotList list;
    Refusal worst = Refusal::None;
    layout.find_spots(choice.piece, list, &worst);
    std::vector<Spot>& spots = list.spots;
    std::vector<Item> kinds = input_.future.kinds;
    kinds.push_back(item);
    order_by_cost(layout, make_policy(planning, kinds), choice.piece, spots);
    if (!plan_.empty()) spots.insert(spots.begin(), plan_.front().spot);
    if (spots.empty()) return tl::unexpected(reason_of(worst));
    Decision decision;
    NoPlace reason = NoPlace::NoStablePlace;
    for (const Spot& spot : spots) {
      if (static_cast<int>(decision.candidates.size()) >= input_.settings.max_candidates) break;
      auto candidate = place_item(planning, layout, item, choice, spot, input_.is_reachable);
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
    Spot spot;
  };

  AgentInput input_;
  std::vector<Planned> plan_;
};

}  // namespace

std::unique_ptr<Agent> make_offline_agent(AgentInput input) { return std::make_unique<OfflineAgent>(std::move(input)); }

}  // namespace snug::packing::internal
