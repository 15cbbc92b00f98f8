// make_room: a packed box that is to stand elsewhere, so that an item without a place gets one.
#include "snug/planning/room.hpp"

#include <algorithm>
#include <optional>

#include "snug/packing/place_finder.hpp"

namespace snug::planning {
namespace {

constexpr int kMostPlaces = 200;          ///< of one box
constexpr std::size_t kMostWeighed = 12;  ///< moves whose gain is estimated
constexpr std::size_t kMostTried = 4;     ///< moves that are rehearsed
/// Of places that need more interference than is planned few succeed in rehearsals: so much of their gain counts.
constexpr double kPressedChance = 0.2;
constexpr double kOnePlace = 0.010;  ///< m: places of a box that are nearer to each other are one

/// A move and what it leaves.
struct Move {
  model::ItemIndex box;
  packing::PlacedBox there;
  packing::Place place;       ///< of the box
  packing::PlacedBox item;    ///< where it would stand then
  double interference = 0.0;  ///< m, with which the item has its place
  double gain = 0.0;          ///< percent of the container that is expected more
};

bool is_near(const packing::PlacedBox& a, const packing::PlacedBox& b) {
  return (a.X_TP.p - b.X_TP.p).norm() < kOnePlace && a.X_TP.R.isApprox(b.X_TP.R);
}

class RoomSearch {
 public:
  RoomSearch(const Scene& scene, model::ItemIndex item) : scene_(scene), wanted_(scene.item_as_it_stands(item)) {
    for (const model::ItemIndex box : scene.belief.sent) {
      const bool is_packed = box != item && scene.box(box) && scene.locate(box) == Location::Container;
      if (is_packed && scene.can_be_picked(box)) add_moves(box);
    }
  }

  /// Those that need the least interference first.
  std::vector<Move> take() {
    std::ranges::stable_sort(moves_, {}, &Move::interference);
    if (moves_.size() > kMostWeighed) moves_.resize(kMostWeighed);
    return std::move(moves_);
  }

 private:
  void add_moves(model::ItemIndex box) {
    const packing::Item moved = scene_.item_as_it_stands(box);
    const packing::ContainerState without = scene_.container_state(box);
    const settings::PackingSettings& rules = scene_.rules().packing;
    const auto places = packing::PlaceFinder(without, rules).find(moved, kMostPlaces);
    if (!places) return;
    for (const packing::Place& place : *places) {
      const packing::PlacedBox there{moved, packing::pose_at(place)};
      if (place.flips > 0 || is_known(box, there)) continue;
      for (const double interference : {rules.planned_interference, rules.last_interference}) {
        if (const auto at = place_of_item(without, there, interference)) {
          moves_.push_back({box, there, place, *at, interference, 0.0});
          break;
        }
      }
    }
  }

  [[nodiscard]] bool is_known(model::ItemIndex box, const packing::PlacedBox& there) const {
    return std::ranges::any_of(moves_, [&](const Move& one) { return one.box == box && is_near(one.there, there); });
  }

  /// Where the item would have a place, planned smaller by the interference.
  [[nodiscard]] std::optional<packing::PlacedBox> place_of_item(const packing::ContainerState& without,
                                                                const packing::PlacedBox& there,
                                                                double interference) const {
    packing::PackingSettings rules = scene_.rules().packing;
    rules.planned_interference = interference;
    packing::PlaceFinder finder(without, rules);
    finder.add(there);
    const auto places = finder.find(wanted_, 1);
    if (!places) return std::nullopt;
    return packing::PlacedBox{wanted_, packing::pose_at(places->front())};
  }

  const Scene& scene_;
  packing::Item wanted_;
  std::vector<Move> moves_;
};

packing::Placement placement_of(const Move& move) {
  return {move.there.item.id, move.there.X_TP, move.place.orientation, move.place.flips};
}

/// Percent of the container in the end when the item is skipped now; nothing: the agent does not know.
std::optional<double> percent_without(const Scene& scene, model::ItemIndex item, packing::Agent& agent) {
  packing::ContainerState state = scene.container_state(item);
  const bool ends = scene.belief.skips_left <= 0;  // the session, with this item
  state.skipped.push_back(scene.belief.items[item.slot()].id);
  state.skips_left = std::max(0, state.skips_left - 1);
  const std::optional<double> expected = agent.expected_percent(state);
  return expected && ends ? packing::filling_percent(state) : expected;
}

/// The same with the box and the item where the move leaves them.
std::optional<double> percent_after(const Scene& scene, const Move& move, packing::Agent& agent) {
  packing::ContainerState state = scene.container_state(move.box);
  state.boxes.push_back(move.there);
  state.boxes.push_back(move.item);
  return agent.expected_percent(state);
}

/// Those that gain enough, the largest gain first.
std::vector<Move> weigh(const Scene& scene, model::ItemIndex item, std::vector<Move> moves, packing::Agent& agent) {
  const std::optional<double> without = moves.empty() ? std::nullopt : percent_without(scene, item, agent);
  if (!without) return {};
  for (Move& move : moves) move.gain = percent_after(scene, move, agent).value_or(*without) - *without;
  std::erase_if(moves, [&](const Move& move) { return move.gain <= scene.rules().recovery.gain_elsewhere; });
  const double planned = scene.rules().packing.planned_interference;
  std::ranges::stable_sort(moves, std::ranges::greater(), [&](const Move& move) {
    return move.interference > planned ? kPressedChance * move.gain : move.gain;
  });
  return moves;
}

/// What is believed when the motion ended as rehearsed.
BeliefSnapshot after(BeliefSnapshot belief, const Attempt& attempt) {
  for (std::size_t w = 0; w < belief.worlds.size(); ++w) {
    for (std::size_t i = 0; i < belief.boxes.size(); ++i) {
      const std::optional<Pose>& end = attempt.ends[w][i];
      if (!end || !belief.boxes[i]) continue;
      belief.worlds[w].X_WP[i] = end;
      if (w == 0) belief.boxes[i]->X_WP = *end;
    }
  }
  belief.robot = {attempt.program.waypoints.back().X_WE, attempt.q_end, {}};
  return belief;
}

}  // namespace

std::optional<Room> make_room(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget,
                              PlanningWorkspace& work) {
  const Scene scene{belief, work.cell_of(belief)};
  std::vector<Move> tried;
  for (const Move& move : weigh(scene, item, RoomSearch(scene, item).take(), work.agent_for(belief, item, budget))) {
    if (tried.size() >= kMostTried) break;
    const auto is_alike = [&](const Move& one) { return one.box == move.box && is_near(one.item, move.item); };
    if (std::ranges::any_of(tried, is_alike)) continue;
    tried.push_back(move);
    Room room{belief, {}};
    room.asked.chosen.assign(belief.items.size(), std::nullopt);
    room.asked.chosen[move.box.slot()] = placement_of(move);
    room.plan = plan(room.asked, move.box, budget, work);
    if (!room.plan.best) continue;
    if (plan(after(belief, *room.plan.best), item, budget, work).outcome == PlanOutcome::Found) return room;
  }
  return std::nullopt;
}

}  // namespace snug::planning
