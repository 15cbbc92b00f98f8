// FrameCoder: frames of a recording in, channels of the replay form out.
#include "snug/replay/frame_coder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "snug/core/check.hpp"
#include "snug/core/units.hpp"

namespace snug::replay {
namespace {

constexpr double kPoseQuantum = 1.0e-5;    // m, -: 0.01 mm and 0.02 mrad, below what anybody sees
constexpr double kTwistQuantum = 1.0e-4;   // m/s, rad/s
constexpr double kWrenchQuantum = 1.0e-3;  // N, Nm
constexpr double kJointQuantum = 1.0e-5;   // rad
constexpr double kTorqueQuantum = 1.0e-2;  // Nm
constexpr double kPointQuantum = 1.0e-4;   // m
constexpr double kNormalQuantum = 1.0e-3;  // -
constexpr double kForceQuantum = 1.0e-2;   // N
constexpr double kGapQuantum = 1.0e-7;     // m: rigid contacts give way by micrometres

const std::vector<std::string> kPoseColumns = {"x", "y", "z", "qw", "qx", "qy", "qz"};
const std::vector<std::string> kXyz = {"x", "y", "z"};
const std::vector<std::string> kWrenchColumns = {"fx", "fy", "fz", "tx", "ty", "tz"};

/// Channels of fixed place in FrameCoder::channels_; those of bodies follow.
enum FixedChannel : std::size_t {
  kTime,
  kProgramRow,
  kToolPose,
  kToolPoseCommand,
  kToolTwist,
  kCupCommand,
  kCupPressure,
  kCupAttached,
  kCupPose,
  kCupDeformation,
  kCupWrench,
  kHoldUse,
  kFlangeWrench,
  kSolverResidual,
  kSolverIterations,
  kSolverStatus,
  kFixedChannels
};

std::vector<ChannelWriter> fixed_channels() {
  std::vector<ChannelWriter> channels;
  channels.reserve(kFixedChannels);
  const auto add = [&](ChannelSpec spec) { channels.emplace_back(std::move(spec)); };
  add({"time", {"t"}, "s", "", 1.0e-6});
  add({"program_row", {"row"}, "", "", 1.0});
  add({"tool.pose", kPoseColumns, "m, -", "W", kPoseQuantum});
  add({"tool.pose_command", kPoseColumns, "m, -", "W", kPoseQuantum});
  add({"tool.twist", {"vx", "vy", "vz", "wx", "wy", "wz"}, "m/s, rad/s", "W", kTwistQuantum});
  add({"cup.command", {"vacuum", "blow_off"}, "", "", 1.0});
  add({"cup.pressure_gauge", {"pressure"}, "Pa", "", 10.0});
  add({"cup.attached_body", {"body"}, "", "", 1.0});
  add({"cup.pose", kPoseColumns, "m, -", "E", kPoseQuantum});
  add({"cup.deformation", {"length", "bend"}, "m, rad", "", 1.0e-5});
  add({"cup.wrench", kWrenchColumns, "N, Nm", "S", kWrenchQuantum});
  add({"cup.hold_use", {"used"}, "", "", 1.0e-4});
  add({"flange.wrench", kWrenchColumns, "N, Nm", "F", kWrenchQuantum});
  add({"solver.residual", {"residual"}, "m/s", "", 1.0e-8});
  add({"solver.iterations", {"value"}, "", "", 1.0});
  add({"solver.status", {"value"}, "", "", 1.0});
  SNUG_CHECK(channels.size() == kFixedChannels, "each fixed channel is described");
  return channels;
}

std::array<double, 6> row_of(const Vector3& a, const Vector3& b) { return {a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}; }

/// Infinite and absurd values all become one number that no contact has.
std::int64_t in_quanta(double value, double quantum) {
  const double quanta = std::round(value / quantum);
  return std::abs(quanta) < 0x1.0p50 ? static_cast<std::int64_t>(quanta) : std::numeric_limits<std::int64_t>::min();
}

double from_quanta(std::int64_t i, double quantum) {
  return i == std::numeric_limits<std::int64_t>::min() ? kNaN : static_cast<double>(i) * quantum;
}

enum ContactChannel : std::size_t {
  kFrameFirst,
  kFrameCount,
  kFrameBlock,
  kBlockBody,
  kBlockFirst,
  kBlockCount,
  kPoint,
  kNormal,
  kForce,
  kGap,
  kState
};

std::vector<ChannelWriter> contact_channels() {
  std::vector<ChannelWriter> channels;
  const auto add = [&](ChannelSpec spec) { channels.emplace_back(std::move(spec)); };
  add({"contacts.frame_first", {"value"}, "", "", 1.0});
  add({"contacts.frame_count", {"value"}, "", "", 1.0});
  add({"contacts.frame_block", {"block"}, "", "", 1.0});
  add({"contacts.block_body", {"a", "b"}, "", "", 1.0});
  add({"contacts.block_first", {"value"}, "", "", 1.0});
  add({"contacts.block_count", {"value"}, "", "", 1.0});
  add({"contacts.point", kXyz, "m", "W", kPointQuantum});
  add({"contacts.normal", kXyz, "-", "W", kNormalQuantum});
  add({"contacts.force", kXyz, "N", "W", kForceQuantum});
  add({"contacts.gap", {"gap"}, "m", "", kGapQuantum});
  add({"contacts.state", {"state"}, "", "", 1.0});
  return channels;
}

std::array<std::int64_t, 11> quantised(const record::ContactSample& contact) {
  std::array<std::int64_t, 11> row{};
  for (int i = 0; i < 3; ++i) {
    const auto at = static_cast<std::size_t>(i);
    row[at] = in_quanta(contact.p_WQ[i], kPointQuantum);
    row[at + 3] = in_quanta(contact.n_AB_W[i], kNormalQuantum);
    row[at + 6] = in_quanta(contact.force_B_W[i], kForceQuantum);
  }
  row[9] = in_quanta(contact.phi, kGapQuantum);
  row[10] = static_cast<std::int64_t>(contact.state);
  return row;
}

}  // namespace

ContactCoder::ContactCoder() : channels_(contact_channels()) {}

int ContactCoder::find_or_add(std::pair<int, int> bodies, const Block& block) {
  const auto known = last_.find(bodies);
  if (known != last_.end() && known->second.second == block) return known->second.first;
  const int index = static_cast<int>(block_rows_++);
  channels_[kBlockBody].put({static_cast<double>(bodies.first), static_cast<double>(bodies.second)});
  channels_[kBlockFirst].put({static_cast<double>(point_rows_)});
  channels_[kBlockCount].put({static_cast<double>(block.size())});
  for (const std::array<std::int64_t, 11>& row : block) {
    const auto put = [&](ContactChannel channel, std::size_t first, double quantum) {
      channels_[channel].put({from_quanta(row[first], quantum), from_quanta(row[first + 1], quantum),
                              from_quanta(row[first + 2], quantum)});
    };
    put(kPoint, 0, kPointQuantum);
    put(kNormal, 3, kNormalQuantum);
    put(kForce, 6, kForceQuantum);
    channels_[kGap].put({from_quanta(row[9], kGapQuantum)});
    channels_[kState].put({static_cast<double>(row[10])});
  }
  point_rows_ += block.size();
  last_[bodies] = {index, block};
  return index;
}

void ContactCoder::add(const std::vector<record::ContactSample>& contacts) {
  std::vector<int> blocks;
  Block block;
  for (std::size_t i = 0; i < contacts.size();) {
    const std::pair<int, int> bodies(contacts[i].body_a, contacts[i].body_b);
    block.clear();
    for (; i < contacts.size() && std::pair(contacts[i].body_a, contacts[i].body_b) == bodies; ++i) {
      block.push_back(quantised(contacts[i]));
    }
    blocks.push_back(find_or_add(bodies, block));
  }
  if (blocks != last_frame_) {
    last_first_ = frame_block_rows_;
    frame_block_rows_ += blocks.size();
    for (const int index : blocks) channels_[kFrameBlock].put({static_cast<double>(index)});
    last_frame_ = std::move(blocks);
  }
  channels_[kFrameFirst].put({static_cast<double>(last_first_)});
  channels_[kFrameCount].put({static_cast<double>(last_frame_.size())});
}

void ContactCoder::move_to(std::vector<ChannelWriter>& channels) {
  for (ChannelWriter& channel : channels_) channels.push_back(std::move(channel));
  *this = ContactCoder();
}

FrameCoder::FrameCoder(const record::RecordingHeader& header)
    : channels_(fixed_channels()), hold_use_(header), first_body_channel_(channels_.size()) {
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    const std::string prefix = "body." + std::to_string(i);
    kinds_.push_back(header.bodies[i].kind);
    channels_.emplace_back(ChannelSpec{prefix + ".pose", kPoseColumns, "m, -", "W", kPoseQuantum, Encoding::Delta});
    channels_.emplace_back(ChannelSpec{prefix + ".present", {"present"}, "", "", 1.0, Encoding::Delta});
  }
  first_joint_channel_ = channels_.size();
  if (header.joints.empty()) return;
  channels_.emplace_back(ChannelSpec{"joints.position", header.joints, "rad", "", kJointQuantum, Encoding::Delta});
  channels_.emplace_back(ChannelSpec{"joints.velocity", header.joints, "rad/s", "", kTwistQuantum, Encoding::Delta});
  channels_.emplace_back(ChannelSpec{"joints.torque", header.joints, "Nm", "", kTorqueQuantum, Encoding::Delta});
}

void FrameCoder::put_pose(std::size_t channel, const record::PoseSample& X) {
  Quaternion quat = X.quat;
  const auto [last, is_new] = last_quat_.try_emplace(channel, quat);
  if (quat.coeffs().allFinite()) {
    const bool is_first = is_new || !last->second.coeffs().allFinite();
    if (is_first ? quat.w() < 0.0 : quat.dot(last->second) < 0.0) quat.coeffs() = -quat.coeffs();
    last->second = quat;
  }
  channels_[channel].put({X.p.x(), X.p.y(), X.p.z(), quat.w(), quat.x(), quat.y(), quat.z()});
}

void FrameCoder::put_tool(const record::Frame& frame) {
  const record::CupSample& cup = frame.cup;
  channels_[kTime].put({frame.time});
  channels_[kProgramRow].put({static_cast<double>(frame.program_row)});
  put_pose(kToolPose, frame.X_WE);
  put_pose(kToolPoseCommand, frame.X_WE_command);
  channels_[kToolTwist].put(row_of(frame.V_WE.linear, frame.V_WE.angular));
  channels_[kCupCommand].put({cup.vacuum_command ? 1.0 : 0.0, cup.blow_off_command ? 1.0 : 0.0});
  channels_[kCupPressure].put({cup.pressure_gauge});
  channels_[kCupAttached].put({static_cast<double>(cup.attached_body)});
  if (cup.attached_body >= 0) {
    put_pose(kCupPose, cup.X_ES);
    channels_[kCupDeformation].put({cup.length, cup.bend});
  } else {
    channels_[kCupPose].put({kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
    channels_[kCupDeformation].put({kNaN, kNaN});
  }
  channels_[kCupWrench].put(row_of(cup.F_PSo_S.force, cup.F_PSo_S.torque));
  channels_[kHoldUse].put({hold_use_.next(frame)});
  channels_[kFlangeWrench].put(row_of(frame.F_flange.force, frame.F_flange.torque));
  channels_[kSolverResidual].put({frame.solver.residual});
  channels_[kSolverIterations].put({static_cast<double>(frame.solver.iterations)});
  channels_[kSolverStatus].put({static_cast<double>(frame.solver.status)});
}

void FrameCoder::put_bodies(const record::Frame& frame) {
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    if (kinds_[i] == record::BodyKind::Static) continue;
    const record::BodySample& body = frame.bodies[i];
    const std::size_t channel = first_body_channel_ + 2 * i;
    if (body.present) {
      put_pose(channel, body.X_WB);
    } else {
      channels_[channel].put({kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN});
    }
    channels_[channel + 1].put({body.present ? 1.0 : 0.0});
  }
}

void FrameCoder::put_joints(const record::Frame& frame) {
  if (first_joint_channel_ == channels_.size()) return;
  std::vector<double> row(frame.joints.size());
  std::size_t channel = first_joint_channel_;
  for (const auto part :
       {&record::JointSample::position, &record::JointSample::velocity, &record::JointSample::torque}) {
    std::transform(frame.joints.begin(), frame.joints.end(), row.begin(), std::mem_fn(part));
    channels_[channel++].put(row);
  }
}

void FrameCoder::set_static(const record::Frame& frame) {
  SNUG_CHECK(frame.bodies.size() == kinds_.size(), "a frame must have the bodies of the header");
  if (has_static_) return;
  has_static_ = true;
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    if (kinds_[i] == record::BodyKind::Static) put_pose(first_body_channel_ + 2 * i, frame.bodies[i].X_WB);
  }
}

void FrameCoder::add(const record::Frame& frame) {
  set_static(frame);
  put_tool(frame);
  put_bodies(frame);
  put_joints(frame);
  contacts_.add(frame.contacts);
  ++frames_;
}

std::vector<ChannelWriter> FrameCoder::finish() {
  std::vector<ChannelWriter> channels, fresh;
  fresh.reserve(channels_.size());
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    fresh.emplace_back(channels_[i].spec());
    const bool is_presence = i >= first_body_channel_ && i < first_joint_channel_ && (i - first_body_channel_) % 2 == 1;
    if (is_presence && kinds_[(i - first_body_channel_) / 2] == record::BodyKind::Static) continue;
    channels.push_back(std::move(channels_[i]));
  }
  contacts_.move_to(channels);
  channels_ = std::move(fresh);
  last_quat_.clear();
  frames_ = 0;
  has_static_ = false;
  return channels;
}

}  // namespace snug::replay
