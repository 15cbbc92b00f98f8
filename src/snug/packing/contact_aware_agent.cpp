// Agent contact-aware: no look-ahead, no clearance, flips; candidates race each other in roll-outs over possible
// futures.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string_view>
#include <unordered_set>

#include "snug/core/hash.hpp"
#include "snug/packing/internal/agents.hpp"

namespace snug::packing::internal {

namespace {

/// Places looked at in one second on one core of the reference machine (2.5 GHz), with everything that a roll-out does
/// around them: turns a decision time into work, so that a decision does not depend on the clock.
constexpr double kPlacesPerSecond = 6.0e6;
constexpr std::size_t kEntrants = 64;
constexpr std::size_t kFewest = 4;  ///< that race where there is time for few roll-outs
/// Of 64 entrants, of fewer in proportion: for which the box is not turned, and the best by the policy that was not
/// chosen.
constexpr std::size_t kUnturned = 12, kOther = 8;
/// Futures that a container met as it is: 0.4 % of it, standard error.
constexpr int kFutures = 128;

/// Places of one kind: the same axis of the box is up, and it stands pressed in between or not.
int kind_of(const Candidate& candidate) {
  return 2 * static_cast<int>(candidate.placement.orientation.up) + (stands_free(candidate) ? 0 : 1);
}

/// The first `most` of them, except that each kind of place keeps its first few: where none of the best can be had, a
/// place of another kind often can.
std::vector<Candidate> cut(std::vector<Candidate> ranked, std::size_t most) {
  if (ranked.size() <= most) return ranked;
  std::array<std::size_t, 6> kept{};
  std::vector<bool> stays(ranked.size(), false);
  std::size_t staying = 0;
  const std::size_t each = most / 8;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    std::size_t& of_kind = kept[static_cast<std::size_t>(kind_of(ranked[i]))];
    if (of_kind >= each) continue;
    ++of_kind;
    ++staying;
    stays[i] = true;
  }
  for (std::size_t i = 0; i < ranked.size() && staying < most; ++i) {
    if (stays[i]) continue;
    stays[i] = true;
    ++staying;
  }
  std::vector<Candidate> left;
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    if (stays[i]) left.push_back(std::move(ranked[i]));
  }
  return left;
}

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

/// A twentieth of the container's shortest side: of which the sides of boxes of a grid are multiples.
int least_unit(const Planning& planning) { return (to_ticks(planning.inner_size.minCoeff()) + 19) / 20; }

/// All sides are multiples of one length, and it is a twentieth of the container's shortest side or more.
bool are_of_a_grid(const Planning& planning, std::span<const Item> kinds) {
  int unit = 0;
  for (const Item& kind : kinds) {
    for (int axis = 0; axis < 3; ++axis) unit = std::gcd(unit, to_ticks(kind.size[axis]));
  }
  return unit >= least_unit(planning);
}

constexpr double kCentimetre = 0.01;  ///< by which sizes are compared, since one of the boxes has been measured

bool have_one_size(std::span<const Item> kinds) {
  return std::ranges::all_of(kinds, [&kinds](const Item& kind) {
    return (kind.size - kinds.front().size).lpNorm<Eigen::Infinity>() < kCentimetre;
  });
}

/// Boxes of one size and modular cartons, whose lengths and widths are of a grid: their rows leave few gaps, and need
/// the places at the rim for as many rows as can be.
bool stand_in_rows(const Planning& planning, std::span<const Item> kinds) {
  int unit = 0;
  for (const Item& kind : kinds) {
    for (int axis = 0; axis < 2; ++axis) {
      unit = std::gcd(unit, to_ticks(kCentimetre * std::round(kind.size[axis] / kCentimetre)));
    }
  }
  return have_one_size(kinds) || unit >= least_unit(planning);
}

/// Those that go on in roll-outs: the one of which more gets in decides. The tuned one knows edges that add up; maximal
/// contact knows nothing and is as good where boxes are unlike those that it was tuned on. Boxes of a grid have a
/// policy that was tuned on such boxes.
std::vector<Policy> policies_for(const Planning& planning, std::span<const Item> kinds) {
  std::vector<Policy> policies(2, make_policy(planning, kinds));
  Weights& weights = policies.back().weights;
  if (planning.has_walls) {
    weights = are_of_a_grid(planning, kinds) ? grid_weights() : contact_weights();
  } else {
    weights = pallet_contact_weights();
    if (stand_in_rows(planning, kinds)) weights[Loose] = 0.0;
  }
  return policies;
}

/// The rim of a pallet stays free where no row of boxes reaches from edge to edge: a quarter of what is left, so that
/// nothing is lost where boxes are larger than expected, and 3 mm at most. Boxes at the rim move outward by a few
/// millimetres when others are put beside them. Boxes of many sizes have rows of nearly every length: 3 mm stay free
/// where rows that leave twice as much are hardly shorter than those that leave nothing.
void keep_rim_free(std::span<const Item> kinds, Planning& planning) {
  constexpr double kWidest = 0.003;        // m
  constexpr double kHardlyShorter = 0.02;  // of the pallet's length
  std::vector<int> edges;
  for (const Item& kind : kinds) {
    for (int axis = 0; axis < (kind.upright_only ? 2 : 3); ++axis) edges.push_back(to_ticks(kind.size[axis]));
  }
  const WasteTable rest(edges, to_ticks(planning.inner_size.head<2>().maxCoeff()));
  const auto longest_row = [&](double length) {
    return length - static_cast<double>(rest.waste(to_ticks(length))) / kTicksPerMetre;
  };
  for (double& length : planning.inner_size.head<2>()) {
    const double row = longest_row(length);
    const bool has_many = row - longest_row(length - 4.0 * kWidest) <= kHardlyShorter * length;
    length -= 2.0 * (has_many ? kWidest : std::min(kWidest, 0.25 * (length - row)));
  }
}

/// Rows on a pallet are taken to be in line, with boxes as large as their kind: what each is off by would close slots
/// that are as wide as a box. The rim has room for what adds up.
bool is_aligned(const Planning& planning, std::span<const Item> kinds) {
  return !planning.has_walls && stand_in_rows(planning, kinds);
}

Layout plan_layout(const Planning& planning, std::span<const Item> kinds, const ContainerState& state) {
  const Rules rules = make_rules(planning, kinds);
  return is_aligned(planning, kinds) ? to_aligned_layout(planning, rules, state, kinds)
                                     : to_layout(planning, rules, state);
}

class ContactAwareAgent : public Agent {
 public:
  explicit ContactAwareAgent(AgentInput input) : input_(std::move(input)) {}
  std::string_view name() const override { return name_of(AgentKind::ContactAware); }

  Expected<Decision, NoPlace> decide(const ContainerState& state, const Item& item) override {
    return decide_with_costs(state, item, {});
  }

  Expected<Decision, NoPlace> decide_with_costs(const ContainerState& state, const Item& item,
                                                const PlaceCost& cost) override {
    Expected<Decision, NoPlace> decision = decide_planned(state, item, plan_in(state, input_.settings), cost);
    const bool is_full =
        !decision && (decision.error() == NoPlace::NoSpace || decision.error() == NoPlace::NoStablePlace);
    if (!is_full) return decision;
    Expected<Decision, NoPlace> pressed = decide_pressed(state, item, cost, 0.0);
    return pressed ? pressed : decision;
  }

  Expected<Decision, NoPlace> decide_pressed(const ContainerState& state, const Item& item, const PlaceCost& cost,
                                             double pressed) override {
    if (!input_.run.tries_places) return tl::unexpected(NoPlace::NoSpace);
    PackingSettings settings = input_.settings;
    const double least = std::max(pressed, plan_in(state, settings).planned_interference);
    for (const double share : {0.5, 1.0}) {  // gently first: what has to give way less is more often pushed aside
      settings.planned_interference = share * input_.settings.last_interference;
      const Planning planning = plan_in(state, settings);
      if (planning.planned_interference <= least) continue;
      Expected<Decision, NoPlace> decision = decide_planned(state, item, planning, cost);
      if (!decision) continue;
      decision->pressed = planning.planned_interference;
      return decision;
    }
    return tl::unexpected(NoPlace::NoSpace);
  }

  std::optional<double> expected_percent(const ContainerState& state) override {
    const Planning planning = plan_in(state, input_.settings);
    const std::vector<Item>& kinds = input_.future.kinds;
    Outlook outlook = look_ahead(planning, state, nullptr);
    outlook.race.first_futures = kFutures;
    const std::vector<Layout> entrants{plan_layout(planning, kinds, state)};
    double best = 0.0;
    for (const Policy& policy : policies_for(planning, kinds)) {
      const Standing standing =
          race(entrants, policy, outlook.prospect, outlook.free_volume, outlook.race, nullptr).front();
      best = std::max(best, outlook.percent(standing));
    }
    return best;
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

  /// One decision: what everything below looks at.
  struct Question {
    const Planning& planning;
    const ContainerState& state;
    const Item& item;
    const PlaceCost& cost;
    const Choice& choice;
    const Layout& layout;
    bool is_in_line;  ///< `item` has the size of its kind, and `layout` is aligned
    const Item& measured;
    const Layout& seen;  ///< as boxes lie
  };
  /// What races, and what it is charged.
  struct Field {
    std::vector<Candidate> candidates;
    std::vector<Layout> entrants;
    std::vector<double> costs;  ///< percent
    std::size_t racing = 0;     ///< the first of them; the others come after these
    NoPlace reason = NoPlace::NoStablePlace;
  };

  Expected<Decision, NoPlace> decide_planned(const ContainerState& state, const Item& measured,
                                             const Planning& planning, const PlaceCost& cost) {
    std::vector<Item> kinds = input_.future.kinds;
    kinds.push_back(measured);
    const bool in_line = is_aligned(planning, kinds);
    if (in_line) kinds.back() = with_size_of_kind(measured, kinds);
    const Item& item = kinds.back();
    const Choice choice = make_choice(planning, item);
    if (const auto no = refuse(planning, item, choice)) return tl::unexpected(*no);
    const Layout layout = plan_layout(planning, kinds, state), seen = to_layout(planning, layout.rules(), state);
    CandidatePoseList list;
    Refusal worst = Refusal::None;
    layout.find_poses(choice.piece, list, &worst);
    if (list.poses.empty()) return tl::unexpected(reason_of(worst));
    const Question question{planning, state, item, cost, choice, layout, in_line, measured, seen};
    Outlook outlook = look_ahead(planning, state, &item);
    const std::vector<Policy> policies = policies_for(planning, kinds);
    const PolicyChoice chosen =
        choose_policy(layout, choice.piece, policies, outlook.prospect, outlook.free_volume, outlook.race);
    outlook.race.effort = std::max<std::int64_t>(0, outlook.race.effort - chosen.looked_at);
    // On a pallet the policy stands for what holds, which rollouts do not know: it is left for a sure gain alone.
    const std::size_t racing = planning.has_walls ? affordable(outlook.race, chosen) : kEntrants;
    outlook.race.is_short = racing < kEntrants;
    const Field field = make_field(question, policies, chosen.policy, list.poses, racing);
    if (field.candidates.empty()) return tl::unexpected(field.reason);
    return settle_race(policies[chosen.policy], outlook, field);
  }

  /// How many can race so that the first heat takes half of the effort at most: what a roll-out costs is known by now.
  static std::size_t affordable(const RaceSettings& settings, const PolicyChoice& chosen) {
    if (chosen.roll_outs == 0 || chosen.looked_at == 0) return kEntrants;
    const double each = static_cast<double>(chosen.looked_at) / chosen.roll_outs;
    const double most = 0.5 * static_cast<double>(settings.effort) / (each * settings.first_futures);
    return static_cast<std::size_t>(std::clamp(most, static_cast<double>(kFewest), static_cast<double>(kEntrants)));
  }

  /// The best poses by the chosen policy, and some that only another order would have brought in: those by the other
  /// policy, and those for which the box is not turned. `racing`: as many as can race.
  Field make_field(const Question& ask, const std::vector<Policy>& policies, std::size_t chosen,
                   const std::vector<CandidatePose>& poses, std::size_t racing) const {
    Field field;
    std::vector<CandidatePose> taken;
    const auto take = [&](const CandidatePose& pose) {
      if (std::ranges::find(taken, pose) != taken.end()) return;
      taken.push_back(pose);
      auto candidate = place_item(ask.planning, ask.layout, ask.item, ask.choice, pose, input_.is_reachable);
      if (!candidate) {
        field.reason = candidate.error();
        return;
      }
      if (ask.is_in_line && !make_clear(ask.planning, ask.seen, ask.measured, pose.z, *candidate)) {
        field.reason = NoPlace::NoSpace;
        return;
      }
      field.costs.push_back(ask.cost ? ask.cost(candidate->placement) : 0.0);
      field.candidates.push_back(std::move(*candidate));
      field.entrants.push_back(ask.layout);
      field.entrants.back().add(Layout::block_at(ask.choice.piece, pose));
    };
    const auto take_from = [&](const std::vector<CandidatePose>& ordered, std::size_t most, bool unturned_only) {
      for (const CandidatePose& pose : ordered) {
        if (field.entrants.size() >= most) break;
        if (!unturned_only || is_unturned(ask, pose)) take(pose);
      }
    };
    std::vector<CandidatePose> by_chosen = poses, by_other = poses;
    order_by_cost(ask.layout, policies[chosen], ask.choice.piece, by_chosen);
    order_by_cost(ask.layout, policies[1 - chosen], ask.choice.piece, by_other);
    for (const std::size_t most : {racing, kEntrants}) {
      const std::size_t other = std::max<std::size_t>(1, most * kOther / kEntrants);
      const std::size_t unturned = std::max<std::size_t>(1, most * kUnturned / kEntrants);
      take_from(by_chosen, most - unturned - other, false);
      take_from(by_other, std::min(field.entrants.size() + other, most), false);
      if (ask.cost) take_from(by_chosen, std::min(field.entrants.size() + unturned, most), true);
      take_from(by_chosen, most, false);
      if (field.racing == 0) field.racing = field.entrants.size();
    }
    return field;
  }

  /// The box can stand there with the face up that is up now.
  static bool is_unturned(const Question& ask, const CandidatePose& pose) {
    const auto& ways = ask.choice.orientations[static_cast<std::size_t>(pose.orientation)];
    return std::ranges::any_of(ways, [&](const Orientation& way) { return count_flips(ask.item.arrival, way) == 0; });
  }

  Decision settle_race(const Policy& policy, const Outlook& outlook, const Field& field) const {
    Decision decision;
    std::vector<double> charges;
    for (const double cost : field.costs) charges.push_back(0.01 * cost * outlook.room);
    std::vector<Standing> order = race(std::span(field.entrants).first(field.racing), policy, outlook.prospect,
                                       outlook.free_volume, outlook.race, &decision.roll_outs, charges);
    for (std::size_t i = field.racing; i < field.entrants.size(); ++i) {
      order.push_back({.entrant = static_cast<int>(i)});
    }
    const Standing& first = *std::ranges::find(order, 0, &Standing::entrant);
    std::vector<Candidate> ranked;
    for (const Standing& standing : order) {
      Candidate& candidate = ranked.emplace_back(field.candidates[static_cast<std::size_t>(standing.entrant)]);
      // What is beyond doubt alone: the mean of a place that met a few futures is mostly luck.
      const double cost = field.costs[static_cast<std::size_t>(standing.entrant)];
      candidate.score = outlook.percent(first) - field.costs.front() + 100.0 * standing.sure / outlook.room;
      // What dropped out earlier is not worth more than what stayed, whatever its few futures say.
      if (ranked.size() > 1) candidate.score = std::min(candidate.score, ranked[ranked.size() - 2].score);
      candidate.expected_percent = candidate.score + cost;
    }
    decision.candidates = cut(std::move(ranked), static_cast<std::size_t>(input_.settings.max_candidates));
    return decision;
  }

  /// Of the future's kinds: made once, as orders may bring thousands of them.
  const std::vector<Piece>& pieces(const Planning& planning) {
    if (pieces_.empty() || interference_ != planning.planned_interference) pieces_ = pieces_of(planning, input_.future);
    interference_ = planning.planned_interference;
    return pieces_;
  }

  [[nodiscard]] Planning plan_in(const ContainerState& state, const PackingSettings& settings) const {
    Planning planning = plan_for_contact(state, settings);
    if (!state.has_walls && !input_.future.kinds.empty()) keep_rim_free(input_.future.kinds, planning);
    return planning;
  }

  AgentInput input_;
  std::vector<Piece> pieces_;
  double interference_ = 0.0;  ///< with which they were made
};

}  // namespace

Planning plan_for_contact(const ContainerState& state, const PackingSettings& settings) {
  Planning planning{state.inner_size, settings, settings.max_flips, 0.0, settings.planned_interference,
                    state.has_walls};
  if (state.has_walls) return planning;
  // What is planned to press between walls would stick out beyond the edge of a pallet. And no wall stops a column that
  // leans because its boxes hang over: on soft faces each of them turns what stands on it.
  constexpr double kLeastSupport = 0.75;
  planning.planned_interference = 0.0;
  planning.settings.min_support = std::max(settings.min_support, kLeastSupport);
  return planning;
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
  Weights weights = default_weights();
  if (!planning.has_walls) {
    weights = have_one_size(kinds) ? pallet_layer_weights() : pallet_weights();
    if (stand_in_rows(planning, kinds)) weights[Loose] = 0.0;
  }
  return {weights, WasteTable(along, longest), WasteTable(up, to_ticks(planning.inner_size.z()))};
}

std::unique_ptr<Agent> make_contact_aware_agent(AgentInput input) {
  return std::make_unique<ContactAwareAgent>(std::move(input));
}

}  // namespace snug::packing::internal
