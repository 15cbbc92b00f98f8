// ReachMap: where over the container and at the places of pick the robot's tool can stand, and what keeps it from
// others.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/motion/way.hpp"
#include "snug/runs/program_check.hpp"

namespace snug::runs {

enum class ReachVerdict {
  Reached,
  OutOfReach,     ///< no joints bring the tool there
  JointLimit,     ///< they would be beyond a limit, or nearer to it than the controller goes
  Singular,       ///< the controller's task gives way there
  SelfCollision,  ///< two parts of the robot would be too near to each other
  Collision,      ///< a link, the gripper or the cup would be in something that stands there
};
inline constexpr int kReachVerdicts = 6;
[[nodiscard]] const char* name_of(ReachVerdict verdict);

/// What is said of one pose of the tool.
struct PoseReach {
  ReachVerdict verdict = ReachVerdict::Reached;
  std::string what;       ///< joint, or "part - body"; empty where it is reached or out of reach
  double margin = 0.0;    ///< of `what`, with its allowance, m (rad); below 0
  std::vector<double> q;  ///< rad (m), the joints that were looked at; empty: none
};

/// Looks at single poses with the tests of `snug check`. A pose is reached where some branch of the arm's inverse
/// passes all of them, those nearest to the robot's posture tried first. Else what is told is of the branch that passes
/// most of them, in the order of ReachVerdict. Ways between poses are not looked at, nor are boxes.
class PoseReachability {
 public:
  /// Throws InputError as robot::load_arm. `allowance` and `range` as in CheckOptions.
  explicit PoseReachability(const model::Scenario& scenario, const CheckOptions& options = {});
  ~PoseReachability();
  PoseReachability(const PoseReachability&) = delete;
  PoseReachability& operator=(const PoseReachability&) = delete;

  /// From any thread.
  [[nodiscard]] PoseReach look(const Pose& X_WE) const;
  /// Joints of every branch there that passes all tests; those nearest to the posture first.
  [[nodiscard]] std::vector<std::vector<double>> find_stands(const Pose& X_WE) const;
  /// From joints `q` at the beginning of a way along it, always to the nearest joints, within their limits. Where it
  /// ends all tests are passed; what is told otherwise has no joints where the way cannot be followed to its end.
  [[nodiscard]] PoseReach follow(const motion::Way& way, const std::vector<double>& q) const;
  /// By a search instead of a formula: some hundred times slower.
  [[nodiscard]] bool is_searched() const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// A verdict with what it is about, as an index into ReachMap::whats; 0: nothing.
struct ReachPoint {
  ReachVerdict verdict = ReachVerdict::Reached;
  int what = 0;
  bool operator==(const ReachPoint&) const = default;
};

/// A level grid over the container: points in the middle of its cells, along Tx first.
struct ReachLayer {
  std::string name;     ///< "on the floor" and the like
  double height = 0.0;  ///< m, of the lip of the cup over the container's floor
  std::vector<ReachPoint> points;
};

/// The middle of the upper face of an item at the aligner, where the cup picks it.
struct ReachPick {
  std::string item;                ///< first of those that are picked there
  int count = 1;                   ///< items that are picked there
  Vector3 p_WS = Vector3::Zero();  ///< m, of the lip
  ReachPoint point;
};

struct ReachMap {
  std::string robot, container;
  Pose X_WT;                                 ///< of the container
  Vector3 inner_size = Vector3::Zero();      ///< m
  int columns = 0, rows = 0;                 ///< along Tx, Ty
  double tool_yaw = 0.0;                     ///< rad, about the vertical: the start's, for which is asked
  std::vector<std::string> whats;            ///< "" first
  std::vector<ReachLayer> layers;            ///< from below
  std::vector<ReachPick> picks;              ///< in the order of sequences
  std::array<int, kReachVerdicts> counts{};  ///< of all points of the layers
};

/// With the tool straight down, turned as at its start. The layers: a low box on the floor, half way up, the rim, a
/// high box carried over the rim. At most 24 by 24 points each, 10 by 10 where the arm's inverse is a search. Throws
/// InputError for a scenario without robot, tool or target container. The map does not depend on `threads`.
[[nodiscard]] ReachMap make_reach_map(const model::Scenario& scenario, int threads, const CheckOptions& options = {});

/// Keys: docs/ui.md, "Reach map".
[[nodiscard]] std::string format_json(const ReachMap& map);
/// For people.
[[nodiscard]] std::string format_table(const ReachMap& map);

}  // namespace snug::runs
