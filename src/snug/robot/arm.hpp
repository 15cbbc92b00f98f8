// ArmModel: a serial arm as a URDF describes it: joints, links, masses, shapes. Pure data; nothing changes in a run.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "snug/model/body.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::robot {

/// Bounds that let joint vectors and poses live without the heap: of joints, and of all that move between base and
/// tool.
inline constexpr int kMaxJoints = 8, kMaxMoving = 12;

/// One number for each moving joint, base to tool: rad (revolute), m (prismatic), their rates, or Nm and N.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJoints, 1>;
/// One row and column for each moving joint.
using JointMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMaxJoints, kMaxJoints>;

enum class JointKind { Revolute, Prismatic };

/// A moving joint between base and tool.
struct Joint {
  std::string name;
  JointKind kind = JointKind::Revolute;
  Pose X_SJ;                        ///< frame J of the joint in the segment before; that behind coincides with J at 0
  Vector3 axis = Vector3::UnitZ();  ///< unit, in J
  double lower = 0.0;               ///< rad or m; -infinity for a continuous joint
  double upper = 0.0;               ///< rad or m; +infinity for a continuous joint
  double max_speed = 0.0;           ///< rad/s or m/s
  double max_effort = 0.0;          ///< Nm or N
  bool operator==(const Joint&) const = default;
};

/// A moving joint between base and tool that another one leads (<mimic>): it stands at ratio * q[leader] + offset. Its
/// drive is that of its leader, as by the rods that keep the flange of a palletiser level.
struct Follower {
  Joint joint;
  int leader = 0;  ///< index of ArmModel::joints
  double ratio = 1.0, offset = 0.0;
  bool operator==(const Follower&) const = default;
};

/// One of the moving joints of an arm in their order, whether it moves by itself or follows.
struct MovingJoint {
  const Joint& joint;
  Eigen::Index q = 0;                  ///< entry of the joint vector that moves it
  const Follower* follower = nullptr;  ///< null: it moves by itself

  [[nodiscard]] double ratio() const noexcept { return follower != nullptr ? follower->ratio : 1.0; }
  [[nodiscard]] double position(const JointVector& all) const noexcept {
    return follower != nullptr ? follower->ratio * all(q) + follower->offset : all(q);
  }
  /// Of a rate or an acceleration.
  [[nodiscard]] double rate(const JointVector& all) const noexcept {
    return follower != nullptr ? follower->ratio * all(q) : all(q);
  }
};

/// A link of the file, L. Links behind fixed joints share the segment that carries them.
struct Link {
  std::string name;
  int parent = -1;                                                ///< index of the link it hangs on; -1 for the root
  int segment = 0;                                                ///< 0: the base, i + 1: behind ArmModel::moving(i)
  Pose X_SL;                                                      ///< pose in the frame S of that segment
  SpatialInertia inertia{0.0, Vector3::Zero(), Matrix3::Zero()};  ///< in L; mass 0 for a bare frame
  std::vector<model::PlacedShape> shapes;                         ///< collision; their X_BG is X_LG
  bool operator==(const Link&) const = default;
};

/// A serial arm. Segment 0 is the base, segment i + 1 is behind its i-th moving joint, which is joint i where no joint
/// follows another; segment frames are the URDF's joint frames.
struct ArmModel {
  std::string name;
  Pose X_WB;                             ///< root link of the file in the world; set from the scenario
  std::vector<Joint> joints;             ///< that move by themselves, base to tool
  std::vector<Follower> followers;       ///< base to tool
  std::vector<int> order;                ///< of the moving joints: i is joint i, -1 - k follower k; empty: no follower
  std::vector<Link> links;               ///< all links, a parent always before its children
  std::vector<SpatialInertia> segments;  ///< moving joints + 1; each the sum of its links, in S
  int tool_link = 0;                     ///< index of the link whose frame is E
  Pose X_SE;                             ///< E in the last segment

  [[nodiscard]] int joint_count() const noexcept { return static_cast<int>(joints.size()); }
  /// The segment that carries the tool.
  [[nodiscard]] int last_segment() const noexcept { return static_cast<int>(moving_count()); }
  /// Of the joints that move by themselves and of those that follow.
  [[nodiscard]] std::size_t moving_count() const noexcept { return joints.size() + followers.size(); }
  [[nodiscard]] MovingJoint moving(std::size_t i) const noexcept {
    const int at = order.empty() ? static_cast<int>(i) : order[i];
    if (at >= 0) return {joints[static_cast<std::size_t>(at)], at, nullptr};
    const Follower& follower = followers[static_cast<std::size_t>(-1 - at)];
    return {follower.joint, follower.leader, &follower};
  }
  bool operator==(const ArmModel&) const = default;
};

/// Reads a URDF (expanded, no xacro). `tool_frame` names the link that is E. Errors are InputError with file:line and
/// the element: what is not a tree, not serial, has no limits, a mass that cannot be, a mesh that is not there.
/// Meshes become convex hulls; a cylinder with a ball of its radius at either end becomes one capsule; any other
/// cylinder becomes a prism that contains it (docs/theory/robot.md).
[[nodiscard]] ArmModel load_urdf(const std::filesystem::path& path, const std::string& tool_frame = "E");
/// The same from text; `name` stands for the file in messages, `folder` is where relative mesh paths start.
[[nodiscard]] ArmModel parse_urdf(const std::string& text, const std::string& name, const std::string& tool_frame = "E",
                                  const std::filesystem::path& folder = {});

/// What a joint may do, of a URDF that is wanted for nothing else.
struct JointLimits {
  std::string joint;
  double max_speed = 0.0;   ///< rad/s or m/s
  double max_effort = 0.0;  ///< Nm or N; infinity: not known
};
/// Of the moving joints of a URDF's text, in its order; no other part of it is looked at. None of what is no XML;
/// InputError for a joint without a name or a number. `name` stands for the file in messages.
[[nodiscard]] std::vector<JointLimits> parse_joint_limits(const std::string& text, const std::string& name);

/// Index of the link with this name, or -1.
[[nodiscard]] int find_link(const ArmModel& arm, std::string_view name) noexcept;
/// Index of the joint with this name, or -1.
[[nodiscard]] int find_joint(const ArmModel& arm, std::string_view name) noexcept;

/// Whether `link` is `ancestor` or hangs on it, directly or through others.
[[nodiscard]] bool is_behind(const ArmModel& arm, int link, int ancestor) noexcept;

/// Sum of the links that are `link` or hang behind it without a moving joint between, in the frame of `link`. For a
/// force sensor's frame at the flange that is the load it carries: gripper and cup.
[[nodiscard]] SpatialInertia distal_inertia(const ArmModel& arm, int link);

}  // namespace snug::robot
