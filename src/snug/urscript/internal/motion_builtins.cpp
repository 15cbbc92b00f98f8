// Moves, waits, forces.
#include <fmt/format.h>

#include <cmath>

#include "snug/urscript/internal/builtins.hpp"

namespace snug::urscript::internal {
namespace {

constexpr double kLongestSleep = 86400.0;  // s

void need_motion(const CallContext& call) {
  if (!call.may_move) throw Fault{"a secondary program moves nothing"};
}

Joints joints_arg(const CallContext& call, std::size_t index) { return six_of(call.arguments[index], "the joints"); }

/// The joints of a target that is joints or a pose of the TCP.
Joints target_joints(const CallContext& call) {
  const Value& target = call.arguments[0];
  if (target.kind != Value::Kind::Pose) return joints_arg(call, 0);
  const std::optional<Joints> q =
      call.host.inverse(pose_of(target, "the target") * call.host.state().X_FE.inverse(), call.host.state().target.q);
  if (!q) throw Fault{"the arm does not reach the target"};
  return *q;
}
Pose target_pose(const CallContext& call, std::size_t index) {
  const Value& target = call.arguments[index];
  if (target.kind == Value::Kind::Pose) return pose_of(target, "the target");
  return call.host.forward(joints_arg(call, index)) * call.host.state().X_FE;
}

Value until_done(CallContext& call) {
  call.wait = [](CallContext& later, Value&) { return later.motion.may_go_on(); };
  return {};
}

Value move_joints(CallContext& call) {
  need_motion(call);
  call.motion.move_joints(call.host, target_joints(call),
                          {call.number(1, 1.4), call.number(2, 1.05), call.number(3, 0.0), call.number(4, 0.0)});
  return until_done(call);
}
Value move_line(CallContext& call) {
  need_motion(call);
  call.motion.move_line(call.host, target_pose(call, 0),
                        {call.number(1, 1.2), call.number(2, 0.25), call.number(3, 0.0), call.number(4, 0.0)});
  return until_done(call);
}
Value move_process(CallContext& call) {
  need_motion(call);
  call.motion.move_line(call.host, target_pose(call, 0),
                        {call.number(1, 1.2), call.number(2, 0.25), 0.0, call.number(3, 0.0)});
  return until_done(call);
}
Value move_arc(CallContext& call) {
  need_motion(call);
  call.motion.move_arc(call.host, target_pose(call, 0), target_pose(call, 1),
                       {call.number(2, 1.2), call.number(3, 0.25), 0.0, call.number(4, 0.0)});
  return until_done(call);
}
/// Until this time of motions (Motion::begin_call): where the slider is slow, it comes later.
Value until_passed(CallContext& call, double end) {
  call.wait = [end](CallContext& later, Value&) { return later.motion.has_passed(end); };
  return {};
}
Value servo(CallContext& call) {
  need_motion(call);
  const double duration = std::max(call.number(3, call.host.period()), call.host.period());
  return until_passed(call, call.motion.servo(call.host, joints_arg(call, 0), duration));
}

/// Returns after the time, or, where there is none, when the speed is reached.
Value speed_joints(CallContext& call) {
  need_motion(call);
  const Joints speed = joints_arg(call, 0);
  call.motion.speed_joints(call.host, speed, call.number(1, 1.4));
  const double duration = call.number(2, 0.0);
  if (duration > 0.0) return until_passed(call, call.motion.begin_call(call.host, duration));
  call.wait = [speed](CallContext& later, Value&) { return later.motion.has_speed(speed); };
  return {};
}
Value speed_tool(CallContext& call) {
  need_motion(call);
  call.motion.speed_tool(six_of(call.arguments[0], "the speed"), call.number(1, 1.2));
  const double duration = std::max(call.number(2, call.host.period()), call.host.period());
  return until_passed(call, call.motion.begin_call(call.host, duration));
}
Value brake(CallContext& call, double acceleration) {
  need_motion(call);
  call.motion.brake(call.host, acceleration);
  call.wait = [](CallContext& later, Value&) { return later.motion.is_still(); };
  return {};
}

Value sleep(CallContext& call) {
  const double seconds = number_of(call.arguments[0], "the time");
  if (!(seconds >= 0.0) || seconds > kLongestSleep) throw Fault{"a time below 0 or above a day"};
  call.wait = [end = call.time + seconds](CallContext& later, Value&) { return later.time >= end - 1e-9; };
  return {};
}
Value sync(CallContext& call) {
  call.wait = [now = call.period](CallContext& later, Value&) { return later.period > now; };
  return {};
}

Value force_mode(CallContext& call) {
  need_motion(call);
  ForceMode mode;
  mode.X_BaseT = pose_of(call.arguments[0], "the frame");
  const auto chosen = six_of(call.arguments[1], "the selection"), wrench = six_of(call.arguments[2], "the force");
  const double type = number_of(call.arguments[3], "the type");
  const auto limits = six_of(call.arguments[4], "the limits");
  if (type != 1.0 && type != 2.0 && type != 3.0) throw Fault{"a type that is not 1, 2 or 3"};
  if (type == 1.0) throw Fault{"force_mode of type 1, a frame that turns to the TCP, is not there"};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    mode.is_compliant[i] = chosen[i] != 0.0;
    mode.is_compliant_about[i] = chosen[i + 3] != 0.0;
    mode.force[axis] = wrench[i];
    mode.torque[axis] = wrench[i + 3];
    mode.speed[axis] = std::clamp(std::abs(limits[i]), 0.0, 0.25);
    mode.angular_speed[axis] = std::clamp(std::abs(limits[i + 3]), 0.0, 0.5);
  }
  call.motion.start_force(mode);
  return Value::of(true);
}

/// Periods since the tool pushes against something in this direction, all directions where it is zero.
Value tool_contact(CallContext& call) {
  constexpr double kTouch = 10.0;  // N
  const Vector3 force = call.host.state().F_Eo_Base.force;
  Vector3 direction = Vector3::Zero();
  if (call.has(0)) {
    const auto six = six_of(call.arguments[0], "the direction");
    direction = Vector3(six[0], six[1], six[2]);
  }
  const double length = direction.norm();
  const double felt = length > 0.0 ? -force.dot(direction) / length : force.norm();
  return Value::of(felt > kTouch ? 1 : 0);
}

const Builtin kMotion[] = {
    {"movej", "q a v t r", 1, move_joints},
    {"movel", "pose a v t r", 1, move_line},
    {"movep", "pose a v r", 1, move_process},
    {"movec", "pose_via pose_to a v r mode", 2, move_arc},
    {"optimovej", "q a v r", 1,
     [](CallContext& c) {
       c.arguments = {c.arguments[0], {}, {}, {}, c.arguments[3]};
       return move_joints(c);
     }},
    {"optimovel", "pose a v r", 1,
     [](CallContext& c) {
       c.arguments = {c.arguments[0], {}, {}, {}, c.arguments[3]};
       return move_line(c);
     }},
    {"servoj", "q a v t lookahead_time gain", 1, servo},
    {"servoc", "pose a v r", 1, move_process},
    {"speedj", "qd a t", 1, speed_joints},
    {"speedl", "xd a t aRot", 1, speed_tool},
    {"stopj", "a", 0, [](CallContext& c) { return brake(c, c.number(0, 2.0)); }},
    {"stopl", "a aRot", 0, [](CallContext& c) { return brake(c, 5.0 * c.number(0, 1.2)); }},
    {"sleep", "t", 1, sleep},
    {"sync", "", 0, sync},
    {"force_mode", "task_frame selection_vector wrench type limits", 5, force_mode},
    {"end_force_mode", "", 0,
     [](CallContext& c) {
       need_motion(c);
       c.motion.end_force(c.host);
       return Value{};
     }},
    {"tool_contact", "direction", 0, tool_contact},
};

}  // namespace

std::span<const Builtin> motion_builtins() { return kMotion; }

}  // namespace snug::urscript::internal
