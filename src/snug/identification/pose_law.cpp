// PotentialLaw: wrench and energy.
#include "snug/cup/law.hpp"
#include "snug/cup/law_derivatives.hpp"
#include "snug/cup/potential_law.hpp"
#include "snug/identification/cup_poses.hpp"
#include "snug/identification/internal/law_columns.hpp"

namespace snug::identification {
namespace internal {
namespace {

/// S1 in S2 of a pose: both frames stand at the centre in the least compressed pose.
Pose deformation_of(const PotentialLaw& law, const Pose& X_BS) {
  return {X_BS.R, X_BS * law.centre_B - law.centre_B - Vector3(0.0, 0.0, law.rest)};
}

}  // namespace

LawColumns columns_of(const PotentialLaw& law, const Pose& X_BS) {
  const Pose H = deformation_of(law, X_BS);
  const LawColumns f = -0.5 * cup::deformation_jacobian(H).transpose() *
                       cup::law_terms(0.5 * cup::deformation(H), law.middle, law.half_range).gradient;
  LawColumns out;
  out.topRows<3>() = X_BS.R * f.topRows<3>();
  out.bottomRows<3>() = X_BS.R * f.bottomRows<3>() + skew(X_BS * law.centre_B - law.reference_B) * out.topRows<3>();
  return out;
}

Eigen::Matrix<double, 6, 1> linear_columns_of(const Pose& X_BS) {
  const Quaternion turn(X_BS.R);
  Eigen::Matrix<double, 6, 1> columns;
  columns << X_BS.p, 2.0 * (turn.w() < 0.0 ? -1.0 : 1.0) * turn.vec();
  return columns;
}

}  // namespace internal

std::vector<std::string> coefficient_names() {
  std::vector<std::string> names;
  const auto add = [&names](const std::string& name, int count) {
    for (int i = 0; i < count; ++i) names.push_back(name + "_" + std::to_string(i));
  };
  add("axial", 6);
  for (const char* name : {"lateral", "bend", "coupling"}) add(name, 3);
  add("torsion", 2);
  for (const char* name : {"fx", "fy", "fz", "tx", "ty", "tz"}) names.push_back(std::string("tare_") + name);
  return names;
}

std::string unit_of_coefficient(const std::string& name) {
  if (name.starts_with("lateral")) return "N/m";
  if (name.starts_with("bend") || name.starts_with("torsion")) return "Nm/rad";
  return name.starts_with("tare_t") ? "Nm" : "N";
}

Vector6 predict_wrench(const PotentialLaw& law, const Pose& X_BS) {
  return internal::columns_of(law, X_BS) * law.coefficients.head<cup::kLawTerms>() + law.coefficients.tail<6>();
}

double stored_energy(const PotentialLaw& law, const Pose& X_BS) {
  const Vector6 q = 0.5 * cup::deformation(internal::deformation_of(law, X_BS));
  return cup::law_terms(q, law.middle, law.half_range).energy.dot(law.coefficients.head<cup::kLawTerms>().transpose());
}

model::CupLaw cup_law_of(const PotentialLaw& law) {
  model::CupLaw out;
  out.half_range = law.half_range;
  out.middle = law.middle;
  const double sign = law.coefficients[6] < 0.0 ? -1.0 : 1.0;  // lateral_0: of a sensor that reads the load
  Eigen::Index i = 1;                                          // axial_0 is not known apart from the sensor's zero
  for (double* part : {&out.axial_1, &out.axial_2, &out.axial_3, &out.axial_4, &out.axial_5, &out.lateral_0,
                       &out.lateral_1, &out.lateral_2, &out.bend_0, &out.bend_1, &out.bend_2, &out.coupling_0,
                       &out.coupling_1, &out.coupling_2, &out.torsion_0, &out.torsion_1})
    *part = sign * law.coefficients[i++];
  return out;
}

std::vector<std::string> find_unexplained(const PoseErrors& errors) {
  std::vector<std::string> names;
  Eigen::Index i = 0;
  for (const char* name : {"fx", "fy", "fz", "tx", "ty", "tz"})
    if (!(errors.components[i++] <= kExplainedComponent)) names.emplace_back(name);
  return names;
}

}  // namespace snug::identification
