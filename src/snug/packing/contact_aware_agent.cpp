// Agent contact-aware: no look-ahead, no clearance, flips; candidates race each other in roll-outs over possible
// futures.
#include <algorithm>
#include <string_view>
#include <unordered_set>

#include "snug/core/hash.hpp"
#include "snug/packing/internal/agents.hpp"

namespace snug::packing::internal {

namespace {

/// Places looked at in one second on one core of the reference machine (2.5 GHz), with everything that a roll-out does
/// around them: turns a decision time into work, so that a decision does not depend on the clock.
constexpr double kPlacesPerSecond = 6.0e6;
constexpr int kEntrants = 64;
/// Futures that a container met as it is: 0.3 % of it, standard error.
constexpr int kFutures = 256;

std::vector<Piece> pieces_of(const Planning& planning, const FutureModel& future) {
  std::vector<Piece> pieces;
  for (const Item& kind : future.kinds) pieces.push_back(make_choice(planning, kind).piece);
  return pieces;
}

/// `item`: decided on now, so that it does not come again; may be empty.
Prospect make_prospect(const FutureModel& future, std::vector<Piece> pieces, const ContainerState& state,
                       std::string_view item) {
  Prospect prospect;
  prospect.kinds = std::move(pieces);
  prospect.weights = future.weights;
  prospect.comes_once = future.comes_once;
  if (!future.comes_once) return prospect;
  std::unordered_set<std::string_view> seen{item};
  seen.insert(state.skipped.begin(), state.skipped.end());
  for (const PlacedBox& box : state.boxes) seen.insert(box.item.id);
  for (std::size_t i = 0; i < future.kinds.size(); ++i) {
    if (seen.contains(future.kinds[i].id)) prospect.weights[i] = 0.0;
  }
  return prospect;
}

double largest_volume(const Prospect& prospect) {
  double largest = 0.0;
  for (const Piece& kind : prospect.kinds) largest = std::max(largest, kind.volume);
  return largest;
}

class ContactAwareAgent : public Agent {
 public:
  explicit ContactAwareAgent(AgentInput input) : input_(std::move(input)) {}
  std::string_view name() const override { return name_of(AgentKind::ContactAware); }

  Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item) override {
    Expected<Decision, NoPlace> decision = decide(state, item, plan_for_contact(state, input_.settings));
    const bool is_full =
        !decision && (decision.error() == NoPlace::NoSpace || decision.error() == NoPlace::NoStablePlace);
    if (!is_full) return decision;
    Expected<Decision, NoPlace> pressed = decide_pressed(state, item);
    return pressed ? pressed : decision;
  }

  Expected<Decision, NoPlace> decide_pressed(const ContainerState& state, const Item& item) override {
    if (!input_.run.tries_places) return tl::unexpected(NoPlace::NoSpace);
    PackingSettings settings = input_.settings;
    settings.planned_interference = settings.last_interference;
    const Planning planning = plan_for_contact(state, settings);
    if (planning.planned_interference <= plan_for_contact(state, input_.settings).planned_interference) {
      return tl::unexpected(NoPlace::NoSpace);
    }
    Expected<Decision, NoPlace> decision = decide(state, item, planning);
    if (decision) decision->is_pressed = true;
    return decision;
  }

  std::optional<double> expected_percent(const ContainerState& state) override {
    const Planning planning = plan_for_contact(state, input_.settings);
    const std::vector<Item>& kinds = input_.future.kinds;
    Outlook outlook = look_ahead(planning, state, nullptr);
    outlook.race.first_futures = kFutures;
    const std::vector<Layout> entrants{to_layout(planning, make_rules(planning, kinds), state)};
    return outlook.percent(
        race(entrants, make_policy(planning, kinds), outlook.prospect, outlook.free_volume, outlook.race, nullptr)
            .front());
  }

 private:
  /// What may come into a container.
  struct Outlook {
    double room = 0.0;         ///< m^3, of the empty container
    double filled = 0.0;       ///< m^3
    double free_volume = 0.0;  ///< m^3, of items that are drawn
    Prospect prospect;
    RaceSettings race;
    [[nodiscard]] double percent(const Standing& standing) const { return 100.0 * (filled + standing.mean) / room; }
  };

  /// `item`: decided on now, if there is one.
  Outlook look_ahead(const Planning& planning, const ContainerState& state, const Item* item) {
    Outlook outlook;
    outlook.room = planning.inner_size.prod();
    outlook.filled = 0.01 * filling_percent(state) * outlook.room + (item != nullptr ? item->size.prod() : 0.0);
    outlook.race.seed = input_.run.seed + 1000003U * state.boxes.size();
    outlook.race.threads = input_.run.threads;
    outlook.race.effort = work_for(input_.run.time);
    outlook.race.skips = state.skips_left;
    outlook.prospect = make_prospect(input_.future, pieces(planning), state,
                                     item != nullptr ? std::string_view(item->id) : std::string_view());
    outlook.free_volume = std::max(0.0, outlook.room - outlook.filled);
    for (int i = 0; i < outlook.race.skips; ++i) outlook.free_volume += largest_volume(outlook.prospect);
    return outlook;
  }

  Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item, const Planning& planning) {
    const Choice choice = make_choice(planning, item);
    if (const auto no = refuse(planning, item, choice)) return tl::unexpected(*no);
    std::vector<Item> kinds = input_.future.kinds;
    kinds.push_back(item);
    const Layout layout = to_layout(planning, make_rules(planning, kinds), state);
    CandidatePoseList list;
    Refusal worst = Refusal::None;
    layout.find_poses(choice.piece, list, &worst);
    std::vector<CandidatePose>& poses = list.poses;
    if (poses.empty()) return tl::unexpected(reason_of(worst));
    const Policy policy = make_policy(planning, kinds);
    order_by_cost(layout, policy, choice.piece, poses);
    return rank(planning, state, item, choice, layout, policy, poses);
  }

  Expected<Decision, NoPlace> rank(const Planning& planning, const ContainerState& state, const Item& item,
                                   const Choice& choice, const Layout& layout, const Policy& policy,
                                   const std::vector<CandidatePose>& poses) {
    std::vector<Candidate> candidates;
    std::vector<Layout> entrants;
    NoPlace reason = NoPlace::NoStablePlace;
    for (const CandidatePose& pose : poses) {
      if (entrants.size() >= kEntrants) break;
      auto candidate = place_item(planning, layout, item, choice, pose, input_.is_reachable);
      if (!candidate) {
        reason = candidate.error();
        continue;
      }
      candidates.push_back(*candidate);
      entrants.push_back(layout);
      entrants.back().add(Layout::block_at(choice.piece, pose));
    }
    if (candidates.empty()) return tl::unexpected(reason);
    return settle_race(planning, state, item, policy, candidates, entrants);
  }

  Decision settle_race(const Planning& planning, const ContainerState& state, const Item& item, const Policy& policy,
                       const std::vector<Candidate>& candidates, const std::vector<Layout>& entrants) {
    Decision decision;
    const Outlook outlook = look_ahead(planning, state, &item);
    const std::vector<Standing> order =
        race(entrants, policy, outlook.prospect, outlook.free_volume, outlook.race, &decision.roll_outs);
    for (const Standing& standing : order) {
      if (static_cast<int>(decision.candidates.size()) >= input_.settings.max_candidates) break;
      Candidate candidate = candidates[static_cast<std::size_t>(standing.entrant)];
      candidate.expected_percent = outlook.percent(standing);
      candidate.score = candidate.expected_percent;
      decision.candidates.push_back(candidate);
    }
    return decision;
  }

  /// Of the future's kinds: made once, as orders may bring thousands of them.
  const std::vector<Piece>& pieces(const Planning& planning) {
    if (pieces_.empty() || interference_ != planning.planned_interference) pieces_ = pieces_of(planning, input_.future);
    interference_ = planning.planned_interference;
    return pieces_;
  }

  AgentInput input_;
  std::vector<Piece> pieces_;
  double interference_ = 0.0;  ///< with which they were made
};

}  // namespace

Planning plan_for_contact(const ContainerState& state, const PackingSettings& settings) {
  // What is planned to press between walls would stick out beyond the edge of a pallet.
  return {state.inner_size, settings, settings.max_flips, 0.0, state.has_walls ? settings.planned_interference : 0.0};
}

std::int64_t work_for(double seconds) { return static_cast<std::int64_t>(seconds * kPlacesPerSecond); }

void order_by_cost(const Layout& layout, const Policy& policy, const Piece& piece, std::vector<CandidatePose>& poses) {
  std::vector<std::pair<double, CandidatePose>> ordered;
  for (const CandidatePose& pose : poses) ordered.emplace_back(cost(layout, policy, piece, pose), pose);
  std::stable_sort(ordered.begin(), ordered.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::size_t i = 0; i < poses.size(); ++i) poses[i] = ordered[i].second;
}

NoPlace reason_of(Refusal worst) {
  if (worst == Refusal::Load) return NoPlace::OverLoad;
  return worst == Refusal::Support || worst == Refusal::Balance ? NoPlace::NoStablePlace : NoPlace::NoSpace;
}

Policy make_policy(const Planning& planning, std::span<const Item> kinds) {
  std::vector<int> along, up;
  for (const Item& kind : kinds) {
    for (int axis = 0; axis < 3; ++axis) {
      along.push_back(to_ticks(kind.size[axis] - planning.planned_interference));
      up.push_back(to_ticks(kind.size[axis]));
    }
  }
  const int longest = to_ticks(planning.inner_size.head<2>().maxCoeff());
  return {default_weights(), WasteTable(along, longest), WasteTable(up, to_ticks(planning.inner_size.z()))};
}

std::unique_ptr<Agent> make_contact_aware_agent(AgentInput input) {
  return std::make_unique<ContactAwareAgent>(std::move(input));
}

}  // namespace snug::packing::internal
