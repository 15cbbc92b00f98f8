// Motion: trapezoids over joints, lines and arcs; sums of moves where they blend.
#include "snug/urscript/internal/motion.hpp"

#include <algorithm>
#include <cmath>

#include "snug/urscript/internal/value.hpp"

namespace snug::urscript::internal {
namespace {

constexpr double kLongestMove = 120.0;  // s
constexpr double kSmall = 1e-9;         // m or rad: no way
constexpr double kForceGain = 4e-4;     // m/s for each newton that is missing
constexpr double kTorqueGain = 0.02;    // rad/s for each newton metre that is missing
constexpr double kReturnSpeed = 0.1;    // of what a joint may do
constexpr double kTolerance = 1e-6;     // rad, and share of a speed
constexpr double kLeastServo = 0.5;     // of a period: the rest of a time that gets a period of its own
constexpr double kSamePeriod = 1e-9;    // of a period

Joints plus(const Joints& a, const Joints& b, double factor) {
  Joints sum{};
  for (std::size_t j = 0; j < kJoints; ++j) sum[j] = a[j] + factor * b[j];
  return sum;
}
double largest(const Joints& a) {
  double most = 0.0;
  for (const double x : a) most = std::max(most, std::abs(x));
  return most;
}

/// A way of length L from rest to rest.
struct Trapezoid {
  double acceleration = 0.0, speed = 0.0, length = 0.0, duration = 0.0;
  Trapezoid(double way, const MoveSettings& settings) : acceleration(settings.acceleration), length(way) {
    if (settings.duration > 0.0) {
      duration = settings.duration;
      acceleration = std::max(acceleration, 4.0 * way / (duration * duration));
      const double root = std::sqrt(std::max(0.0, duration * duration - 4.0 * way / acceleration));
      speed = 0.5 * acceleration * (duration - root);
      return;
    }
    speed = std::min(settings.speed, std::sqrt(way * acceleration));
    duration = way / speed + speed / acceleration;
  }
  /// Share of the way at a time; a time before or after stands.
  [[nodiscard]] double share_at(double time) const {
    const double ramp = speed / acceleration;
    if (time <= 0.0) return 0.0;
    if (time >= duration) return 1.0;
    if (time < ramp) return 0.5 * acceleration * time * time / length;
    if (time > duration - ramp) return 1.0 - 0.5 * acceleration * (duration - time) * (duration - time) / length;
    return speed * (time - 0.5 * ramp) / length;
  }
};

void check(const MoveSettings& settings) {
  const auto is_good = [](double x) { return std::isfinite(x) && x > 0.0; };
  if (!is_good(settings.acceleration)) throw Fault{"an acceleration that is not positive"};
  if (!is_good(settings.speed) && !(settings.duration > 0.0)) throw Fault{"a speed that is not positive"};
  if (!(settings.duration >= 0.0) || settings.duration > kLongestMove) throw Fault{"a duration below 0 or above 120 s"};
  if (!(settings.blend >= 0.0)) throw Fault{"a blend radius below 0"};
}

}  // namespace

Joints Motion::end_of(const Host& host) {
  if (mode_ != Mode::Path) brake(host);
  if (!end_) end_ = host.state().target.q;
  return *end_;
}

void Motion::add(const Host& /*host*/, const std::vector<Joints>& way, double blend_from) {
  Move move;
  move.blend_from = blend_from;
  move.way.reserve(way.size());
  for (const Joints& q : way) move.way.push_back(plus(q, way.back(), -1.0));
  moves_.push_back(std::move(move));
  is_servo_ = false;
  end_ = way.back();
}

void Motion::follow(const Host& host, double length, const MoveSettings& settings, double distance_per_length,
                    const At& joints_at) {
  check(settings);
  const double dt = host.period();
  MoveSettings used = settings;
  std::vector<Joints> way;
  double blend_from = 0.0;
  // A joint that would be too fast makes all of the move slower; a slower one shows more of the way between its steps.
  constexpr int kRounds = 10;
  for (int round = 0; round < kRounds; ++round) {
    const Trapezoid profile(length, used);
    if (profile.duration > kLongestMove) throw Fault{"a move of more than 120 s"};
    const auto count = static_cast<std::size_t>(std::ceil(profile.duration / dt - 1e-9));
    way.assign(1, joints_at(0.0));
    blend_from = static_cast<double>(count);
    double fastest = 0.0;  // of what is allowed
    for (std::size_t k = 1; k <= count; ++k) {
      const double share = k == count ? 1.0 : profile.share_at(static_cast<double>(k) * dt);
      way.push_back(joints_at(share));
      for (std::size_t j = 0; j < kJoints; ++j) {
        const double speed = std::abs(way[k][j] - way[k - 1][j]) / dt;
        fastest = std::max(fastest, speed / host.limits().max_speed[j]);
      }
      const bool is_near = (1.0 - share) * length * distance_per_length <= settings.blend && 2 * k >= count;
      if (settings.blend > 0.0 && is_near) blend_from = std::min(blend_from, static_cast<double>(k));
    }
    if (fastest <= 1.0 + 1e-6) break;
    used.duration = profile.duration * fastest * 1.001;
    used.acceleration = std::max(kSmall, settings.acceleration / (fastest * fastest));
  }
  add(host, way, blend_from);
}

void Motion::move_joints(const Host& host, const Joints& to, const MoveSettings& settings) {
  check(settings);
  const Joints from = end_of(host), way = plus(to, from, -1.0);
  const double length = largest(way);
  if (length < kSmall) return;
  for (std::size_t j = 0; j < kJoints; ++j)
    if (!(to[j] >= host.limits().lower[j] - 1e-6 && to[j] <= host.limits().upper[j] + 1e-6))
      throw Fault{"joint " + std::to_string(j) + " would be beyond its limit"};
  const double distance = settings.blend > 0.0 ? (host.forward(to).p - host.forward(from).p).norm() / length : 0.0;
  follow(host, length, settings, distance, [&](double share) { return plus(from, way, share); });
}

void Motion::move_line(const Host& host, const Pose& X_BaseE, const MoveSettings& settings) {
  const Joints from = end_of(host);
  const Pose X_EF = host.state().X_FE.inverse();
  const Pose begin = host.forward(from) * host.state().X_FE;
  const Vector3 way = X_BaseE.p - begin.p, turn = log_rotation(begin.R.transpose() * X_BaseE.R);
  const double distance = way.norm(), angle = turn.norm();
  if (distance < kSmall && angle < kSmall) return;
  const double length = distance > 1e-6 ? distance : angle;
  Joints near = from;
  follow(host, length, settings, 1.0, [&](double share) {
    if (share == 0.0) near = from;
    if (share == 0.0) return from;
    const Pose pose{begin.R * exp_rotation(share * turn), begin.p + share * way};
    const std::optional<Joints> q = host.inverse(pose * X_EF, near);
    if (!q) throw Fault{"the arm does not reach a pose on the way", true};
    return near = *q;
  });
}

void Motion::move_arc(const Host& host, const Pose& via, const Pose& to, const MoveSettings& settings) {
  const Joints from = end_of(host);
  const Pose X_EF = host.state().X_FE.inverse();
  const Pose begin = host.forward(from) * host.state().X_FE;
  const Vector3 a = via.p - begin.p, b = to.p - begin.p, normal = a.cross(b);
  if (normal.norm() < 1e-9 * std::max(1e-6, a.norm() * b.norm())) return move_line(host, to, settings);
  const double square = normal.squaredNorm();
  const Vector3 middle =
      begin.p + (a.squaredNorm() * b.cross(normal) - b.squaredNorm() * a.cross(normal)) / (2.0 * square);
  const Vector3 axis = normal.normalized(), radius = begin.p - middle;
  const Vector3 last = to.p - middle;
  double angle = std::atan2(axis.dot(radius.cross(last)), radius.dot(last));
  if (angle <= 0.0) angle += 2.0 * 3.14159265358979323846;
  const Vector3 turn = log_rotation(begin.R.transpose() * to.R);
  Joints near = from;
  follow(host, angle * radius.norm(), settings, 1.0, [&](double share) {
    if (share == 0.0) near = from;
    if (share == 0.0) return from;
    const Pose pose{begin.R * exp_rotation(share * turn), middle + exp_rotation(share * angle * axis) * radius};
    const std::optional<Joints> q = host.inverse(pose * X_EF, near);
    if (!q) throw Fault{"the arm does not reach a pose on the way", true};
    return near = *q;
  });
}

double Motion::servo(const Host& host, const Joints& to, double duration) {
  if (!(duration > 0.0) || duration > kLongestMove) throw Fault{"a time that is not positive"};
  const Joints from = host.state().target.q;
  mode_ = Mode::Path;
  moves_.clear();
  const double end = begin_call(host, duration);
  const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil(end - clock_ - kLeastServo - kSamePeriod)));
  std::vector<Joints> way;
  for (std::size_t k = 0; k <= count; ++k)
    way.push_back(plus(from, plus(to, from, -1.0), static_cast<double>(k) / static_cast<double>(count)));
  way.back() = to;
  add(host, way, static_cast<double>(count));
  is_servo_ = true;
  return end;
}

double Motion::begin_call(const Host& host, double duration) {
  const double half = kLeastServo * share_ + kSamePeriod;
  const double begin = std::abs(clock_ - call_end_) <= half ? call_end_ : clock_;
  return call_end_ = begin + duration / host.period();
}

bool Motion::has_passed(double end) const { return clock_ >= end - kLeastServo * share_ - kSamePeriod; }

void Motion::speed_joints(const Host& host, const Joints& speed, double acceleration) {
  if (!(acceleration >= 0.0)) throw Fault{"an acceleration below 0"};
  const bool is_moving = mode_ == Mode::ToolSpeed || !moves_.empty() || is_servo_;
  if (mode_ != Mode::JointSpeed)
    speed_ = is_moving && share_ > 0.0 ? plus({}, host.state().target.qd, 1.0 / share_) : Joints{};
  mode_ = Mode::JointSpeed;
  moves_.clear();
  is_servo_ = false;
  wanted_speed_ = speed;
  acceleration_ = acceleration;
}

void Motion::speed_tool(const std::array<double, 6>& speed, double acceleration) {
  if (!(acceleration > 0.0)) throw Fault{"an acceleration that is not positive"};
  if (mode_ != Mode::ToolSpeed) tool_speed_ = {};
  mode_ = Mode::ToolSpeed;
  wanted_tool_speed_ = speed;
  acceleration_ = acceleration;
}

void Motion::brake(const Host& host, double acceleration) {
  if (!(acceleration > 0.0)) throw Fault{"an acceleration that is not positive"};
  const JointTarget& target = host.state().target;
  const bool is_resting = is_still() && !is_servo_;  // the last step of a move is no speed
  mode_ = Mode::Path;
  moves_.clear();
  is_servo_ = false;
  const double fastest = is_resting ? 0.0 : largest(target.qd);
  if (fastest < 1e-9) return stop(host);
  const double dt = host.period(), duration = std::max(fastest / acceleration, dt);
  const auto count = static_cast<std::size_t>(std::ceil(duration / dt));
  std::vector<Joints> way;
  for (std::size_t k = 0; k <= count; ++k) {
    const double t = std::min(static_cast<double>(k) * dt, duration);
    way.push_back(plus(target.q, target.qd, t - 0.5 * t * t / duration));
  }
  way.push_back(way.back());  // at rest
  add(host, way, static_cast<double>(count));
  moves_.back().is_brake = true;
}

void Motion::brake(const Host& host) {
  const Joints& most = host.limits().max_acceleration;
  brake(host, *std::min_element(most.begin(), most.end()));
}

void Motion::stop(const Host& host) {
  mode_ = Mode::Path;
  moves_.clear();
  speed_ = {};
  end_ = host.state().target.q;
}

/// The host moved the target, as after a stop: the arm comes back to its path, slowly, and goes on there.
void Motion::return_to_path(Host& host) {
  JointTarget& target = host.state().target;
  target.qd = {};
  if (mode_ != Mode::Path) return stop(host);
  if (!end_) return;
  const Joints off = plus(target.q, path_now(), -1.0);
  double slowest = 0.0;
  for (std::size_t j = 0; j < kJoints; ++j)
    slowest = std::max(slowest, std::abs(off[j]) / (kReturnSpeed * host.limits().max_speed[j]));
  if (slowest > kLongestMove) throw Fault{"the arm was moved too far from its path"};
  const auto count = static_cast<std::size_t>(std::ceil(slowest / host.period()) + 1.0);
  Move back;
  for (std::size_t k = 0; k <= count; ++k) {
    const double u = static_cast<double>(k) / static_cast<double>(count);
    back.way.push_back(plus({}, off, 1.0 - u * u * (3.0 - 2.0 * u)));
  }
  moves_.push_front(std::move(back));
}

void Motion::end_force(const Host& host) {
  force_.reset();
  pushed_.setZero();
  turned_.setIdentity();
  if (is_still()) end_ = host.state().target.q;
}

bool Motion::may_go_on() const {
  return moves_.empty() ||
         moves_.back().time >=
             std::min(moves_.back().blend_from, static_cast<double>(moves_.back().way.size() - 1)) - 1e-9;
}

bool Motion::has_speed(const Joints& speed) const {
  return mode_ == Mode::JointSpeed && largest(plus(speed, speed_, -1.0)) < 1e-9;
}

Joints Motion::path_now() const {
  Joints q = *end_;
  for (const Move& move : moves_) {
    const auto last = static_cast<double>(move.way.size() - 1);
    const double at = std::min(move.time, last);
    const auto k = static_cast<std::size_t>(at);
    const double share = at - static_cast<double>(k);
    q = plus(q, move.way[k], 1.0 - share);
    if (share > 0.0) q = plus(q, move.way[k + 1], share);
  }
  return q;
}

/// The tool gives way in the directions of force_mode, so that it pushes with the force that is asked for.
void Motion::push(const Host& host, Joints& q) {
  const ControllerState& state = host.state();
  const Matrix3& R_BaseT = force_->X_BaseT.R;
  const Vector3 felt = R_BaseT.transpose() * state.F_Eo_Base.force;
  const Vector3 felt_about = R_BaseT.transpose() * state.F_Eo_Base.torque;
  Vector3 step = Vector3::Zero(), turn = Vector3::Zero();
  for (int i = 0; i < 3; ++i) {
    const double most = force_->speed[i], most_about = force_->angular_speed[i];
    if (force_->is_compliant[static_cast<std::size_t>(i)])
      step[i] = std::clamp(kForceGain * (force_->force[i] + felt[i]), -most, most);
    if (force_->is_compliant_about[static_cast<std::size_t>(i)])
      turn[i] = std::clamp(kTorqueGain * (force_->torque[i] + felt_about[i]), -most_about, most_about);
  }
  pushed_ += R_BaseT * step * host.period();
  turned_ = exp_rotation(R_BaseT * turn * host.period()) * turned_;
  Pose tool = host.forward(q) * state.X_FE;
  tool.p += pushed_;
  tool.R = turned_ * tool.R;
  if (const std::optional<Joints> found = host.inverse(tool * state.X_FE.inverse(), written_)) q = *found;
}

void Motion::step(Host& host, double share) {
  JointTarget& target = host.state().target;
  const double dt = host.period();
  if (has_written_ && target.q != written_) return_to_path(host);
  Joints q = target.q;
  share_ = share;
  clock_ += share;
  if (mode_ == Mode::Path) {
    if (!end_) end_ = target.q;
    for (Move& move : moves_) move.time += move.is_brake ? 1.0 : share;
    q = path_now();
    while (!moves_.empty() && moves_.front().time >= static_cast<double>(moves_.front().way.size() - 1) - 1e-9)
      moves_.pop_front();
  } else if (mode_ == Mode::JointSpeed) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const double most = host.limits().max_speed[j], change = acceleration_ * dt * share;
      const double wanted = std::clamp(wanted_speed_[j], -most, most);
      speed_[j] += std::clamp(wanted - speed_[j], -change, change);
      q[j] = std::clamp(q[j] + speed_[j] * dt * share, host.limits().lower[j], host.limits().upper[j]);
    }
  } else {
    const Pose& X_FE = host.state().X_FE;
    const double passed = dt * share, change = acceleration_ * passed;
    for (std::size_t i = 0; i < 6; ++i)
      tool_speed_[i] += std::clamp(wanted_tool_speed_[i] - tool_speed_[i], -change, change);
    Pose pose = host.forward(q) * X_FE;
    pose.p += passed * Vector3(tool_speed_[0], tool_speed_[1], tool_speed_[2]);
    pose.R = exp_rotation(passed * Vector3(tool_speed_[3], tool_speed_[4], tool_speed_[5])) * pose.R;
    if (const std::optional<Joints> found = host.inverse(pose * X_FE.inverse(), q))
      q = *found;
    else
      throw Fault{"the arm does not reach further", true};
  }
  if (mode_ != Mode::Path) end_ = q;
  if (force_) push(host, q);
  JointTarget next;
  next.q = q;
  bool is_possible = true;
  for (std::size_t j = 0; j < kJoints; ++j) {
    next.qd[j] = (q[j] - target.q[j]) / dt;
    next.qdd[j] = (next.qd[j] - target.qd[j]) / dt;
    is_possible = is_possible && std::abs(next.qd[j]) <= host.limits().max_speed[j] * (1.0 + kTolerance) &&
                  q[j] >= host.limits().lower[j] - kTolerance && q[j] <= host.limits().upper[j] + kTolerance;
  }
  if (!is_possible) {
    stop(host);
    target.qd = target.qdd = {};
    throw Fault{"a joint would be beyond its limit of position or speed", true};
  }
  target = next;
  written_ = q;
  has_written_ = true;
}

}  // namespace snug::urscript::internal
