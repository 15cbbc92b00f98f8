// CupLaw: a cup whose stiffness depends on its compression, as wrenches measured in many poses show it.
#include "snug/model/cup_law.hpp"

#include <cmath>
#include <initializer_list>

namespace snug::model {
namespace {

constexpr double kBeyond = 0.25;  // of half the measured range: how far s(u) goes on outside it

/// s(u), with its derivatives: two times continuously differentiable, and needs no more than a root.
Curve held_in_range(double u) {
  const double x = (std::abs(u) - 1.0) / kBeyond;
  if (x <= 0.0) return {u, 1.0, 0.0};
  const double sign = u > 0.0 ? 1.0 : -1.0, root = std::sqrt(1.0 + x * x), cube = root * root * root;
  return {sign * (1.0 + kBeyond * x / root), 1.0 / cube, -sign * 3.0 * x / (kBeyond * cube * root * root)};
}

/// A sum of the powers, by z.
Curve by_z(const Powers& powers, std::initializer_list<double> coefficients, double half_range) {
  Curve sum;
  std::size_t i = 0;
  for (const double coefficient : coefficients) {
    sum.value += coefficient * powers[i].value;
    sum.slope += coefficient * powers[i].slope / half_range;
    sum.curvature += coefficient * powers[i++].curvature / (half_range * half_range);
  }
  return sum;
}

}  // namespace

Powers stiffness_powers(double u) {
  const Curve s = held_in_range(u);
  Powers powers;
  powers[0] = {1.0, 0.0, 0.0};
  for (std::size_t i = 1; i < kLawPowers; ++i) {
    const Curve& p = powers[i - 1];
    powers[i] = {p.value * s.value, p.slope * s.value + p.value * s.slope,
                 p.curvature * s.value + 2.0 * p.slope * s.slope + p.value * s.curvature};
  }
  return powers;
}

Powers energy_powers(double u) {
  const double end = std::abs(u) <= 1.0 ? u : std::copysign(1.0, u), beyond = u - end;
  Powers powers;
  double power = 1.0, before = 0.0;  // end^i, end^(i-1)
  for (std::size_t i = 0; i < kLawPowers; ++i) {
    const double n = static_cast<double>(i), slope = n * before;
    powers[i] = {power * end / (n + 1.0) + beyond * (power + 0.5 * slope * beyond), power + slope * beyond, slope};
    before = power;
    power *= end;
  }
  return powers;
}

Curve CupLaw::axial(double z) const {
  const auto at = [this](double height) {
    Curve curve = by_z(energy_powers((height - middle) / half_range),
                       {0.0, axial_1, axial_2, axial_3, axial_4, axial_5}, half_range);
    curve.value *= half_range;
    curve.slope *= half_range;
    curve.curvature *= half_range;
    return curve;
  };
  const Curve rest = at(0.0), here = at(z);
  return {here.value - rest.value - rest.slope * z, here.slope - rest.slope, here.curvature};
}

Curve CupLaw::lateral(double z) const {
  return by_z(stiffness_powers((z - middle) / half_range), {lateral_0, lateral_1, lateral_2}, half_range);
}

Curve CupLaw::bend(double z) const {
  return by_z(stiffness_powers((z - middle) / half_range), {bend_0, bend_1, bend_2}, half_range);
}

Curve CupLaw::coupling(double z) const {
  return by_z(stiffness_powers((z - middle) / half_range), {coupling_0, coupling_1, coupling_2}, half_range);
}

Curve CupLaw::torsion(double z) const {
  return by_z(stiffness_powers((z - middle) / half_range), {torsion_0, torsion_1}, half_range);
}

void CupLaw::scale(double factor) {
  for (double* part : {&axial_1, &axial_2, &axial_3, &axial_4, &axial_5, &lateral_0, &lateral_1, &lateral_2, &bend_0,
                       &bend_1, &bend_2, &coupling_0, &coupling_1, &coupling_2, &torsion_0, &torsion_1})
    *part *= factor;
}

}  // namespace snug::model
