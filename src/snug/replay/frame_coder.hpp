// FrameCoder: frames of a recording in, channels of the replay form out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "snug/record/recording.hpp"
#include "snug/replay/form.hpp"
#include "snug/replay/limits.hpp"

namespace snug::replay {

/// Contacts in three levels (frame, block of one pair of bodies, point), where what stays the same is stored once.
class ContactCoder {
 public:
  ContactCoder();
  void add(const std::vector<record::ContactSample>& contacts);
  /// Coded so far, without those that stayed the same.
  [[nodiscard]] std::size_t points() const { return point_rows_; }
  void move_to(std::vector<ChannelWriter>& channels);

 private:
  /// Point, normal, force, gap, state of each point in quanta: equal blocks look and are stored the same.
  using Block = std::vector<std::array<std::int64_t, 11>>;
  [[nodiscard]] int find_or_add(std::pair<int, int> bodies, const Block& block);

  std::vector<ChannelWriter> channels_;
  std::map<std::pair<int, int>, std::pair<int, Block>> last_;  ///< newest block of a pair
  std::vector<int> last_frame_;                                ///< blocks of the newest run of frame_block
  std::size_t last_first_ = 0;
  std::size_t block_rows_ = 0, frame_block_rows_ = 0, point_rows_ = 0;
};

/// Codes one form's worth of frames.
class FrameCoder {
 public:
  explicit FrameCoder(const record::RecordingHeader& header);
  /// Gives static bodies their row; the first frame added does the same.
  void set_static(const record::Frame& frame);
  void add(const record::Frame& frame);
  [[nodiscard]] std::size_t frames() const { return frames_; }
  /// Points of contact coded so far, without those that stayed the same.
  [[nodiscard]] std::size_t contact_points() const { return contacts_.points(); }
  /// All channels of docs/formats.md that a recording has, and an empty coder.
  [[nodiscard]] std::vector<ChannelWriter> finish();

 private:
  void put_tool(const record::Frame& frame);
  void put_bodies(const record::Frame& frame);
  void put_joints(const record::Frame& frame);
  void put_pose(std::size_t channel, const record::PoseSample& X);

  std::vector<record::BodyKind> kinds_;
  std::vector<ChannelWriter> channels_;
  HoldUse hold_use_;
  std::map<std::size_t, Quaternion> last_quat_;  ///< by channel: signs are chosen for continuity
  std::size_t first_body_channel_ = 0, first_joint_channel_ = 0;
  ContactCoder contacts_;
  std::size_t frames_ = 0;
  bool has_static_ = false;
};

}  // namespace snug::replay
