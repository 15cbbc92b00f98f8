// DrawnScenario: a cell that could be the one a scenario describes, drawn from the scenario's own uncertainty.
#include "snug/cell/drawn_scenario.hpp"

#include <algorithm>
#include <numbers>
#include <optional>

#include "snug/cell/aligner_feed.hpp"
#include "snug/core/check.hpp"
#include "snug/motion/tool_yaw.hpp"

namespace snug::cell {
namespace {

constexpr double kLongestEdge = 0.3;  ///< m, of boxes
constexpr double kLeastFactor = 0.05;

/// Draws, each kind from a generator of its own: one more of a kind changes no other.
class Draw {
 public:
  Draw(const Rng& rng, const char* name) : rng_(rng.split(name)) {}
  double within(double half_width) { return rng_.uniform(-half_width, half_width); }
  double factor(double share) { return std::max(kLeastFactor, 1.0 + within(share)); }
  double between(double low, double high) { return rng_.uniform(low, high); }

 private:
  Rng rng_;
};

void draw_parcels(const model::Uncertainty& half_width, const Rng& rng, model::Scenario& scenario) {
  Draw size(rng, "size"), com(rng, "com"), mass(rng, "mass"), common(rng, "common size");
  const double grown = common.factor(half_width.size_common);
  for (model::Parcel& parcel : scenario.parcels) {
    for (int i = 0; i < 3; ++i) {
      const double edge = grown * parcel.size[i] + size.within(half_width.size);
      parcel.size[i] = std::max(0.5 * parcel.size[i], edge);
    }
    for (int i = 0; i < 3; ++i) {
      const double room = 0.45 * parcel.size[i];
      parcel.inertia.com[i] = std::clamp(parcel.inertia.com[i] + com.within(half_width.com), -room, room);
    }
    const double heavier = mass.factor(half_width.mass);
    parcel.inertia.mass *= heavier;
    parcel.inertia.inertia *= heavier;
  }
  Draw clearance(rng, "clearance");
  scenario.parcel_clearance = std::max(0.0, scenario.parcel_clearance + clearance.within(half_width.clearance));
}

void draw_contacts(const model::Uncertainty& half_width, const Rng& rng, model::Scenario& scenario) {
  Draw friction(rng, "friction"), stiffness(rng, "contact stiffness"), travel(rng, "contact travel");
  stiffen(scenario, stiffness.factor(half_width.contact_stiffness));
  const double farther = travel.factor(half_width.contact_travel);
  const auto draw = [&](model::ContactParams& params) {
    const double rougher = friction.factor(half_width.friction);
    params.friction *= rougher;
    if (params.edge_friction) *params.edge_friction *= rougher;
    if (params.travel) *params.travel *= farther;
  };
  for (model::ContactPair& pair : scenario.contact_pairs) draw(pair.params);
  if (scenario.default_contact) draw(*scenario.default_contact);
}

void draw_aligner(const model::Uncertainty& half_width, const std::string& sequence, const Rng& rng,
                  model::Scenario& scenario) {
  if (!scenario.aligner) return;
  Draw arrival(rng, "arrival"), aligner(rng, "aligner");
  const double x = aligner.within(half_width.aligner_position), y = aligner.within(half_width.aligner_position);
  const Matrix3 R = exp_rotation(Vector3(0.0, 0.0, aligner.within(half_width.aligner_yaw)));
  scenario.aligner->X_WA = scenario.aligner->X_WA * Pose{R, Vector3(x, y, 0.0)};
  for (model::Sequence& one : scenario.sequences) {
    if (one.name != sequence) continue;
    for (model::Item& item : one.items) {
      item.shift_A.x() += arrival.within(half_width.position);
      item.shift_A.y() += arrival.within(half_width.position);
      item.turn += arrival.within(half_width.yaw);
    }
  }
  // The plates stand back, so that no box begins inside them.
  const double back = half_width.position + kLongestEdge * half_width.yaw;
  for (model::PlacedShape& plate : scenario.aligner->plates) plate.X_BG.p -= Vector3(back, back, 0.0);
}

void draw_gripper(const model::Uncertainty& half_width, const Rng& rng, model::Scenario& scenario) {
  Draw cup(rng, "cup"), push(rng, "release push"), tracking(rng, "tracking");
  const double stiffer = cup.factor(half_width.cup_stiffness), more_damped = cup.factor(half_width.cup_stiffness);
  model::scale_stiffness(scenario.cup, stiffer);
  scale(scenario.cup.damping, more_damped);
  const double longer =
      std::max(cup.within(half_width.cup_length), scenario.cup.centre_from_lip - scenario.cup.hold_length);
  scenario.cup.hold_length += longer;
  scenario.cup.free_length += longer;
  model::vary_cups(stiffer, more_damped, longer, scenario.gripper);
  const double pushes = scenario.cup.release_push;
  scenario.cup.release_push =
      push.between(std::max(0.0, pushes - half_width.release_push), std::min(1.0, pushes + half_width.release_push));
  if (scenario.gripper) {
    for (model::MountedCup& one : scenario.gripper->cups) one.cup.release_push = scenario.cup.release_push;
  }
  const double quicker = tracking.factor(half_width.tracking);
  scenario.controller.task_stiffness *= quicker;
  for (model::Sequence& sequence : scenario.sequences) {
    if (sequence.task_stiffness) *sequence.task_stiffness *= quicker;
  }
}

}  // namespace

Pose arrival_pose(const model::Scenario& scenario, const model::Item& item) {
  SNUG_CHECK(scenario.aligner.has_value(), "boxes arrive at an aligner");
  const Pose first = pose_at_aligner(scenario, item, std::nullopt);
  return pose_at_aligner(scenario, item, Pose{motion::upright_tool(0.0), first.p});
}

model::Scenario with_fixed_arrivals(model::Scenario scenario, const std::string& sequence) {
  if (!scenario.aligner) return scenario;
  for (model::Sequence& one : scenario.sequences) {
    if (one.name != sequence) continue;
    for (model::Item& item : one.items) {
      if (item.yaw) continue;
      const Matrix3 R_AP = scenario.aligner->X_WA.R.transpose() * arrival_pose(scenario, item).R;
      double best = -4.0;
      for (int turn = 0; turn < 4; ++turn) {
        const double yaw = turn * 0.5 * std::numbers::pi;
        const double trace = (model::standing_rotation(item.up, item.up_sign, yaw).transpose() * R_AP).trace();
        if (trace <= best) continue;
        best = trace;
        item.yaw = yaw;
      }
    }
  }
  return scenario;
}

model::Scenario draw_scenario(const model::Scenario& scenario, const std::string& sequence, Rng rng) {
  model::Scenario drawn = scenario;
  const model::Uncertainty& half_width = scenario.uncertainty;
  draw_parcels(half_width, rng, drawn);
  draw_contacts(half_width, rng, drawn);
  draw_aligner(half_width, sequence, rng, drawn);
  draw_gripper(half_width, rng, drawn);
  return drawn;
}

model::Scenario draw_run(const model::Scenario& scenario, const std::string& sequence, int draw) {
  return draw_scenario(scenario, sequence, Rng(scenario.seed).split("monte_carlo " + std::to_string(draw - 1)));
}

void stiffen(model::Scenario& scenario, double factor) {
  const auto scale = [factor](model::ContactParams& params) {
    if (params.stiffness) *params.stiffness *= factor;
    if (params.stiffness_beyond) *params.stiffness_beyond *= factor;
  };
  for (model::ContactPair& pair : scenario.contact_pairs) scale(pair.params);
  if (scenario.default_contact) scale(*scenario.default_contact);
}

}  // namespace snug::cell
