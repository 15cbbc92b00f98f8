// ReachMap: where over the container and at the places of pick the robot's tool can stand, and what keeps it from
// others.
#include "snug/runs/reach_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "snug/core/input_error.hpp"
#include "snug/core/parallel.hpp"
#include "snug/cup/pick_length.hpp"
#include "snug/motion/tool_yaw.hpp"
#include "snug/robot/inverse.hpp"
#include "snug/robot/load_arm.hpp"
#include "snug/runs/internal/pose_check.hpp"
#include "snug/runs/internal/reach_points.hpp"

namespace snug::runs {
namespace {

using internal::PoseMargin;
using internal::StandingItem;

constexpr int kMostAcross = 24;          ///< points along the longer edge
constexpr int kMostAcrossSearched = 10;  ///< where each takes a search
constexpr std::size_t kMostPicks = 64;   ///< limit of time: each is tried at every point
constexpr double kSamePick = 0.005;      ///< m: picks so near to each other are one

ReachVerdict verdict_of(CheckKind kind) {
  switch (kind) {
    case CheckKind::JointLimit:
      return ReachVerdict::JointLimit;
    case CheckKind::Singularity:
      return ReachVerdict::Singular;
    case CheckKind::SelfCollision:
      return ReachVerdict::SelfCollision;
    default:
      return ReachVerdict::Collision;
  }
}

/// Texts that points share, each once.
class Whats {
 public:
  int index_of(const std::string& what) {
    const auto known = std::ranges::find(all_, what);
    if (known != all_.end()) return static_cast<int>(known - all_.begin());
    all_.push_back(what);
    return static_cast<int>(all_.size()) - 1;
  }
  [[nodiscard]] std::vector<std::string> take() { return std::move(all_); }

 private:
  std::vector<std::string> all_{""};
};

/// Of the tool: at each point of each layer, then at each place of a pick, which the map gets.
std::vector<Pose> add_poses(const model::Scenario& scenario, const std::vector<StandingItem>& items, ReachMap& map) {
  std::vector<Pose> poses;
  const Matrix3 R_WE = motion::upright_tool(map.tool_yaw);
  for (const ReachLayer& layer : map.layers) {
    for (int row = 0; row < map.rows; ++row) {
      for (int column = 0; column < map.columns; ++column) {
        const Vector3 p_TS((column + 0.5) / map.columns * map.inner_size.x() - 0.5 * map.inner_size.x(),
                           (row + 0.5) / map.rows * map.inner_size.y() - 0.5 * map.inner_size.y(), layer.height);
        poses.push_back({R_WE, map.X_WT * p_TS + Vector3(0.0, 0.0, scenario.cup.hold_length)});
      }
    }
  }
  for (const StandingItem& item : items) {
    const auto known = std::ranges::find_if(
        map.picks, [&](const ReachPick& pick) { return (pick.p_WS - item.top).norm() < kSamePick; });
    if (known != map.picks.end()) {
      ++known->count;
    } else if (map.picks.size() < kMostPicks) {
      map.picks.push_back({item.name, 1, item.top, {}});
      poses.push_back({R_WE, item.top + Vector3(0.0, 0.0, cup::pick_length(scenario.cup))});
    }
  }
  return poses;
}

}  // namespace

struct PoseReachability::Impl {
  Impl(const model::Scenario& scenario, const CheckOptions& options)
      : arm(robot::load_arm(scenario)),
        inverse(arm),
        posture(robot::joint_vector(scenario.robot->posture)),
        clearance(arm, {}, scenario.robot->self_collision, scenario.source_name),
        check(scenario, arm, clearance, options.allowance, options.range) {}

  /// Each branch with the full turns that bring it nearest to the posture, where all joints are within their limits;
  /// the nearest branch first.
  [[nodiscard]] std::vector<robot::JointVector> within_limits(const robot::IkBranches& found) const {
    std::vector<robot::JointVector> all;
    for (int i = 0; i < found.count; ++i) {
      robot::JointVector q = found.q[static_cast<std::size_t>(i)];
      bool is_within = true;
      for (int j = 0; j < arm.joint_count() && is_within; ++j) {
        const robot::Joint& joint = arm.joints[static_cast<std::size_t>(j)];
        if (joint.kind == robot::JointKind::Revolute) {
          constexpr double kTurn = 2.0 * std::numbers::pi;
          q[j] += kTurn * std::round((posture[j] - q[j]) / kTurn);
          if (q[j] < joint.lower) q[j] += kTurn;
          if (q[j] > joint.upper) q[j] -= kTurn;
        }
        is_within = joint.lower <= q[j] && q[j] <= joint.upper;
      }
      if (is_within) all.push_back(q);
    }
    std::ranges::stable_sort(all, {}, [&](const robot::JointVector& q) { return (q - posture).squaredNorm(); });
    return all;
  }

  /// What check would say of these joints.
  [[nodiscard]] PoseReach judge(const robot::JointVector& q) const {
    PoseReach result;
    result.q.assign(q.data(), q.data() + q.size());
    const auto note = [&](const PoseMargin& one) {
      if (one.is_kept()) return;
      const double left = one.margin + one.allowance;
      // The first kind that fails is told, in the order of the looks; of one kind the worst.
      const bool is_first = result.verdict == ReachVerdict::Reached;
      if (!is_first && (result.verdict != verdict_of(one.kind) || left >= result.margin)) return;
      result.verdict = verdict_of(one.kind);
      result.what = one.what;
      result.margin = left;
    };
    for (int j = 0; j < arm.joint_count(); ++j) check.look_at_limit(j, q[j], note);
    const robot::ArmPose at = robot::forward(arm, q);
    check.look_at_singularity(robot::singularity_measure(robot::tool_jacobian(arm, at)), note);
    check.look_at_distances(at, {}, 0.0, note);
    return result;
  }

  /// The joint that keeps the branch from its limits that is least beyond them.
  [[nodiscard]] PoseReach beyond_limits(const robot::IkBranches& found) const {
    PoseReach result{ReachVerdict::JointLimit, "", 0.0, {}};
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < found.count; ++i) {
      const robot::JointVector& q = found.q[static_cast<std::size_t>(i)];
      double worst = 0.0;
      std::string what;
      for (int j = 0; j < arm.joint_count(); ++j) {
        const robot::Joint& joint = arm.joints[static_cast<std::size_t>(j)];
        const double beyond = std::max(joint.lower - q[j], q[j] - joint.upper);
        if (beyond <= worst) continue;
        worst = beyond;
        what = joint.name;
      }
      if (worst >= nearest || what.empty()) continue;
      nearest = worst;
      result.what = what;
      result.margin = -worst;
    }
    return result;
  }

  robot::ArmModel arm;
  robot::InverseKinematics inverse;
  robot::JointVector posture;
  control::Clearance clearance;
  internal::PoseCheck check;
};

PoseReachability::PoseReachability(const model::Scenario& scenario, const CheckOptions& options)
    : impl_(std::make_unique<const Impl>(scenario, options)) {}
PoseReachability::~PoseReachability() = default;

bool PoseReachability::is_searched() const { return !impl_->inverse.has_closed_form(); }

PoseReach PoseReachability::look(const Pose& X_WE) const {
  const robot::IkBranches found = impl_->inverse.branches(X_WE, impl_->posture);
  if (found.count == 0) return {ReachVerdict::OutOfReach, "", 0.0, {}};
  const std::vector<robot::JointVector> candidates = impl_->within_limits(found);
  if (candidates.empty()) return impl_->beyond_limits(found);
  PoseReach told;
  for (const robot::JointVector& q : candidates) {
    PoseReach result = impl_->judge(q);
    if (result.verdict == ReachVerdict::Reached) return result;
    // A wall in the way of an arm that could stand there says more than an arm that turned over onto itself.
    if (told.q.empty() || result.verdict > told.verdict) told = std::move(result);
  }
  return told;
}

std::vector<std::vector<double>> PoseReachability::find_stands(const Pose& X_WE) const {
  std::vector<std::vector<double>> stands;
  for (const robot::JointVector& q : impl_->within_limits(impl_->inverse.branches(X_WE, impl_->posture))) {
    PoseReach result = impl_->judge(q);
    if (result.verdict == ReachVerdict::Reached) stands.push_back(std::move(result.q));
  }
  return stands;
}

PoseReach PoseReachability::follow(const motion::Way& way, const std::vector<double>& q_start) const {
  constexpr double kStep = 0.05;          // m, and 0.15 rad
  constexpr double kLargestChange = 0.6;  // rad or m of a joint in one step: more is another branch
  const double angle = angle_between(way.start().R, way.end().R) + std::abs(way.pan());
  const double length = (way.end().p - way.start().p).norm();
  const int steps = std::max(1, static_cast<int>(std::ceil((length + angle / 3.0) / kStep)));
  robot::JointVector q = robot::joint_vector(q_start);
  for (int i = 1; i <= steps; ++i) {
    const auto next = impl_->inverse.refine(way.at(static_cast<double>(i) / steps), q);
    if (!next) return {ReachVerdict::OutOfReach, "", 0.0, {}};
    if ((*next - q).cwiseAbs().maxCoeff() > kLargestChange) return {ReachVerdict::Singular, "", 0.0, {}};
    q = *next;
    for (int j = 0; j < q.size(); ++j) {
      const robot::Joint& joint = impl_->arm.joints[static_cast<std::size_t>(j)];
      const double left = std::min(q[j] - joint.lower, joint.upper - q[j]);
      if (left < 0.0) return {ReachVerdict::JointLimit, joint.name, left, {}};
    }
  }
  return impl_->judge(q);
}

const char* name_of(ReachVerdict verdict) {
  switch (verdict) {
    case ReachVerdict::Reached:
      return "reached";
    case ReachVerdict::OutOfReach:
      return "out of reach";
    case ReachVerdict::JointLimit:
      return "joint limit";
    case ReachVerdict::Singular:
      return "singularity";
    case ReachVerdict::SelfCollision:
      return "self-collision";
    case ReachVerdict::Collision:
      break;
  }
  return "collision";
}

ReachMap make_reach_map(const model::Scenario& scenario, int threads, const CheckOptions& options) {
  const auto [container, tool_yaw] = internal::find_target(scenario);
  const PoseReachability reach(scenario, options);

  ReachMap map;
  map.robot = scenario.robot->name;
  map.container = container->name;
  map.X_WT = container->X_WT;
  map.inner_size = container->inner_size;
  map.tool_yaw = tool_yaw;
  const double spacing =
      container->inner_size.head<2>().maxCoeff() / (reach.is_searched() ? kMostAcrossSearched : kMostAcross);
  map.columns = std::max(1, static_cast<int>(std::lround(container->inner_size.x() / spacing)));
  map.rows = std::max(1, static_cast<int>(std::lround(container->inner_size.y() / spacing)));
  const std::vector<StandingItem> items = internal::find_items(scenario);
  const std::array<double, 4> heights = internal::layer_heights(*container, items);
  map.layers = {{"low box on the floor", heights[0], {}},
                {"half way up", heights[1], {}},
                {container->has_walls ? "at the rim" : "highest box", heights[2], {}},
                {"carried over the rim", heights[3], {}}};

  const std::size_t points =
      map.layers.size() * static_cast<std::size_t>(map.rows) * static_cast<std::size_t>(map.columns);
  const std::vector<Pose> poses = add_poses(scenario, items, map);
  std::vector<PoseReach> found(poses.size());
  parallel_for(static_cast<int>(poses.size()), threads, [&](int i, int) {
    found[static_cast<std::size_t>(i)] = reach.look(poses[static_cast<std::size_t>(i)]);
  });

  Whats whats;
  const std::size_t layer_points = map.layers.empty() ? 1 : points / map.layers.size();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const ReachPoint point{found[i].verdict, whats.index_of(found[i].what)};
    if (i < points) {
      map.layers[i / layer_points].points.push_back(point);
      ++map.counts[static_cast<std::size_t>(point.verdict)];
    } else {
      map.picks[i - points].point = point;
    }
  }
  map.whats = whats.take();
  return map;
}

}  // namespace snug::runs
