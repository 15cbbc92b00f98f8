// Agent manual: a person's way, report section 5.1.1: goes on as contact-aware does and, when nothing fits any more,
// takes everything out and puts it in anew.
#include <algorithm>
#include <cmath>

#include "snug/packing/internal/agents.hpp"
#include "snug/packing/internal/search.hpp"

namespace snug::packing::internal {

namespace {

/// Orders in which a re-arrangement is tried, each with an equal part of the effort.
constexpr int kOrders = 12;

class ManualAgent : public Agent {
 public:
  explicit ManualAgent(AgentInput input) : input_(input), online_(make_contact_aware_agent(std::move(input))) {}
  std::string_view name() const override { return name_of(AgentKind::Manual); }

  Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item) override {
    Expected<Decision, NoPlace> decision = online_->decide(state, item);
    if (decision || state.boxes.empty() || is_infeasible(decision.error())) return decision;
    const double filled = filling_percent(state) / 100.0 * state.inner_size.prod() + item.size.prod();
    if (filled > state.inner_size.prod()) return decision;
    std::vector<Item> items;
    for (const PlacedBox& box : state.boxes) items.push_back(box.item);
    items.push_back(item);
    for (int order = 0; order < kOrders; ++order) {
      if (auto found = rearrange(state, sorted(items, order), item)) return *found;
    }
    return decision;
  }

 private:
  /// Large ones first, more or less: the volumes are shaken the more the later the order.
  [[nodiscard]] std::vector<Item> sorted(std::vector<Item> items, int order) const {
    Rng rng = Rng(input_.run.seed + static_cast<std::uint64_t>(order)).split("order");
    std::vector<std::pair<double, Item>> keyed;
    for (Item& item : items) {
      // Boxes that stand on others come after those that must stay free only when they have to: those are put last.
      const double last = item.no_stack || item.max_load ? 1.0 : 0.0;
      keyed.emplace_back(last - item.size.prod() * std::exp(0.1 * order * rng.normal()), std::move(item));
    }
    std::stable_sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    items.clear();
    for (auto& [key, item] : keyed) items.push_back(std::move(item));
    return items;
  }

  [[nodiscard]] std::optional<Decision> rearrange(const ContainerState& state, const std::vector<Item>& items,
                                                  const Item& wanted) const {
    const Planning planning = plan_for_contact(state, input_.settings);
    std::vector<Choice> choices;
    std::vector<Piece> pieces;
    for (const Item& item : items) {
      choices.push_back(make_choice(planning, item));
      pieces.push_back(choices.back().piece);
    }
    ContainerState emptied = state;  // obstacles stay
    emptied.boxes.clear();
    const Layout empty = to_layout(planning, make_rules(planning, items), emptied);
    SearchSettings settings;
    settings.seed = input_.run.seed;
    settings.threads = input_.run.threads;
    settings.effort = work_for(input_.run.time) / 4;
    settings.accept = [&](const Layout& on, int index, const CandidatePose& pose) {
      const auto i = static_cast<std::size_t>(index);
      return place_item(planning, on, items[i], choices[i], pose, input_.is_reachable).has_value();
    };
    const std::vector<CandidatePose> poses = plan_in_order(empty, make_policy(planning, items), pieces, settings);
    if (poses.size() < items.size()) return std::nullopt;
    Layout layout = empty;
    std::vector<Placement> placements;
    Candidate candidate;
    for (std::size_t i = 0; i < items.size(); ++i) {
      const auto placed = place_item(planning, layout, items[i], choices[i], poses[i], input_.is_reachable);
      if (!placed) return std::nullopt;
      layout.add(Layout::block_at(pieces[i], poses[i]));
      placements.push_back(placed->placement);
      if (items[i].id == wanted.id) candidate = *placed;
    }
    candidate.rearranged = std::move(placements);
    return Decision{{candidate}, 0};
  }

  AgentInput input_;
  std::unique_ptr<Agent> online_;
};

}  // namespace

std::unique_ptr<Agent> make_manual_agent(AgentInput input) { return std::make_unique<ManualAgent>(std::move(input)); }

}  // namespace snug::packing::internal
