// Motion: where the joints of a controller's arm are to be, period by period.
#pragma once

#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "snug/urscript/host.hpp"

namespace snug::urscript::internal {

/// What a move may take: speed and acceleration of the leading joint (rad) or of the tool (m), or a duration; the
/// radius of its blend with the next one.
struct MoveSettings {
  double acceleration = 1.4;
  double speed = 1.05;
  double duration = 0.0;  ///< s; 0: by speed and acceleration
  double blend = 0.0;     ///< m
};

/// Pushes of force_mode: in these directions of the frame the tool moves and turns until force and torque are met.
struct ForceMode {
  Pose X_BaseT;
  std::array<bool, 3> is_compliant{};        ///< along the axes of T
  std::array<bool, 3> is_compliant_about{};  ///< about the axes of T, through the TCP
  Vector3 force = Vector3::Zero();           ///< N, of the tool on its surroundings, in the axes of T
  Vector3 torque = Vector3::Zero();          ///< Nm, of the same, about the TCP
  Vector3 speed = Vector3::Zero();           ///< m/s, at most
  Vector3 angular_speed = Vector3::Zero();   ///< rad/s, at most
};

/// Moves are paths of joints, sampled each period, that end at rest. A move that begins while another one still goes to
/// its end is added to what is left of that one: so blends are continuous in position and speed. All throw Fault where
/// the arm does not reach, step() where a joint would be too fast or beyond its range: then the target stays. Where a
/// controller would stop for protection, the Fault says so.
/// Time of motions passes as the slider lets it: at 25 % a move, a servo time and an acceleration take four times as
/// long. To brake takes what it says at any slider.
class Motion {
 public:
  void move_joints(const Host& host, const Joints& to, const MoveSettings& settings);
  void move_line(const Host& host, const Pose& X_BaseE, const MoveSettings& settings);
  /// Through `via` to `to`; turns evenly from the beginning to the end.
  void move_arc(const Host& host, const Pose& via, const Pose& to, const MoveSettings& settings);
  /// Straight in joints, in this time of motions, at the speed that it takes. The end: begin_call().
  double servo(const Host& host, const Joints& to, double duration);
  /// An acceleration of 0 keeps the speed: programs that divide a change of speed by its time ask for that.
  void speed_joints(const Host& host, const Joints& speed, double acceleration);
  /// m/s and rad/s of the TCP in Base.
  void speed_tool(const std::array<double, 6>& speed, double acceleration);
  /// The end, in periods of motion, of a call that lasts `duration` s of it. What the call before it, if it has just
  /// ended, took too long or not long enough counts: calls in a row take their sum.
  double begin_call(const Host& host, double duration);
  [[nodiscard]] bool has_passed(double end) const;
  void brake(const Host& host, double acceleration);
  /// By what every joint can.
  void brake(const Host& host);
  /// Stands at once.
  void stop(const Host& host);
  void start_force(const ForceMode& mode) { force_ = mode; }
  void end_force(const Host& host);

  /// Whether the next move may begin: the last one has ended, or is within its blend.
  [[nodiscard]] bool may_go_on() const;
  [[nodiscard]] bool is_still() const { return moves_.empty() && mode_ == Mode::Path; }
  [[nodiscard]] bool has_speed(const Joints& speed) const;
  /// `share`: of a period that passes for moves, 0 .. 1. Writes the host's target.
  void step(Host& host, double share);

 private:
  enum class Mode { Path, JointSpeed, ToolSpeed };
  struct Move {
    std::vector<Joints> way;  ///< at each period, less its end
    double time = 0.0;        ///< periods
    double blend_from = 0.0;  ///< periods
    bool is_brake = false;    ///< whatever the slider says
  };
  using At = std::function<Joints(double share)>;

  [[nodiscard]] Joints end_of(const Host& host);
  void add(const Host& host, const std::vector<Joints>& way, double blend_from);
  /// A path over shares of its length, `length` long; `joints_at` throws.
  void follow(const Host& host, double length, const MoveSettings& settings, double distance_per_length,
              const At& joints_at);
  [[nodiscard]] Joints path_now() const;
  void return_to_path(Host& host);
  void push(const Host& host, Joints& q);

  Mode mode_ = Mode::Path;
  std::deque<Move> moves_;
  std::optional<Joints> end_;  ///< where all moves end; none: where the host's target stands
  bool is_servo_ = false;      ///< the path ends with speed
  double clock_ = 0.0;         ///< periods of motion so far
  double call_end_ = 0.0;      ///< of the last call, periods of motion
  double share_ = 1.0;         ///< of the last period that passed for motions
  Joints speed_{};             ///< JointSpeed: now, where the slider is full; rad/s
  Joints wanted_speed_{};
  std::array<double, 6> tool_speed_{}, wanted_tool_speed_{};
  double acceleration_ = 1.0;
  Joints written_{};  ///< the last target
  bool has_written_ = false;
  std::optional<ForceMode> force_;
  Vector3 pushed_ = Vector3::Zero();      ///< m, in Base
  Matrix3 turned_ = Matrix3::Identity();  ///< about the TCP, in Base
};

}  // namespace snug::urscript::internal
