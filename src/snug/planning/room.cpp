// make_room: a packed box that is to stand elsewhere, so that an item without a place gets one.
#include "snug/planning/room.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "snug/packing/place_finder.hpp"
#include "snug/skills/primitives.hpp"

namespace snug::planning {
namespace {

constexpr int kMostPlaces = 200;           ///< of one box
constexpr int kFewPlaces = 60;             ///< of one of two boxes that move, and of an item while a box waits
constexpr std::size_t kMostWeighed = 12;   ///< moves whose gain is estimated
constexpr std::size_t kMostTried = 4;      ///< moves that are rehearsed
constexpr std::size_t kMostTriedLast = 8;  ///< the same of each kind where the session ends otherwise
/// Of places that need more interference than is planned few succeed in rehearsals: so much of their gain counts.
constexpr double kPressedChance = 0.2;
constexpr double kOnePlace = 0.010;  ///< m: places of a box that are nearer to each other are one

/// A move and what it leaves.
struct Move {
  model::ItemIndex box;
  packing::PlacedBox there;
  packing::Place place;       ///< of the box
  packing::PlacedBox item;    ///< where it would stand then
  packing::Place item_place;  ///< the same
  double interference = 0.0;  ///< m, with which the item (of a box that waits: one of both) has its place
  bool is_aside = false;      ///< the box waits on the bench, and comes to its place after the item
  std::optional<packing::PlacedBox> second = std::nullopt;  ///< another box that moves after this one
  double gain = 0.0;                                        ///< percent of the container that is expected more
};

bool is_near(const packing::PlacedBox& a, const packing::PlacedBox& b) {
  return (a.X_TP.p - b.X_TP.p).norm() < kOnePlace && a.X_TP.R.isApprox(b.X_TP.R);
}

/// Of a container: its boxes on which nothing stands.
std::vector<std::size_t> uppermost(const packing::ContainerState& state) {
  constexpr double kSunk = 0.020;    // m, of a box into the one below
  constexpr double kShared = 0.010;  // m
  std::vector<std::size_t> free;
  std::vector<packing::Extent> all;
  for (const packing::PlacedBox& box : state.boxes) all.push_back(packing::bounding_extent(box));
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool is_under = std::ranges::any_of(all, [&](const packing::Extent& one) {
      const Vector3 shared = all[i].high.cwiseMin(one.high) - all[i].low.cwiseMax(one.low);
      return &one != &all[i] && shared.head<2>().minCoeff() > kShared && one.low.z() > all[i].high.z() - kSunk;
    });
    if (!is_under) free.push_back(i);
  }
  return free;
}

packing::Item as_it_stands(const packing::PlacedBox& box) {
  packing::Item one = box.item;
  one.arrival = packing::nearest_orientation(box.X_TP.R);
  return one;
}

/// What geometry allows, without a rehearsal.
class RoomSearch {
 public:
  RoomSearch(const Scene& scene, model::ItemIndex item) : scene_(scene), wanted_(scene.item_as_it_stands(item)) {
    for (const model::ItemIndex box : scene.belief.sent) {
      const bool is_packed = box != item && scene.box(box) && scene.locate(box) == Location::Container;
      if (is_packed && scene.can_be_picked(box)) boxes_.push_back(box);
    }
  }

  /// One box moves. `turned`: those alone for which it is turned over.
  std::vector<Move> moves(bool turned) {
    moves_.clear();
    for (const model::ItemIndex box : boxes_) {
      const packing::Item moved = scene_.item_as_it_stands(box);
      const packing::ContainerState without = scene_.container_state(box);
      for (const packing::Place& place : places(without, moved, rules().planned_interference, kMostPlaces)) {
        if ((place.flips > 0) != turned) continue;
        const packing::PlacedBox there{moved, packing::pose_at(place)};
        if (!is_known(box, there)) add_if_item_fits(without, {box, there, place, {}, {}});
      }
    }
    return take();
  }

  /// One box waits until the item stands.
  std::vector<Move> swaps() {
    moves_.clear();
    if (!scene_.cell.layout.flip_place) return {};
    for (const model::ItemIndex box : boxes_) {
      const packing::Item moved = scene_.item_as_it_stands(box);
      const packing::ContainerState without = scene_.container_state(box);
      for (const double interference : interferences()) {
        for (const packing::Place& place : places(without, wanted_, interference, kFewPlaces)) {
          const packing::PlacedBox item{wanted_, packing::pose_at(place)};
          if (!is_known(box, item)) add_if_box_fits(without, {box, {moved, {}}, {}, item, place, interference, true});
        }
      }
    }
    return take();
  }

  /// Two boxes move, one after the other.
  std::vector<Move> pairs() {
    moves_.clear();
    for (const model::ItemIndex box : boxes_) {
      const packing::Item moved = scene_.item_as_it_stands(box);
      const packing::ContainerState without = scene_.container_state(box);
      for (const packing::Place& place : places(without, moved, rules().planned_interference, kFewPlaces)) {
        const packing::PlacedBox there{moved, packing::pose_at(place)};
        packing::ContainerState then = without;
        then.boxes.push_back(there);
        for (const std::size_t i : uppermost(then)) {
          if (i + 1 < then.boxes.size()) add_pairs(then, i, {box, there, place, {}, {}});
        }
      }
    }
    return take();
  }

 private:
  [[nodiscard]] const settings::PackingSettings& rules() const { return scene_.rules().packing; }
  [[nodiscard]] std::vector<double> interferences() const {
    std::vector<double> all{rules().planned_interference};
    if (rules().last_interference > all.front()) all.push_back(rules().last_interference);
    return all;
  }

  [[nodiscard]] packing::PlaceFinder finder(const packing::ContainerState& state, double interference) const {
    packing::PackingSettings settings = rules();
    settings.planned_interference = interference;
    return {state, settings};
  }

  [[nodiscard]] std::vector<packing::Place> places(const packing::ContainerState& state, const packing::Item& box,
                                                   double interference, int most) const {
    auto found = finder(state, interference).find(box, most);
    return found ? std::move(*found) : std::vector<packing::Place>{};
  }

  [[nodiscard]] bool is_known(model::ItemIndex box, const packing::PlacedBox& there) const {
    return std::ranges::any_of(
        moves_, [&](const Move& one) { return one.box == box && is_near(one.is_aside ? one.item : one.there, there); });
  }

  void add_if_item_fits(const packing::ContainerState& without, Move move) {
    for (const double interference : interferences()) {
      packing::PlaceFinder then = finder(without, interference);
      then.add(move.there);
      const auto found = then.find(wanted_, 1);
      if (!found) continue;
      move.item_place = found->front();
      move.item = {wanted_, packing::pose_at(move.item_place)};
      move.interference = interference;
      moves_.push_back(std::move(move));
      return;
    }
  }

  void add_if_box_fits(const packing::ContainerState& without, Move move) {
    for (const double interference : interferences()) {
      packing::PlaceFinder then = finder(without, interference);
      then.add(move.item);
      const auto found = then.find(move.there.item, 1);
      if (!found) continue;
      move.place = found->front();
      move.there.X_TP = packing::pose_at(move.place);
      move.interference = std::max(move.interference, interference);
      moves_.push_back(std::move(move));
      return;
    }
  }

  void add_pairs(const packing::ContainerState& then, std::size_t second, const Move& first) {
    packing::ContainerState without = then;
    without.boxes.erase(without.boxes.begin() + static_cast<std::ptrdiff_t>(second));
    const double planned = rules().planned_interference;
    if (places(without, wanted_, planned, 1).empty()) return;
    const packing::Item moved = as_it_stands(then.boxes[second]);
    for (const packing::Place& place : places(without, moved, planned, kFewPlaces)) {
      packing::PlaceFinder both = finder(without, planned);
      Move move = first;
      move.second = packing::PlacedBox{moved, packing::pose_at(place)};
      both.add(*move.second);
      const auto found = both.find(wanted_, 1);
      if (!found) continue;
      move.item_place = found->front();
      move.item = {wanted_, packing::pose_at(move.item_place)};
      move.interference = planned;
      move.place.flips += place.flips;  // of both, for their order
      moves_.push_back(std::move(move));
      return;
    }
  }

  /// Those that need the least interference first, then those that turn the fewest boxes.
  std::vector<Move> take() {
    std::ranges::stable_sort(moves_, [](const Move& a, const Move& b) {
      return std::pair(a.interference, a.place.flips) < std::pair(b.interference, b.place.flips);
    });
    if (moves_.size() > kMostWeighed) moves_.resize(kMostWeighed);
    return std::move(moves_);
  }

  const Scene& scene_;
  packing::Item wanted_;
  std::vector<model::ItemIndex> boxes_;
  std::vector<Move> moves_;
};

packing::Placement placement_of(const packing::PlacedBox& box, const packing::Place& place) {
  return {box.item.id, box.X_TP, place.orientation, packing::count_flips(box.item.arrival, place.orientation)};
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
  if (move.second) {
    std::erase_if(state.boxes, [&](const auto& one) { return one.item.id == move.second->item.id; });
    state.boxes.push_back(*move.second);
  }
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

/// What is believed when a box stands on the bench.
BeliefSnapshot with_aside(const Scene& scene, model::ItemIndex box) {
  BeliefSnapshot belief = scene.belief;
  const Matrix3 R_WP = rotation_at_aligner(scene, box);
  Pose X_WP{R_WP, scene.cell.layout.flip_place->p_WF};
  X_WP.p.z() -= skills::lowest_corner(R_WP, scene.planned_box(box).size);
  belief.boxes[box.slot()]->X_WP = X_WP;
  for (World& world : belief.worlds) world.X_WP[box.slot()] = X_WP;
  return belief;
}

/// Moves in their order, rehearsed until one succeeds.
class RoomTrials {
 public:
  RoomTrials(const Scene& scene, model::ItemIndex item, const Budget& budget, PlanningWorkspace& work)
      : scene_(scene), item_(item), budget_(budget), work_(work) {}

  [[nodiscard]] std::optional<Room> first_of(std::vector<Move> moves, std::size_t most) {
    std::vector<Move> tried;
    moves = weigh(scene_, item_, std::move(moves), work_.agent_for(scene_.belief, item_, budget_));
    for (const Move& move : moves) {
      if (tried.size() >= most) break;
      const auto is_alike = [&](const Move& one) { return one.box == move.box && is_near(one.item, move.item); };
      if (std::ranges::any_of(tried, is_alike)) continue;
      tried.push_back(move);
      std::optional<Room> room = move.is_aside ? swap(move) : shift(move);
      if (room) return room;
    }
    return std::nullopt;
  }

 private:
  [[nodiscard]] std::optional<Room> shift(const Move& move) {
    Room room{scene_.belief, {}, {}};
    room.asked.chosen.assign(scene_.belief.items.size(), std::nullopt);
    room.asked.chosen[move.box.slot()] = placement_of(move.there, move.place);
    room.plan = plan(room.asked, move.box, budget_, work_);
    if (!room.plan.best) return std::nullopt;
    const BeliefSnapshot then = after(scene_.belief, *room.plan.best);
    if (!move.second) {
      if (plan(then, item_, budget_, work_).outcome == PlanOutcome::Found) return room;
      return std::nullopt;
    }
    const Scene scene{then, scene_.cell};
    RoomTrials next(scene, item_, budget_, work_);
    for (const bool is_turned : {false, true}) {
      if (next.first_of(RoomSearch(scene, item_).moves(is_turned), kMostTried)) return room;
    }
    return std::nullopt;
  }

  [[nodiscard]] std::optional<Room> swap(const Move& move) {
    Room room{with_aside(scene_, move.box), {}, Aside{move.box, placement_of(move.item, move.item_place)}};
    room.asked.chosen.assign(scene_.belief.items.size(), std::nullopt);
    room.asked.chosen[item_.slot()] = room.aside->item;
    const Plan first = plan(room.asked, item_, budget_, work_);
    if (!first.best) return std::nullopt;
    BeliefSnapshot then = after(room.asked, *first.best);
    then.chosen.clear();
    if (std::ranges::find(then.sent, item_) == then.sent.end()) then.sent.push_back(item_);
    if (plan(then, move.box, budget_, work_).outcome == PlanOutcome::Found) return room;
    return std::nullopt;
  }

  const Scene& scene_;
  model::ItemIndex item_;
  const Budget& budget_;
  PlanningWorkspace& work_;
};

}  // namespace

std::optional<Room> make_room(const BeliefSnapshot& belief, model::ItemIndex item, const Budget& budget,
                              PlanningWorkspace& work) {
  const Scene scene{belief, work.cell_of(belief)};
  RoomSearch search(scene, item);
  RoomTrials trials(scene, item, budget, work);
  if (auto room = trials.first_of(search.moves(false), kMostTried)) return room;
  if (belief.skips_left > 0) return std::nullopt;
  if (auto room = trials.first_of(search.moves(true), kMostTriedLast)) return room;
  if (auto room = trials.first_of(search.swaps(), kMostTriedLast)) return room;
  return trials.first_of(search.pairs(), kMostTriedLast);
}

}  // namespace snug::planning
