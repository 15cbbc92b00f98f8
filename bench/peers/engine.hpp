// Engine: what a physics engine must offer to be measured; and the engines at hand.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "peers/scenes.hpp"

namespace snug::peers {

/// Bodies are named by their index in Scene::bodies; the plane is kPlane.
inline constexpr int kPlane = -1;

class Engine {
 public:
  virtual ~Engine() = default;

  /// Forgets everything and starts the scene at rest, nothing asleep and nothing allowed to sleep.
  virtual void build(const Scene& scene, double dt) = 0;
  /// Advances by the dt given to build().
  virtual void step() = 0;
  /// Advances `count` times; the poses of a body after each step, or none where the engine gave up.
  [[nodiscard]] virtual std::vector<Pose> follow(int body, int count);
  /// True once the engine has given up on the run (its numbers became infinite or the like).
  [[nodiscard]] virtual bool has_failed() const { return false; }
  /// CPU seconds of the process that does the steps; one of its own counts its steps alone.
  [[nodiscard]] virtual double cpu_seconds() const;

  [[nodiscard]] virtual Pose pose(int body) const = 0;
  /// Linear part at the body's centre, in W.
  [[nodiscard]] virtual Twist velocity(int body) const = 0;
  /// Puts a present body somewhere, at a velocity.
  virtual void set_motion(int body, const Pose& X_WB, const Twist& V_WB) = 0;
  /// Lets a body that was not present enter at rest.
  virtual void insert(int body, const Pose& X_WB) = 0;
  /// For the next step only: a wrench about the body's centre, in W.
  virtual void apply_wrench(int body, const Wrench& wrench_W) = 0;
  /// Sum of the normal forces between two bodies in the last step, N; not a number where the engine does not tell.
  [[nodiscard]] virtual double normal_force(int body_a, int body_b) const = 0;

  /// For the next step only: the spring pulls a body. The holder moves from `begin` to `end` in this step.
  /// Engines without a spring of their own take its wrench at the beginning of the step.
  virtual void pull(int body, const Spring& spring, const HolderMotion& begin, const HolderMotion& end);
};

struct BulletSettings {
  int iterations = 10;
  bool use_two_friction_directions = false;
};
struct MujocoSettings {
  bool use_elliptic_cone = false;
  double impratio = 1.0;
  double time_constant = 0.02;                       ///< s, solref[0]
  double impedance_min = 0.9, impedance_max = 0.95;  ///< solimp[0], solimp[1]
};

/// The stiffness that gave S1 0.013 mm of penetration and S3 0.025 mm of creep: four steps of time constant.
inline constexpr MujocoSettings kMujocoStiff{true, 10.0, 0.004, 0.95, 0.99};

struct SnugSettings {
  bool bears_on_faces = false;  ///< `bearing: face` for every pair
};

/// snug itself, with the solver settings that scenarios have by default.
[[nodiscard]] std::unique_ptr<Engine> make_snug(const SnugSettings& settings);
[[nodiscard]] std::unique_ptr<Engine> make_bullet(const BulletSettings& settings);
[[nodiscard]] std::unique_ptr<Engine> make_mujoco(const MujocoSettings& settings);
/// An engine that answers in a process of its own (workers/protocol.py).
[[nodiscard]] std::unique_ptr<Engine> make_process(const std::vector<std::string>& command);

}  // namespace snug::peers
