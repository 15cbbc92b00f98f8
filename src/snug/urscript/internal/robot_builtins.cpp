// What a program asks of the robot and tells it: joints, TCP, payload, kinematics.
#include <fmt/format.h>

#include <cmath>

#include "snug/urscript/internal/builtins.hpp"

namespace snug::urscript::internal {
namespace {

Value six(const Wrench& wrench) {
  const Vector6 f = as_vector(wrench);
  return Value::list(std::array{f[0], f[1], f[2], f[3], f[4], f[5]});
}
Pose tcp_of(const CallContext& call, const Joints& q) { return call.host.forward(q) * call.host.state().X_FE; }

/// m/s and rad/s in Base, by a difference over a millionth of a second.
Value tcp_speed(const CallContext& call, const Joints& q, const Joints& qd) {
  constexpr double kStep = 1e-6;  // s
  Joints next{};
  for (std::size_t j = 0; j < kJoints; ++j) next[j] = q[j] + kStep * qd[j];
  const Pose a = tcp_of(call, q), b = tcp_of(call, next);
  const Vector3 v = (b.p - a.p) / kStep, w = log_rotation(b.R * a.R.transpose()) / kStep;
  return Value::list(std::array{v.x(), v.y(), v.z(), w.x(), w.y(), w.z()});
}

Vector3 three(const Value& value, const char* what) {
  if (!value.is_list() || value.items.size() < 3) throw Fault{fmt::format("{} is not three numbers", what)};
  return {number_of(value.items[0], what), number_of(value.items[1], what), number_of(value.items[2], what)};
}

std::optional<Joints> solve(CallContext& call) {
  const Pose X_FE = call.has(4) ? pose_of(call.arguments[4], "the TCP") : call.host.state().X_FE;
  const Joints near = call.has(1) ? six_of(call.arguments[1], "qnear") : call.host.state().target.q;
  return call.host.inverse(pose_of(call.arguments[0], "the pose") * X_FE.inverse(), near);
}

Value set_payload(CallContext& call) {
  Payload& payload = call.host.state().payload;
  const double mass = number_of(call.arguments[0], "the mass");
  if (!(mass >= 0.0 && mass <= 1000.0)) throw Fault{"a mass below 0 or above 1000 kg"};
  payload.mass = mass;
  if (call.has(1)) payload.com_F = three(call.arguments[1], "the centre of mass");
  payload.inertia_F = {};
  if (call.arguments.size() > 2 && call.has(2)) payload.inertia_F = six_of(call.arguments[2], "the inertia");
  return {};
}

Value no_effect(CallContext&) { return {}; }
Value not_there(CallContext&) {
  throw Fault{"the simulated arm has no such mode: it is moved by its joints' positions only"};
}

const Builtin kRobot[] = {
    {"get_actual_joint_positions", "", 0, [](CallContext& c) { return Value::list(c.host.state().q); }},
    {"get_joint_positions", "", 0, [](CallContext& c) { return Value::list(c.host.state().q); }},  // its former name
    {"get_actual_joint_positions_history", "steps", 0, [](CallContext& c) { return Value::list(c.host.state().q); }},
    {"get_actual_joint_speeds", "", 0, [](CallContext& c) { return Value::list(c.host.state().qd); }},
    {"get_target_joint_positions", "", 0, [](CallContext& c) { return Value::list(c.host.state().target.q); }},
    {"get_target_joint_speeds", "", 0, [](CallContext& c) { return Value::list(c.host.state().target.qd); }},
    {"get_target_joint_accelerations", "", 0, [](CallContext& c) { return Value::list(c.host.state().target.qdd); }},
    {"get_actual_tcp_pose", "", 0, [](CallContext& c) { return Value::of(tcp_of(c, c.host.state().q)); }},
    {"get_target_tcp_pose", "", 0, [](CallContext& c) { return Value::of(tcp_of(c, c.host.state().target.q)); }},
    {"get_target_waypoint", "", 0, [](CallContext& c) { return Value::of(tcp_of(c, c.host.state().target.q)); }},
    {"get_actual_tool_flange_pose", "", 0, [](CallContext& c) { return Value::of(c.host.forward(c.host.state().q)); }},
    {"get_actual_tcp_speed", "", 0, [](CallContext& c) { return tcp_speed(c, c.host.state().q, c.host.state().qd); }},
    {"get_target_tcp_speed", "", 0,
     [](CallContext& c) { return tcp_speed(c, c.host.state().target.q, c.host.state().target.qd); }},
    {"get_tcp_force", "", 0, [](CallContext& c) { return six(c.host.state().F_Eo_Base); }},
    {"force", "", 0, [](CallContext& c) { return Value::of(c.host.state().F_Eo_Base.force.norm()); }},
    {"get_tcp_offset", "", 0, [](CallContext& c) { return Value::of(c.host.state().X_FE); }},
    {"get_steptime", "", 0, [](CallContext& c) { return Value::of(c.host.period()); }},
    {"is_steady", "", 0,
     [](CallContext& c) {
       double most = 0.0;
       for (const double speed : c.host.state().qd) most = std::max(most, std::abs(speed));
       return Value::of(most < 1e-3);
     }},
    {"is_within_safety_limits", "pose", 1,
     [](CallContext& c) {
       if (c.arguments[0].kind == Value::Kind::Pose) {
         c.arguments.resize(5);
         return Value::of(solve(c).has_value());
       }
       const Joints q = six_of(c.arguments[0], "the joints");
       bool is_within = true;
       for (std::size_t j = 0; j < kJoints; ++j)
         is_within = is_within && q[j] >= c.host.limits().lower[j] && q[j] <= c.host.limits().upper[j];
       return Value::of(is_within);
     }},
    {"get_inverse_kin", "x qnear maxPositionError maxOrientationError tcp", 1,
     [](CallContext& c) {
       const std::optional<Joints> q = solve(c);
       if (!q) throw Fault{"no inverse kinematics: the pose is out of reach"};
       return Value::list(*q);
     }},
    {"get_inverse_kin_has_solution", "x qnear maxPositionError maxOrientationError tcp", 1,
     [](CallContext& c) { return Value::of(solve(c).has_value()); }},
    {"get_forward_kin", "q tcp", 0,
     [](CallContext& c) {
       const Joints q = c.has(0) ? six_of(c.arguments[0], "the joints") : c.host.state().q;
       return Value::of(c.host.forward(q) * (c.has(1) ? pose_of(c.arguments[1], "the TCP") : c.host.state().X_FE));
     }},
    {"set_tcp", "pose tcp_name", 1,
     [](CallContext& c) {
       c.host.state().X_FE = pose_of(c.arguments[0], "the TCP");
       return Value{};
     }},
    {"set_payload", "m cog", 1, set_payload},
    {"set_target_payload", "m cog inertia transition_time", 1, set_payload},
    {"set_payload_mass", "m", 1,
     [](CallContext& c) {
       c.arguments.resize(2);
       return set_payload(c);
     }},
    {"set_payload_cog", "cog", 1,
     [](CallContext& c) {
       c.host.state().payload.com_F = three(c.arguments[0], "the centre of mass");
       return Value{};
     }},
    {"get_target_payload", "", 0, [](CallContext& c) { return Value::of(c.host.state().payload.mass); }},
    {"get_target_payload_cog", "", 0,
     [](CallContext& c) {
       const Vector3& com = c.host.state().payload.com_F;
       return Value::list(std::array{com.x(), com.y(), com.z()});
     }},
    {"get_target_payload_inertia", "", 0, [](CallContext& c) { return Value::list(c.host.state().payload.inertia_F); }},
    {"set_gravity", "d", 1,
     [](CallContext& c) {
       c.host.state().gravity_Base = three(c.arguments[0], "gravity");
       return Value{};
     }},
    {"set_tool_voltage", "voltage", 1,
     [](CallContext& c) {
       const double voltage = number_of(c.arguments[0], "the voltage");
       if (voltage != 0.0 && voltage != 12.0 && voltage != 24.0) throw Fault{"a voltage that is not 0, 12 or 24"};
       c.host.state().tool_voltage = static_cast<int>(voltage);
       return Value{};
     }},
    // Nobody takes the simulated arm by the hand: it stands.
    {"teach_mode", "", 0, no_effect},
    {"end_teach_mode", "", 0, no_effect},
    {"freedrive_mode", "freeAxes feature", 0, no_effect},
    {"end_freedrive_mode", "", 0, no_effect},
    {"direct_torque", "torque friction_comp", 1, not_there},
    {"get_joint_torques", "", 0, not_there},
    {"protective_stop", "", 0,
     [](CallContext& c) {
       c.host.state().wants_protective_stop = true;
       c.host.state().stop_reason.clear();
       return Value{};
     }},
    // The simulated sensor needs none of these.
    {"zero_ftsensor", "", 0, no_effect},
    {"force_mode_set_damping", "damping", 1, no_effect},
    {"force_mode_set_gain_scaling", "scaling", 1, no_effect},
    {"ft_rtde_input_enable", "enable sensor_mass sensor_measuring_offset sensor_cog", 1, no_effect},
    {"enable_external_ft_sensor", "enable sensor_mass sensor_measuring_offset sensor_cog", 1, no_effect},
    {"set_friction_scales", "viscous_scale coulomb_scale", 0, no_effect},
};

}  // namespace

std::span<const Builtin> robot_builtins() { return kRobot; }

}  // namespace snug::urscript::internal
