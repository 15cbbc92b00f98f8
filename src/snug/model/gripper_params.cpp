// GripperParams: what several cups are together: the balance of their supply, one cup that stands for all.
#include "snug/model/gripper_params.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace snug::model {
namespace {

constexpr double kAirDensity = 1.2;  // kg/m^3, at ambient pressure

double disc(double diameter) { return 0.25 * std::numbers::pi * diameter * diameter; }

/// m^2, of the orifice that a cup is to the manifold.
double opening_of(const MountedCup& cup, LineState state) {
  const double port = disc(cup.line.port_diameter);
  if (state == LineState::Open) return cup.line.check_valve ? 0.0 : port;
  if (state == LineState::Shut) return 0.0;
  const double leak = disc(cup.line.leak_diameter);
  return leak > 0.0 ? port * leak / std::hypot(port, leak) : 0.0;  // one behind the other
}

/// Where flow (1 - p / dead_end) = opening sqrt(2 p / rho): a quadratic in sqrt(p).
double manifold_vacuum(const SupplyParams& supply, double opening) {
  const double dead_end = -supply.pressure_gauge;
  const double a = supply.flow / dead_end, b = opening * std::sqrt(2.0 / kAirDensity), c = supply.flow;
  // 2c / (b + sqrt(..)) is the root without the cancellation of the usual form.
  const double root = 2.0 * c / (b + std::sqrt(b * b + 4.0 * a * c));
  return std::min(dead_end, root * root);
}

void add(const CupElasticity& one, CupElasticity& sum) {
  sum.lateral += one.lateral;
  sum.axial += one.axial;
  sum.bend += one.bend;
  sum.torsion += one.torsion;
  sum.coupling += one.coupling;
}

/// Moments of second order of the cups about E: the smaller of the two directions, and about Ez.
struct Spread {
  double x = 0.0, y = 0.0;
  [[nodiscard]] double smaller() const { return std::min(x, y); }
  [[nodiscard]] double polar() const { return x + y; }
};

template <class Weight>
Spread spread_of(const GripperParams& gripper, Weight weight) {
  Spread spread;
  for (const MountedCup& cup : gripper.cups) {
    spread.x += weight(cup.cup) * cup.p_EC.x() * cup.p_EC.x();
    spread.y += weight(cup.cup) * cup.p_EC.y() * cup.p_EC.y();
  }
  return spread;
}

CupElasticity together(const GripperParams& gripper, CupElasticity CupParams::*part) {
  CupElasticity sum;
  for (const MountedCup& cup : gripper.cups) add(cup.cup.*part, sum);
  sum.bend += spread_of(gripper, [part](const CupParams& cup) { return (cup.*part).axial; }).smaller();
  sum.torsion += spread_of(gripper, [part](const CupParams& cup) { return (cup.*part).lateral; }).polar();
  return sum;
}

/// m, radius at which the suction of all, in one point, has the moment at which the first cup comes off: the load of a
/// cup grows with its distance from E. At least the lip's own.
double lever_of(const GripperParams& gripper) {
  const double count = static_cast<double>(gripper.cups.size());
  const Spread spread = spread_of(gripper, [](const CupParams&) { return 1.0; });
  double lever = std::numeric_limits<double>::infinity();
  for (const bool is_y : {false, true}) {
    double farthest = 0.0;
    for (const MountedCup& cup : gripper.cups) farthest = std::max(farthest, std::abs(cup.p_EC[is_y ? 1 : 0]));
    lever = std::min(lever, farthest > 0.0 ? (is_y ? spread.y : spread.x) / (count * farthest) : 0.0);
  }
  return std::max(lever, gripper.cups.front().cup.lip_radius);
}

}  // namespace

void balance_supply(const GripperParams& gripper, const std::vector<LineState>& states, SupplyBalance& balance) {
  balance.cups.assign(gripper.cups.size(), 0.0);
  double opening = 0.0;
  for (std::size_t i = 0; i < gripper.cups.size(); ++i) opening += opening_of(gripper.cups[i], states[i]);
  balance.manifold = gripper.supply ? manifold_vacuum(*gripper.supply, opening) : 0.0;
  for (std::size_t i = 0; i < gripper.cups.size(); ++i) {
    if (states[i] != LineState::Sealed) continue;
    const MountedCup& cup = gripper.cups[i];
    if (!gripper.supply) {
      balance.cups[i] = -cup.cup.vacuum.pressure_gauge_hold;
      continue;
    }
    const double port = disc(cup.line.port_diameter), leak = disc(cup.line.leak_diameter);
    balance.cups[i] = balance.manifold * port * port / (port * port + leak * leak);
  }
}

CupParams equivalent_cup(const GripperParams& gripper) {
  const double count = static_cast<double>(gripper.cups.size());
  CupParams all = gripper.cups.front().cup;
  all.stiffness = together(gripper, &CupParams::stiffness);
  all.law = {};
  all.damping = together(gripper, &CupParams::damping);
  all.hold_length = all.free_length = all.vacuum.bellows_area = all.vacuum.hose_volume = 0.0;
  double square = 0.0;
  for (const MountedCup& cup : gripper.cups) {
    all.hold_length += (cup.p_EC.z() + cup.cup.hold_length) / count;
    all.free_length += (cup.p_EC.z() + cup.cup.free_length) / count;
    all.vacuum.bellows_area += cup.cup.vacuum.bellows_area;
    all.vacuum.hose_volume += cup.cup.vacuum.hose_volume;
    square += cup.cup.effective_diameter * cup.cup.effective_diameter;
  }
  all.effective_diameter = std::sqrt(square);
  all.lip_radius = lever_of(gripper);
  if (gripper.supply) {
    SupplyBalance balance;
    balance_supply(gripper, std::vector<LineState>(gripper.cups.size(), LineState::Sealed), balance);
    all.vacuum.pressure_gauge_hold = -*std::min_element(balance.cups.begin(), balance.cups.end());
  }
  return all;
}

Vector3 footprint(const GripperParams& gripper) {
  Vector3 half = Vector3::Zero();
  for (const MountedCup& cup : gripper.cups) {
    const Vector3 reach = cup.p_EC.cwiseAbs() + Vector3::Constant(0.5 * cup.cup.effective_diameter);
    half.head<2>() = half.head<2>().cwiseMax(reach.head<2>());
  }
  return half;
}

void vary_cups(double stiffness_factor, double damping_factor, double longer, std::optional<GripperParams>& gripper) {
  if (!gripper) return;
  for (MountedCup& cup : gripper->cups) {
    scale_stiffness(cup.cup, stiffness_factor);
    scale(cup.cup.damping, damping_factor);
    cup.cup.hold_length += longer;
    cup.cup.free_length += longer;
  }
}

}  // namespace snug::model
