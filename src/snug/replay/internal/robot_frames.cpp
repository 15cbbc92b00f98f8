// RobotFrames: frames of a robot's links as its URDF has them.
#include "snug/replay/internal/robot_frames.hpp"

#include <algorithm>
#include <map>
#include <optional>

#include "snug/replay/internal/mcap_messages.hpp"

namespace snug::replay::internal {
namespace {

constexpr double kSamePlace = 1e-6;  ///< m and rad: far above rounding, far below what anybody sees

bool is_same(const Pose& a, const Pose& b) {
  return (a.p - b.p).norm() < kSamePlace && (a.R - b.R).norm() < kSamePlace;
}

int column_of(const record::RecordingHeader& header, const robot::LinkJoint& joint) {
  const auto found = std::ranges::find(header.joints, joint.name);
  return joint.kind && found != header.joints.end() ? static_cast<int>(found - header.joints.begin()) : -1;
}

double position_of(const record::Frame& frame, int column) {
  const auto index = static_cast<std::size_t>(column);
  return column >= 0 && index < frame.joints.size() ? frame.joints[index].position : 0.0;
}

}  // namespace

RobotFrames::RobotFrames(const record::RecordingHeader& header, const std::string& urdf, const record::Frame& first) {
  for (robot::LinkJoint& joint : robot::parse_link_tree(urdf)) {
    joints_.push_back({std::move(joint), 0});
    joints_.back().column = column_of(header, joints_.back().joint);
  }
  if (joints_.empty()) return;
  std::map<std::string, Pose> X_RL = {{joints_.front().joint.parent, Pose()}};  // in the root R
  for (const auto& [joint, column] : joints_) {
    X_RL[joint.child] = X_RL.at(joint.parent) * robot::pose_at(joint, position_of(first, column));
  }
  std::optional<Pose> X_WR;
  for (std::size_t i = 0; i < header.bodies.size() && !X_WR; ++i) {
    if (!header.bodies[i].name.starts_with("robot/")) continue;
    const auto link = X_RL.find(header.bodies[i].name.substr(6));
    if (link != X_RL.end()) X_WR = first.bodies[i].X_WB.pose() * link->second.inverse();
  }
  const bool is_standing = X_WR.has_value();
  if (is_standing) root_ = {std::string(kWorldFrame), joints_.front().joint.parent, *X_WR};
  const auto is_taken = [&](const std::string& link) {
    if (link == kWorldFrame || link == kLipFrame || record::find_body(header, link) >= 0) return true;
    return link == kToolFrame && !(is_standing && is_same(*X_WR * X_RL.at(link), first.X_WE.pose()));
  };
  if (!is_standing || is_taken(root_.child)) {
    joints_.clear();
    return;
  }
  std::erase_if(joints_, [&](const Hung& hung) { return is_taken(hung.joint.child); });
}

std::vector<LinkFrame> RobotFrames::still() const {
  std::vector<LinkFrame> frames;
  if (joints_.empty()) return frames;
  frames.push_back(root_);
  for (const auto& [joint, column] : joints_) {
    if (column < 0) frames.push_back({joint.parent, joint.child, robot::pose_at(joint, 0.0)});
  }
  return frames;
}

std::vector<LinkFrame> RobotFrames::moving(const record::Frame& frame) const {
  std::vector<LinkFrame> frames;
  for (const auto& [joint, column] : joints_) {
    if (column >= 0) {
      frames.push_back({joint.parent, joint.child, robot::pose_at(joint, position_of(frame, column))});
    }
  }
  return frames;
}

bool RobotFrames::has(std::string_view link) const {
  return !joints_.empty() && (root_.child == link ||
                              std::ranges::any_of(joints_, [&](const Hung& hung) { return hung.joint.child == link; }));
}

}  // namespace snug::replay::internal
