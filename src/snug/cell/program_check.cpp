// check_program: whether the arm can do a program, without any contact physics.
#include "snug/cell/program_check.hpp"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "snug/cell/aligner_feed.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/control/pose_solver.hpp"
#include "snug/core/input_error.hpp"
#include "snug/geometry/manifold.hpp"

namespace snug::cell {
namespace {

constexpr double kLongestProgram = 7200.0;  ///< s
constexpr double kRadian = 0.3;             ///< m, that a turn by 1 rad counts as
// Below this the controller's task gives way (joint_controller.cpp): the tool is no longer where it should be.
constexpr double kSingular = 0.05;
constexpr double kPickLength = 0.05;  ///< m, E to the top face of a box that is picked up again

struct Obstacle {
  std::string name;
  geometry::Shape shape;
  Pose X_WG;
  geometry::Aabb bounds;
};

/// Shapes that move together and are judged together.
struct Mover {
  std::string name;
  int segment = 0;                         ///< of the arm
  std::vector<model::PlacedShape> shapes;  ///< X_BG in the segment
  double give = 0.0;                       ///< m, that it may press into something
};

std::vector<Obstacle> find_obstacles(const model::Scenario& scenario) {
  std::vector<Obstacle> obstacles;
  for (const physics::BodyModel& body : build_world(scenario, {nullptr, false, nullptr, {}}).model.bodies) {
    if (body.kind != physics::BodyKind::Static) continue;
    for (const physics::Geom& geom : body.geoms) {
      const Pose X_WG = body.X_WB * geom.X_BG;
      obstacles.push_back({body.name, geom.shape, X_WG, geometry::bounds(geom.shape, X_WG)});
    }
  }
  return obstacles;
}

std::vector<Mover> find_movers(const model::Scenario& scenario, const robot::ArmModel& arm, double give) {
  std::vector<Mover> movers;
  const int sensor = robot::find_link(arm, scenario.robot->sensor_frame);
  for (int i = 0; i < static_cast<int>(arm.links.size()); ++i) {
    const robot::Link& link = arm.links[static_cast<std::size_t>(i)];
    if (link.segment == 0 || link.shapes.empty() || robot::is_behind(arm, i, sensor)) continue;
    Mover mover{link.name, link.segment, {}, 0.0};
    for (const model::PlacedShape& shape : link.shapes) mover.shapes.push_back({shape.shape, link.X_SL * shape.X_BG});
    movers.push_back(std::move(mover));
  }
  const auto carried = [&](const char* name, const std::vector<model::PlacedShape>& shapes, double slack) {
    Mover mover{name, arm.joint_count(), {}, slack};
    for (const model::PlacedShape& shape : shapes) mover.shapes.push_back({shape.shape, arm.X_SE * shape.X_BG});
    movers.push_back(std::move(mover));
  };
  if (scenario.tool) {
    carried("gripper", scenario.tool->rod_shapes, 0.0);
    carried("cup", scenario.tool->cup_shapes, give);
  }
  return movers;
}

/// R with the axis that is nearest to the vertical made vertical.
Matrix3 upright(const Matrix3& R_WP) {
  const int axis = vertical_axis(R_WP);
  const Vector3 up = R_WP.col(axis);
  const Vector3 goal = Vector3(0.0, 0.0, up.z() < 0.0 ? -1.0 : 1.0);
  return orthonormalized(Quaternion::FromTwoVectors(up, goal).toRotationMatrix() * R_WP);
}

class Check {
 public:
  Check(const model::Scenario& scenario, const motion::Program& program, const CheckOptions& options)
      : options_(options),
        simulation_(scenario, options.sequence.empty() ? any_sequence(scenario) : options.sequence,
                    {motion::ControllerKind::Faithful, cup::CupMode::Holding,
                     options.robot.empty() ? scenario.robot->name : options.robot}),
        plan_(simulation_.prepare(program)),
        obstacles_(find_obstacles(scenario)),
        movers_(find_movers(scenario, arm(), options.give)),
        q_(simulation_.arm()->start()) {}

  CheckResult run() {
    const auto begin = std::chrono::steady_clock::now();
    motion::ControllerState state = motion::make_controller_state(robot::forward_tool(arm(), q_));
    Pose X_WE_last = state.command.X_WE;
    bool is_first = true;
    while (static_cast<double>(state.tick_count) * plan_.settings.tick < kLongestProgram) {
      const motion::ToolState tool = state.command;
      const motion::ControllerOutput out = motion::tick(plan_, tool, state);
      time_ = static_cast<double>(state.tick_count - 1) * plan_.settings.tick;
      row_ = std::max(0, out.reached >= 0 ? out.reached : out.row);
      const double way = (tool.X_WE.p - X_WE_last.p).norm() + kRadian * angle_between(tool.X_WE.R, X_WE_last.R);
      if (is_first || out.reached >= 0 || way >= options_.path_step) {
        look(tool);
        X_WE_last = tool.X_WE;
        is_first = false;
      }
      if (out.departed >= 0) depart(out.departed, tool.X_WE);
      if (out.finished_now) break;
    }
    result_.duration = time_;
    std::stable_sort(result_.findings.begin(), result_.findings.end(),
                     [](const CheckFinding& a, const CheckFinding& b) { return a.row < b.row; });
    for (const CheckFinding& finding : result_.findings) result_.is_ok = result_.is_ok && !finding.is_error;
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
    result_.wall = wall.count();
    return std::move(result_);
  }

 private:
  [[nodiscard]] static std::string any_sequence(const model::Scenario& scenario) {
    return scenario.sequences.empty() ? "" : scenario.sequences.front().name;
  }
  [[nodiscard]] const robot::ArmModel& arm() const { return simulation_.arm()->model(); }

  /// Keeps the worst of each kind and thing: for the row when it is beyond its limit, and over the program.
  void note(CheckKind kind, const std::string& what, double margin, const char* unit, bool is_error = true) {
    const auto keep = [&](std::vector<CheckFinding>& list, bool same_row) {
      for (CheckFinding& known : list) {
        if (known.kind != kind || (same_row && (known.row != row_ || known.what != what))) continue;
        if (margin < known.margin) known = make(kind, what, margin, unit, is_error);
        return;
      }
      list.push_back(make(kind, what, margin, unit, is_error));
    };
    keep(result_.margins, false);
    if (margin < 0.0) keep(result_.findings, true);
  }
  [[nodiscard]] CheckFinding make(CheckKind kind, const std::string& what, double margin, const char* unit,
                                  bool is_error) const {
    return {kind, is_error, row_, plan_.program.waypoints[static_cast<std::size_t>(row_)].name,
            what, margin,   unit, time_};
  }

  void look(const motion::ToolState& tool) {
    ++result_.looks;
    const control::PoseSolution solution = control::solve_pose(arm(), tool.X_WE, q_);
    q_ = solution.q;
    const robot::ArmPose at = robot::forward(arm(), q_);
    const robot::Jacobian J_WE = robot::tool_jacobian(arm(), at);
    const double singularity = robot::singularity_measure(J_WE);
    if (!solution.is_reached(1e-4, 1e-3)) {
      note(CheckKind::Reach, "tool", -std::max(solution.position_error, kRadian * solution.angle_error), "m");
    }
    note(CheckKind::Singularity, "tool", singularity - kSingular, "1");
    look_at_joints(J_WE, as_vector(tool.V_WE), singularity);
    look_at_distances(at);
  }

  void look_at_joints(const robot::Jacobian& J_WE, const Vector6& V_WE, double singularity) {
    const model::RobotParams& params = simulation_.arm()->controller().settings().params;
    Matrix6 M = J_WE * J_WE.transpose();
    if (singularity < kSingular) M.diagonal().array() += 1e-4;
    const robot::JointVector qd = J_WE.transpose() * M.partialPivLu().solve(V_WE);
    for (int j = 0; j < arm().joint_count(); ++j) {
      const robot::Joint& joint = arm().joints[static_cast<std::size_t>(j)];
      const bool turns = joint.kind == robot::JointKind::Revolute;
      const double range = joint.upper - joint.lower;
      if (std::isfinite(range)) {
        note(CheckKind::JointLimit, joint.name,
             std::min(q_[j] - joint.lower, joint.upper - q_[j]) - params.damper.safety * range, turns ? "rad" : "m");
      }
      const double speed = std::abs(qd[j]), allowed = params.velocity_fraction * joint.max_speed;
      note(CheckKind::JointSpeed, joint.name, allowed - speed, turns ? "rad/s" : "m/s", speed > joint.max_speed);
    }
  }

  void look_at_distances(const robot::ArmPose& at) {
    const control::Clearance& clearance = simulation_.arm()->controller().clearance();
    for (int i = 0; i < static_cast<int>(clearance.pairs().size()); ++i) {
      const control::Nearest nearest = clearance.nearest(at, i);
      if (nearest.index < 0) continue;
      note(CheckKind::SelfCollision, clearance.name_of(i),
           nearest.distance - clearance.pairs()[static_cast<std::size_t>(i)].safety, "m");
    }
    for (const Mover& mover : movers_) look_at_obstacles(mover, at.X_WS[static_cast<std::size_t>(mover.segment)]);
    if (held_) {
      const Mover box{held_name_, 0, {{geometry::Box{held_half_}, *held_}}, options_.give};
      look_at_obstacles(box, at.X_WE);
    }
  }

  void look_at_obstacles(const Mover& mover, const Pose& X_WS) {
    for (const model::PlacedShape& placed : mover.shapes) {
      const Pose X_WG = X_WS * placed.X_BG;
      const geometry::Aabb bounds = geometry::bounds(placed.shape, X_WG).inflated(options_.range);
      for (const Obstacle& obstacle : obstacles_) {
        if (!bounds.overlaps(obstacle.bounds)) continue;
        geometry::PairCache cache;
        geometry::Manifold manifold;
        geometry::collide(obstacle.shape, obstacle.X_WG, placed.shape, X_WG, options_.range, cache, manifold);
        double distance = options_.range;
        for (int i = 0; i < manifold.count; ++i) {
          distance = std::min(distance, manifold.points[static_cast<std::size_t>(i)].phi);
        }
        if (distance < options_.range) {
          note(CheckKind::Collision, mover.name + " - " + obstacle.name, distance + mover.give, "m");
        }
      }
    }
  }

  /// The vacuum comes on: the box of the pick hangs where it stood, relative to the tool. It goes off: it stays.
  void depart(int row, const Pose& X_WE) {
    const bool vacuum = plan_.program.waypoints[static_cast<std::size_t>(row)].io.vacuum;
    if (vacuum == vacuum_ || options_.sequence.empty()) return;
    vacuum_ = vacuum;
    if (!vacuum) {
      if (held_) X_WP_released_ = X_WE * *held_;
      held_.reset();
      return;
    }
    if (row == 0) return;
    const std::string& pick = plan_.program.waypoints[static_cast<std::size_t>(row - 1)].name;
    const int item = find_item(simulation_.sequence(), pick, "Box");
    Pose X_WP;
    if (item >= 0) {
      const model::Item& fed = simulation_.sequence().items[static_cast<std::size_t>(item)];
      held_name_ = fed.parcel;
      held_half_ =
          0.5 * model::collision_size(simulation_.scenario(), *model::find_parcel(simulation_.scenario(), fed.parcel));
      X_WP = pose_at_aligner(simulation_.scenario(), fed, X_WE);
    } else if (X_WP_released_) {  // picked up again: it has settled on its nearest face
      X_WP.R = upright(X_WP_released_->R);
      X_WP.p = X_WP_released_->p;
      const bool from_above = X_WE.R(2, 2) < -0.5;
      if (from_above) X_WP.p.z() = X_WE.p.z() - kPickLength - held_half_[vertical_axis(X_WP.R)];
    } else {
      return;
    }
    held_ = X_WE.inverse() * X_WP;
  }

  CheckOptions options_;
  Simulation simulation_;
  motion::PreparedProgram plan_;
  std::vector<Obstacle> obstacles_;
  std::vector<Mover> movers_;
  robot::JointVector q_;
  bool vacuum_ = false;
  std::optional<Pose> held_;  ///< X_EP
  std::optional<Pose> X_WP_released_;
  std::string held_name_;
  Vector3 held_half_ = Vector3::Zero();
  int row_ = 0;
  double time_ = 0.0;
  CheckResult result_;
};

}  // namespace

const char* name_of(CheckKind kind) {
  switch (kind) {
    case CheckKind::Reach:
      return "reach";
    case CheckKind::JointLimit:
      return "joint limit";
    case CheckKind::JointSpeed:
      return "joint speed";
    case CheckKind::Singularity:
      return "singularity";
    case CheckKind::Collision:
      return "collision";
    case CheckKind::SelfCollision:
      break;
  }
  return "self-collision";
}

CheckResult check_program(const model::Scenario& scenario, const motion::Program& program,
                          const CheckOptions& options) {
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "", "a robot, to check what it can do");
  return Check(scenario, program, options).run();
}

}  // namespace snug::cell
