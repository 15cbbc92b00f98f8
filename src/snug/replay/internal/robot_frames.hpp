// RobotFrames: frames of a robot's links as its URDF has them, one joint each, from what a recording tells. Internal to
// the module.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "snug/record/recording.hpp"
#include "snug/robot/link_tree.hpp"

namespace snug::replay::internal {

struct LinkFrame {
  std::string parent, child;
  record::PoseSample X_PC;
};

/// Links have the names that the URDF gives them, so that who reads it places them. Links that are called like a body
/// or a frame of every recording (W, S; E, unless the link is where the tool is) are left out.
class RobotFrames {
 public:
  RobotFrames() = default;
  /// Empty when the recording has no body of the URDF's links, which tell where it stands: `first` is its first frame.
  RobotFrames(const record::RecordingHeader& header, const std::string& urdf, const record::Frame& first);

  /// The root in W, links behind fixed joints, and those of moving joints that the recording has no positions of.
  [[nodiscard]] std::vector<LinkFrame> still() const;
  [[nodiscard]] std::vector<LinkFrame> moving(const record::Frame& frame) const;
  [[nodiscard]] bool has(std::string_view link) const;

 private:
  struct Hung {
    robot::LinkJoint joint;
    int column = -1;  ///< of the frame's joints; -1: does not move
  };
  std::vector<Hung> joints_;
  LinkFrame root_;
};

}  // namespace snug::replay::internal
