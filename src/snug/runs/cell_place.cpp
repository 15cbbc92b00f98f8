// CellPlace: where the robot's base and the aligner can stand so that the tool reaches all that packing needs.
#include "snug/runs/cell_place.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "snug/cell/joint_pace.hpp"
#include "snug/core/parallel.hpp"
#include "snug/model/pose_edit.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/runs/internal/place_task.hpp"
#include "snug/runs/internal/reach_profile.hpp"
#include "snug/runs/reach_map.hpp"

namespace snug::runs {
namespace {

using internal::CornerPlace;
using internal::Footprint;
using internal::kFreeBetween;
using internal::NeededPose;
using internal::PlaceTask;
using internal::ReachProfile;

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kEnoughMargin = 0.06;  ///< m, what a cell is built to, and more; beyond, short ways count
constexpr double kPlaceGrid = 0.05;     ///< m, between places of the aligner and of the base
constexpr int kDirections = 32;         ///< of the base around the container
constexpr double kHeightStep = 0.1;     ///< m, of the base
constexpr int kHeightSteps = 8;         ///< up and down
constexpr double kHeightWorth = 0.5;    ///< m of travel for a metre of height that the base is moved by
constexpr double kMarginWorth = 0.5;    ///< m of travel for a metre of margin,
constexpr double kMostMargin = 0.2;     ///< m, of which more is worth nothing
constexpr double kSpareTurn = 0.35;     ///< rad, of the first joint, for arms whose shoulder is beside its axis
constexpr std::size_t kLookedAt = 12;   ///< places that are looked at pose by pose,
constexpr std::size_t kRounds = 5;      ///< and so many times as many as long as none reaches everything
constexpr double kRoundLength = 0.01;   ///< m, to which places of the base are rounded,
constexpr double kRoundAngle = kHalfTurn / 180.0;  ///< rad, and its turn
constexpr double kSamePlace = 0.12;                ///< m: places so near to each other are not both looked at
constexpr std::size_t kTold = 5;

struct BasePlace {
  Vector3 p_W = Vector3::Zero();
  double yaw = 0.0;
  [[nodiscard]] Footprint outline() const { return {p_W.head<2>(), {internal::kHalfFoot, internal::kHalfFoot}, yaw}; }
};

struct Candidate {
  BasePlace base;
  CornerPlace corner;
  double margin = 0.0;  ///< m, as PlacedCell::margin
  double travel = 0.0;  ///< m
  double cost = 0.0;    ///< m of travel, what height and margin are worth among it
};

double rounded(double value, double step) { return step * std::round(value / step); }

/// Enough margin first, then the lower cost.
bool is_better(const Candidate& a, const Candidate& b) {
  const double enough_a = std::min(a.margin, kEnoughMargin), enough_b = std::min(b.margin, kEnoughMargin);
  return enough_a != enough_b ? enough_a > enough_b : a.cost < b.cost;
}

Pose with_yaw(const Pose& X_W, double yaw) {
  return {exp_rotation(Vector3(0.0, 0.0, yaw - model::yaw_about_vertical(X_W.R))) * X_W.R, X_W.p};
}

/// Weighs places by the reach of the arm alone.
class Scale {
 public:
  Scale(const model::Scenario& scenario, const PlaceOptions& options, const PlaceTask& task)
      : task_(task),
        options_(options),
        base_{scenario.robot->X_WB.p, model::yaw_about_vertical(scenario.robot->X_WB.R)},
        corner_{scenario.aligner->X_WA.p.head<2>(), model::yaw_about_vertical(scenario.aligner->X_WA.R)},
        support_(scenario.aligner->support_height),
        profile_(make_profile(scenario)) {}

  [[nodiscard]] const ReachProfile& profile() const { return profile_; }

  [[nodiscard]] Candidate as_it_is() const {
    Candidate one{base_, corner_};
    weigh(one);
    return one;
  }

  /// For each base the best corner.
  [[nodiscard]] std::vector<Candidate> find_candidates(int& tried) const {
    const std::vector<BasePlace> bases = all_bases();
    const std::vector<CornerPlace> corners = all_corners();
    std::vector<std::optional<Candidate>> best(bases.size());
    std::vector<int> counts(bases.size(), 0);
    parallel_for(static_cast<int>(bases.size()), options_.threads, [&](int i, int) {
      const auto at = static_cast<std::size_t>(i);
      best[at] = find_corner(bases[at], corners, counts[at]);
    });
    std::vector<Candidate> all;
    for (std::size_t i = 0; i < bases.size(); ++i) {
      tried += counts[i];
      if (best[i]) all.push_back(*best[i]);
    }
    std::ranges::stable_sort(all, is_better);
    return all;
  }

  /// Of the tool: half way between pick and container around the robot, over everything.
  [[nodiscard]] Pose start_of(const Candidate& one) const {
    const Eigen::Vector2d axis = axis_of(one.base);
    const Eigen::Vector2d a = task_.container.middle - axis, b = task_.pick_middle(one.corner) - axis;
    const double from = std::atan2(a.y(), a.x());
    const double angle = from + 0.5 * std::remainder(std::atan2(b.y(), b.x()) - from, 2.0 * kHalfTurn);
    const double radius = 0.5 * (a.norm() + b.norm());
    const double top = std::max(task_.X_WT.p.z() + task_.heights.back(), support_ + task_.highest_pick);
    return {motion::upright_tool(task_.tool_yaw),
            {axis.x() + radius * std::cos(angle), axis.y() + radius * std::sin(angle), top}};
  }

 private:
  [[nodiscard]] double sway() const {
    return options_.moves_robot && options_.moves_height ? kHeightStep * kHeightSteps : 0.0;
  }

  [[nodiscard]] ReachProfile make_profile(const model::Scenario& scenario) const {
    const double floor = task_.X_WT.p.z() - base_.p_W.z(), support = support_ - base_.p_W.z();
    const double low = std::min(floor + task_.heights.front(), support + task_.lowest_pick);
    const double high = std::max(floor + task_.heights.back(), support + task_.highest_pick);
    return {scenario, low - sway(), high + sway(), options_.threads};
  }

  [[nodiscard]] std::vector<BasePlace> all_bases() const {
    if (!options_.moves_robot) return {base_};
    std::vector<BasePlace> all;
    const int steps = sway() > 0.0 ? kHeightSteps : 0;
    for (int step = -steps; step <= steps; ++step) {
      for (double radius = kPlaceGrid; radius < profile_.reach(); radius += kPlaceGrid) {
        for (int i = 0; i < kDirections; ++i) {
          const double angle = task_.container.yaw + 2.0 * kHalfTurn * i / kDirections;
          const Eigen::Vector2d p = task_.container.middle + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle));
          const BasePlace base{
              {rounded(p.x(), kRoundLength), rounded(p.y(), kRoundLength), base_.p_W.z() + kHeightStep * step}, 0.0};
          const auto is_in = [&](const Footprint& other) { return base.outline().is_near(other, 0.0); };
          const bool is_free =
              !base.outline().is_near(task_.container, kFreeBetween) && !std::ranges::any_of(task_.blocking, is_in);
          if (is_free) all.push_back(base);
        }
      }
    }
    return all;
  }

  /// Around the container, the nearest first.
  [[nodiscard]] std::vector<CornerPlace> all_corners() const {
    if (!options_.moves_aligner) return {corner_};
    std::vector<CornerPlace> all;
    const int steps = static_cast<int>(2.0 * profile_.reach() / kPlaceGrid);
    const Eigen::Rotation2Dd turn(task_.container.yaw);
    for (int x = -steps; x <= steps; ++x) {
      for (int y = -steps; y <= steps; ++y) {
        for (int quarter = 0; quarter < 4; ++quarter) {
          const CornerPlace corner{task_.container.middle + turn * Eigen::Vector2d(kPlaceGrid * x, kPlaceGrid * y),
                                   corner_.yaw + 0.5 * kHalfTurn * quarter};
          if (task_.is_free(corner)) all.push_back(corner);
        }
      }
    }
    std::ranges::stable_sort(all, {}, [&](const CornerPlace& one) { return travel_of(one); });
    return all;
  }

  [[nodiscard]] std::optional<Candidate> find_corner(const BasePlace& base, const std::vector<CornerPlace>& corners,
                                                     int& tried) const {
    ++tried;
    std::optional<Candidate> best;
    const double in_container = container_margin(base);
    if (in_container <= 0.0) return best;
    for (const CornerPlace& corner : corners) {
      Candidate one{base, corner};
      if (options_.moves_robot && !turn_base(one)) continue;
      if (one.base.outline().is_near(task_.outline_of(corner), kFreeBetween)) continue;
      ++tried;
      weigh(one);
      if (one.margin > 0.0 && (!best || is_better(one, *best))) best = one;
      // Those that follow are farther away: none is better than the best could be at this distance.
      const bool has_enough = best && best->margin >= std::min(in_container, kEnoughMargin);
      if (has_enough && cost_of(base, one.travel, in_container) >= best->cost) break;
    }
    return best;
  }

  /// Turns the base so that container and picks are to either side of the middle of its first joint; false where that
  /// joint does not turn so far.
  [[nodiscard]] bool turn_base(Candidate& one) const {
    // The axis moves a little with the turn: once more with what comes out.
    for (int round = 0; round < 2; ++round) {
      const Eigen::Vector2d axis = axis_of(one.base), to_container = task_.container.middle - axis;
      const double around = std::atan2(to_container.y(), to_container.x());
      double low = 0.0, high = 0.0;  // from there
      const auto include = [&](const Eigen::Vector2d& p) {
        const double angle = std::remainder(std::atan2(p.y() - axis.y(), p.x() - axis.x()) - around, 2.0 * kHalfTurn);
        low = std::min(low, angle);
        high = std::max(high, angle);
      };
      for (const Eigen::Vector2d& point : task_.points) include(point);
      for (const Vector3& p_A : task_.picks_A) include(one.corner.at(p_A));
      if (0.5 * (high - low) > profile_.half_turn() - kSpareTurn) return false;
      one.base.yaw = std::remainder(around + 0.5 * (low + high) - profile_.middle(), 2.0 * kHalfTurn);
    }
    one.base.yaw = rounded(one.base.yaw, kRoundAngle);
    return true;
  }

  [[nodiscard]] Eigen::Vector2d axis_of(const BasePlace& base) const {
    return base.p_W.head<2>() + Eigen::Rotation2Dd(base.yaw) * profile_.axis();
  }
  [[nodiscard]] double travel_of(const CornerPlace& corner) const {
    return (task_.pick_middle(corner) - task_.container.middle).norm();
  }

  [[nodiscard]] double container_margin(const BasePlace& base) const {
    const Eigen::Vector2d axis = axis_of(base);
    double margin = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector2d& point : task_.points) {
      for (const double height : task_.heights)
        margin = std::min(margin, profile_.depth((point - axis).norm(), task_.X_WT.p.z() + height - base.p_W.z()));
      if (margin <= 0.0) break;
    }
    return margin;
  }

  void weigh(Candidate& one) const {
    const Eigen::Vector2d axis = axis_of(one.base);
    const double support = support_ - one.base.p_W.z();
    one.margin = container_margin(one.base);
    for (const Vector3& p_A : task_.picks_A) {
      const double distance = (one.corner.at(p_A) - axis).norm();
      for (const double height : {task_.lowest_pick, task_.highest_pick})
        one.margin = std::min(one.margin, profile_.depth(distance, support + height));
      if (one.margin <= 0.0) break;
    }
    one.travel = travel_of(one.corner);
    one.cost = cost_of(one.base, one.travel, one.margin);
  }

  [[nodiscard]] double cost_of(const BasePlace& base, double travel, double margin) const {
    return travel + kHeightWorth * std::abs(base.p_W.z() - base_.p_W.z()) -
           kMarginWorth * std::min(margin, kMostMargin);
  }

  const PlaceTask& task_;
  const PlaceOptions& options_;
  BasePlace base_;
  CornerPlace corner_;
  double support_ = 0.0;
  ReachProfile profile_;
};

model::Scenario move_to(const model::Scenario& before, const PlaceOptions& options, const Candidate& one) {
  model::Scenario scenario = before;
  Pose& X_WB = scenario.robot->X_WB;
  X_WB = with_yaw({X_WB.R, one.base.p_W}, one.base.yaw);
  Pose& X_WA = scenario.aligner->X_WA;
  X_WA = with_yaw({X_WA.R, {one.corner.p_W.x(), one.corner.p_W.y(), X_WA.p.z()}}, one.corner.yaw);
  for (model::Body& body : scenario.bodies)
    if (std::ranges::find(options.stand_with_robot, body.name) != options.stand_with_robot.end())
      body.X_WB = X_WB * before.robot->X_WB.inverse() * body.X_WB;
  return scenario;
}

std::string describe_reach(const PoseReach& reach) {
  return name_of(reach.verdict) + (reach.what.empty() ? std::string() : " (" + reach.what + ")");
}

/// From joints that the arm starts with: how many poses are reached, and the first that is not.
std::pair<int, std::string> count_reached(const PoseReachability& reach, const std::vector<NeededPose>& needed,
                                          const Pose& X_WE_start, const std::optional<motion::PanAxis>& pan_axis,
                                          const std::vector<double>& q) {
  std::pair<int, std::string> result{0, ""};
  const NeededPose* before = nullptr;
  PoseReach over;
  for (const NeededPose& pose : needed) {
    if (before == nullptr || before->X_WE_over != pose.X_WE_over)
      over = reach.follow({X_WE_start, pose.X_WE_over, pan_axis}, q);
    before = &pose;
    const PoseReach there =
        over.verdict == ReachVerdict::Reached ? reach.follow({pose.X_WE_over, pose.X_WE}, over.q) : over;
    if (there.verdict == ReachVerdict::Reached)
      ++result.first;
    else if (result.second.empty())
      result.second = pose.what + ": " + describe_reach(there);
  }
  return result;
}

PlacedCell look_at(const model::Scenario& scenario, const PlaceOptions& options, const PlaceTask& task,
                   const Scale& scale, const Candidate& one) {
  PlacedCell place;
  place.X_WB = scenario.robot->X_WB;
  place.X_WA = scenario.aligner->X_WA;
  place.X_WE_start = scale.start_of(one);
  place.margin = one.margin;
  place.travel = one.travel;
  const PoseReachability reach(scenario, options.check);
  const std::vector<NeededPose> needed = find_needed(scenario, task);
  const std::optional<motion::PanAxis> pan_axis = cell::find_pan_axis(scenario);
  place.missing = "start: " + describe_reach(reach.look(place.X_WE_start));
  for (const std::vector<double>& q : reach.find_stands(place.X_WE_start)) {
    const auto [reached, missing] = count_reached(reach, needed, place.X_WE_start, pan_axis, q);
    if (!place.posture.empty() && reached <= place.reached) continue;
    place.reached = reached;
    place.missing = missing;
    place.posture = q;
    if (missing.empty()) break;
  }
  return place;
}

/// Those that differ, the best first.
std::vector<Candidate> choose_different(const std::vector<Candidate>& candidates) {
  std::vector<Candidate> chosen;
  for (const Candidate& one : candidates) {
    const bool is_known = std::ranges::any_of(chosen, [&](const Candidate& other) {
      return (one.base.p_W - other.base.p_W).norm() < kSamePlace &&
             (one.corner.p_W - other.corner.p_W).norm() < kSamePlace;
    });
    if (!is_known) chosen.push_back(one);
    if (chosen.size() == kLookedAt * kRounds) break;
  }
  return chosen;
}

}  // namespace

PlaceSearch place_cell(const model::Scenario& scenario, const PlaceOptions& options) {
  const PlaceTask task = internal::make_place_task(scenario, options);
  const Scale scale(scenario, options, task);
  PlaceSearch search;
  search.robot = scenario.robot->name;
  search.container = model::find_container(scenario, scenario.target)->name;
  search.reach = scale.profile().reach();
  search.asked = static_cast<int>(find_needed(scenario, task).size());
  search.before = look_at(scenario, options, task, scale, scale.as_it_is());
  const std::vector<Candidate> chosen = choose_different(scale.find_candidates(search.tried));
  const auto is_whole = [](const PlacedCell& place) { return place.missing.empty(); };
  while (search.places.size() < chosen.size() && std::ranges::none_of(search.places, is_whole)) {
    const std::size_t begin = search.places.size();
    search.places.resize(std::min(chosen.size(), begin + kLookedAt));
    parallel_for(static_cast<int>(search.places.size() - begin), options.threads, [&](int i, int) {
      const std::size_t at = begin + static_cast<std::size_t>(i);
      search.places[at] = look_at(move_to(scenario, options, chosen[at]), options, task, scale, chosen[at]);
    });
  }
  // Candidates came in the order of their margin and cost.
  std::ranges::stable_sort(search.places, std::greater{}, &PlacedCell::reached);
  if (search.places.size() > kTold) search.places.resize(kTold);
  return search;
}

std::string write_place(const model::Scenario& scenario, const PlacedCell& place, const PlaceOptions& options) {
  std::vector<model::PoseEdit> edits;
  const auto move = [&](const std::string& key, const Pose& X_W) {
    edits.push_back({key, X_W.p, model::yaw_about_vertical(X_W.R)});
  };
  if (options.moves_robot) {
    move("robot", place.X_WB);
    for (const std::string& name : options.stand_with_robot) {
      const auto body = std::ranges::find(scenario.bodies, name, &model::Body::name);
      move("bodies." + name, place.X_WB * scenario.robot->X_WB.inverse() * body->X_WB);
    }
  }
  if (options.moves_aligner) move("aligner", place.X_WA);
  move(model::kStartKey, place.X_WE_start);
  model::Scenario moved = scenario;
  moved.source_text = model::move_parts(scenario, edits);
  return place.posture.empty() ? moved.source_text : model::write_posture(moved, place.posture);
}

}  // namespace snug::runs
