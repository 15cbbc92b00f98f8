// A cup's law whose stiffness depends on its compression (docs/theory/cup.md, section 8): energy, wrench, tangent.
#include "snug/cup/potential_law.hpp"

#include "snug/cup/law.hpp"
#include "snug/cup/law_derivatives.hpp"

namespace snug::cup {

LawTerms law_terms(const Vector6& q, double middle, double half_range) {
  const double x = q[0], y = q[1], u = (q[2] - middle) / half_range, a = q[3], b = q[4], c = q[5];
  LawTerms terms;
  int column = 0;
  for (const model::Curve& power : model::energy_powers(u)) {
    terms.energy[column] = half_range * power.value;
    terms.gradient(2, column++) = power.slope;
  }
  const model::Powers powers = model::stiffness_powers(u);
  const auto add = [&](std::size_t count, double value, const Vector6& slope) {
    for (std::size_t i = 0; i < count; ++i) {
      terms.energy[column] = powers[i].value * value;
      terms.gradient.col(column) = powers[i].value * slope;
      terms.gradient(2, column++) += powers[i].slope / half_range * value;
    }
  };
  add(3, 0.5 * (x * x + y * y), (Vector6() << x, y, 0, 0, 0, 0).finished());
  add(3, 0.5 * (a * a + b * b), (Vector6() << 0, 0, 0, a, b, 0).finished());
  add(3, x * b - y * a, (Vector6() << b, -a, 0, -y, x, 0).finished());
  add(2, 0.5 * c * c, (Vector6() << 0, 0, 0, 0, 0, c).finished());
  return terms;
}

LawResponse law_response(const model::CupLaw& law, const Pose& H) {
  const Vector6 q = 0.5 * deformation(H);
  const double x = q[0], y = q[1], z = q[2], a = q[3], b = q[4], c = q[5];
  const model::Curve axial = law.axial(z), lateral = law.lateral(z), bend = law.bend(z), coupling = law.coupling(z);
  const model::Curve torsion = law.torsion(z);
  const double shifted = 0.5 * (x * x + y * y), bent = 0.5 * (a * a + b * b), both = x * b - y * a,
               turned = 0.5 * c * c;
  const auto sum = [&](double of_axial, double model::Curve::*part) {
    return of_axial + lateral.*part * shifted + bend.*part * bent + coupling.*part * both + torsion.*part * turned;
  };
  const double L = lateral.value, B = bend.value, C = coupling.value;
  Vector6 gradient;
  gradient << L * x + C * b, L * y - C * a, sum(axial.slope, &model::Curve::slope), B * a - C * y, B * b + C * x,
      torsion.value * c;
  Vector6 by_z;  // of the gradient
  by_z << lateral.slope * x + coupling.slope * b, lateral.slope * y - coupling.slope * a,
      sum(axial.curvature, &model::Curve::curvature), bend.slope * a - coupling.slope * y,
      bend.slope * b + coupling.slope * x, torsion.slope * c;
  Matrix6 hessian = Matrix6::Zero();
  hessian.diagonal() << L, L, 0.0, B, B, torsion.value;
  hessian(0, 4) = hessian(4, 0) = C;
  hessian(1, 3) = hessian(3, 1) = -C;
  hessian.row(2) = by_z.transpose();
  hessian.col(2) = by_z;
  const Matrix6 J = deformation_jacobian(H);  // of e = 2 q
  return {sum(axial.value, &model::Curve::value), -0.5 * J.transpose() * gradient,
          -0.5 * pullback_derivative(H, gradient) - 0.25 * J.transpose() * hessian * J};
}

LawResponse spring_response(const Pose& H, const Matrix6& K, const model::CupLaw& law) {
  if (law.is_used()) return law_response(law, H);
  return {potential(H, K), spring_wrench(H, K), spring_tangent(H, K)};
}

Vector6 spring_wrench(const Pose& H, const Matrix6& K, const model::CupLaw& law) {
  return law.is_used() ? law_response(law, H).wrench : spring_wrench(H, K);
}

Matrix6 spring_tangent(const Pose& H, const Matrix6& K, const model::CupLaw& law) {
  return law.is_used() ? law_response(law, H).tangent : spring_tangent(H, K);
}

}  // namespace snug::cup
