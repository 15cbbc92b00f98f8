// check_program: whether the arm can do a program, without any contact physics.
#include "snug/runs/program_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "snug/cell/held_boxes.hpp"
#include "snug/cell/simulation.hpp"
#include "snug/core/input_error.hpp"
#include "snug/cup/phases.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/runs/internal/pose_check.hpp"
#include "snug/spatial/matrix6.hpp"

namespace snug::runs {
namespace {

using cell::HeldBox;
using cell::HeldBoxes;
using cell::Simulation;
using cell::StandingBox;
using internal::Mover;
using internal::Obstacle;
using internal::PoseMargin;

constexpr double kRadian = 0.3;  ///< m, that a turn by 1 rad counts as

class Check {
 public:
  Check(const model::Scenario& scenario, const motion::Program& program, const CheckOptions& options)
      : options_(options),
        simulation_(
            scenario, options.sequence.empty() ? any_sequence(scenario) : options.sequence,
            {options.tracking, cup::CupMode::Holding, options.robot.empty() ? scenario.robot->name : options.robot}),
        plan_(simulation_.prepare(program)),
        pose_check_(scenario, arm(), controller().clearance(), options.allowance, options.range),
        machine_(control::make_demonstrator_machine()),
        boxes_(simulation_.scenario(), simulation_.sequence()) {}

  CheckResult run() {
    const auto begin = std::chrono::steady_clock::now();
    control::MachineState state = machine_.make_state(controller(), simulation_.arm()->start());
    control::JointControllerWork work;
    Pose X_WE_last = state.tool.X_WE;
    for (std::int64_t i = 0; static_cast<double>(i) * plan_.settings.tick < motion::kLongestProgram; ++i) {
      time_ = static_cast<double>(i) * plan_.settings.tick;
      const robot::JointVector q = state.joints.q;
      const motion::ToolState tool = state.tool;
      const control::MachineTick tick = machine_.tick(plan_, controller(), state, work);
      const motion::ControllerOutput& out = tick.program;
      row_ = std::max(0, out.reached >= 0 ? out.reached : out.row);
      const double way = (tool.X_WE.p - X_WE_last.p).norm() + kRadian * angle_between(tool.X_WE.R, X_WE_last.R);
      look_at_hold(tool);
      if (i == 0 || out.reached >= 0 || way >= options_.path_step) {
        look(q, tool, out.X_WE_reference);
        X_WE_last = tool.X_WE;
      }
      if (out.departed >= 0) {
        boxes_.depart(plan_.program, out.departed, tool.X_WE);
        V_WE_last_.reset();
        find_packed();
      }
      if (out.finished_now) break;
      if (tick.outcome != control::Outcome::Stuck) continue;
      miss(tick, state.tool.X_WE);
      if (out.row + 1 == static_cast<int>(plan_.program.waypoints.size())) break;
      // On to the next row from where the arm stands.
      plan_.row_limits[static_cast<std::size_t>(out.row)].precision = std::numeric_limits<double>::infinity();
      state.state = tick.state;
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
  [[nodiscard]] const control::JointController& controller() const { return simulation_.arm()->controller(); }

  /// Keeps the worst of each kind and thing: for the row when it is beyond its limit, and over the program.
  void note(CheckKind kind, const std::string& what, double margin, const char* unit, bool is_error = true,
            double allowance = 0.0) {
    const double left = margin + allowance;
    const bool is_kept = PoseMargin{kind, "", margin, unit, allowance}.is_kept();
    const auto keep = [&](std::vector<CheckFinding>& list, bool same_row) {
      for (CheckFinding& known : list) {
        if (known.kind != kind || (same_row && (known.row != row_ || known.what != what))) continue;
        if (left < known.margin + known.allowance) known = make(kind, what, margin, unit, is_error, allowance);
        return;
      }
      list.push_back(make(kind, what, margin, unit, is_error, allowance));
    };
    keep(result_.margins, false);
    if (!is_kept) keep(result_.findings, true);
  }
  [[nodiscard]] CheckFinding make(CheckKind kind, const std::string& what, double margin, const char* unit,
                                  bool is_error, double allowance) const {
    return {kind, is_error, row_,      motion::name_of(plan_.program.waypoints[static_cast<std::size_t>(row_)]),
            what, margin,   allowance, unit,
            time_};
  }

  /// The row was not reached.
  void miss(const control::MachineTick& tick, const Pose& X_WE) {
    const Pose& goal = plan_.X_WE[static_cast<std::size_t>(tick.program.row)];
    std::string what = "tool";
    for (int i = 0; i < tick.joints.active_count; ++i) {
      what += (i == 0 ? ": " : ", ") + controller().describe(tick.joints.active[static_cast<std::size_t>(i)]);
    }
    note(CheckKind::Reach, what, -std::max((goal.p - X_WE.p).norm(), kRadian * angle_between(goal.R, X_WE.R)), "m");
  }

  void look(const robot::JointVector& q, const motion::ToolState& tool, const Pose& X_WE_reference) {
    ++result_.looks;
    const robot::ArmPose at = robot::forward(arm(), q);
    const robot::Jacobian J_WE = robot::tool_jacobian(arm(), at);
    const double singularity = robot::singularity_measure(J_WE);
    pose_check_.look_at_singularity(singularity, note_);
    look_at_joints(q, J_WE, wanted_twist(tool, X_WE_reference), singularity);
    look_at_distances(at);
  }

  /// What the tool alone would do next: docs/theory/controller.md, eq. 1.
  [[nodiscard]] Vector6 wanted_twist(const motion::ToolState& tool, const Pose& X_WE_reference) const {
    const double k = plan_.settings.task_stiffness, dt = plan_.settings.tick;
    Vector6 error;
    error << X_WE_reference.p - tool.X_WE.p, log_rotation(X_WE_reference.R * tool.X_WE.R.transpose());
    const Vector6 V_WE = as_vector(tool.V_WE);
    return V_WE + dt * (k * error - 2.0 * std::sqrt(k) * V_WE);
  }

  void look_at_joints(const robot::JointVector& q, const robot::Jacobian& J_WE, const Vector6& V_WE,
                      double singularity) {
    const model::RobotParams& params = simulation_.arm()->controller().settings().params;
    Matrix6 M = robot::gram(J_WE);
    if (singularity < internal::kSingularPose) M.diagonal().array() += 1e-4;
    const robot::JointVector qd = J_WE.transpose() * snug::solve(M, V_WE);
    for (int j = 0; j < arm().joint_count(); ++j) {
      const robot::Joint& joint = arm().joints[static_cast<std::size_t>(j)];
      const bool turns = joint.kind == robot::JointKind::Revolute;
      pose_check_.look_at_limit(j, q[j], note_);
      const double speed = std::abs(qd[j]), allowed = params.velocity_fraction * joint.max_speed;
      note(CheckKind::JointSpeed, joint.name, allowed - speed, turns ? "rad/s" : "m/s", speed > joint.max_speed);
    }
  }

  /// Of a box that hangs still from the cup and touches nothing: what its weight and the tool's acceleration ask of it.
  void look_at_hold(const motion::ToolState& tool) {
    const std::optional<Twist> before = std::exchange(V_WE_last_, tool.V_WE);
    if (!before || !boxes_.held() || options_.sequence.empty()) return;
    const model::Scenario& scenario = simulation_.scenario();
    const HeldBox& held = *boxes_.held();
    const std::string& name = simulation_.sequence().items[static_cast<std::size_t>(held.item)].parcel;
    const SpatialInertia& inertia = model::find_parcel(scenario, name)->inertia;
    const double dt = plan_.settings.tick;
    const Vector3 alpha = (tool.V_WE.angular - before->angular) / dt, omega = tool.V_WE.angular;
    const Matrix3 R_WP = tool.X_WE.R * held.X_EP.R;
    const Vector3 p_EC = tool.X_WE.R * (held.X_EP * inertia.com);  // in W
    const Vector3 a = (tool.V_WE.linear - before->linear) / dt + alpha.cross(p_EC) + omega.cross(omega.cross(p_EC));
    const Matrix3 I_W = R_WP * inertia.inertia * R_WP.transpose();
    const Vector3 p_ES = tool.X_WE.R * Vector3(0.0, 0.0, scenario.cup.hold_length);
    Wrench F_S;
    const Vector3 f_W = inertia.mass * (a - scenario.gravity);
    F_S.force = tool.X_WE.R.transpose() * f_W;
    F_S.torque = tool.X_WE.R.transpose() * (I_W * alpha + omega.cross(I_W * omega) + (p_EC - p_ES).cross(f_W));
    const double factor = cup::find_hold_factor(scenario.cup, scenario.cup.vacuum.pressure_gauge_hold, F_S);
    if (std::isfinite(factor)) note(CheckKind::Hold, name, factor - 1.0, "times");
  }

  /// Boxes that were let go over the container.
  void find_packed() {
    packed_.clear();
    const model::Scenario& scenario = simulation_.scenario();
    const model::Container* container = model::find_container(scenario, scenario.target);
    if (container == nullptr || options_.sequence.empty()) return;
    for (const StandingBox& box : boxes_.standing()) {
      const Vector3 p_TP = container->X_WT.inverse() * box.X_WP.p;
      if ((p_TP.cwiseAbs() - 0.5 * container->inner_size).head<2>().maxCoeff() > 0.0) continue;
      const geometry::Box shape{0.5 * box.size};
      packed_.push_back({simulation_.sequence().items[static_cast<std::size_t>(box.item)].parcel, shape, box.X_WP,
                         geometry::bounds(shape, box.X_WP)});
    }
  }

  void look_at_distances(const robot::ArmPose& at) {
    pose_check_.look_at_distances(at, packed_, options_.packed_allowance, note_);
    if (!boxes_.held() || options_.sequence.empty()) return;
    const HeldBox& held = *boxes_.held();
    const std::string& name = simulation_.sequence().items[static_cast<std::size_t>(held.item)].parcel;
    const Mover box{name, 0, {{geometry::Box{0.5 * held.size}, held.X_EP}}, options_.allowance};
    pose_check_.look_at(box, at.X_WE, packed_, options_.packed_allowance, note_);
  }

  CheckOptions options_;
  Simulation simulation_;
  motion::PreparedProgram plan_;
  internal::PoseCheck pose_check_;
  std::vector<Obstacle> packed_;  ///< boxes
  const internal::PoseCheck::Note note_ = [this](const PoseMargin& one) {
    note(one.kind, one.what, one.margin, one.unit, true, one.allowance);
  };
  control::StateMachine machine_;
  HeldBoxes boxes_;
  std::optional<Twist> V_WE_last_;  ///< a tick before
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
    case CheckKind::Hold:
      return "hold";
    case CheckKind::SelfCollision:
      break;
  }
  return "self-collision";
}

std::vector<CheckGroup> group(const std::vector<CheckFinding>& findings) {
  std::vector<CheckGroup> groups;
  for (const CheckFinding& finding : findings) {
    const auto known = std::find_if(groups.begin(), groups.end(), [&](const CheckGroup& one) {
      return one.worst.kind == finding.kind && one.worst.what == finding.what && one.worst.is_error == finding.is_error;
    });
    if (known == groups.end()) {
      groups.push_back({finding, {finding.row}});
      continue;
    }
    known->rows.push_back(finding.row);
    if (finding.margin + finding.allowance < known->worst.margin + known->worst.allowance) known->worst = finding;
  }
  return groups;
}

CheckResult check_program(const model::Scenario& scenario, const motion::Program& program,
                          const CheckOptions& options) {
  if (!scenario.robot) throw InputError(scenario.source_name, "robot", "", "a robot, to check what it can do");
  return Check(scenario, program, options).run();
}

}  // namespace snug::runs
