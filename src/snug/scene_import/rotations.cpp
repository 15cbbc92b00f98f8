// Rotations in the ways that scenes write them.
#include <cmath>

#include "snug/scene_import/internal/xml.hpp"

namespace snug::scene_import::internal {

Matrix3 euler_rotation(const Vector3& angles, std::string_view order) {
  Matrix3 R = Matrix3::Identity();
  for (std::size_t k = 0; k < 3 && k < order.size(); ++k) {
    const char letter = order[k];
    const bool is_fixed = letter >= 'X' && letter <= 'Z';
    const int axis = letter - (is_fixed ? 'X' : 'x');
    const Matrix3 turn = exp_rotation(angles[static_cast<int>(k)] * Vector3::Unit(axis));
    R = is_fixed ? Matrix3(turn * R) : Matrix3(R * turn);
  }
  return R;
}

Matrix3 rotation_of_z(const Vector3& direction) {
  const Vector3 to = direction.normalized();
  const Vector3 axis = Vector3::UnitZ().cross(to);
  const double sine = axis.norm(), cosine = to.z();
  if (sine < 1e-12) return cosine > 0.0 ? Matrix3::Identity() : exp_rotation(std::acos(-1.0) * Vector3::UnitX());
  return exp_rotation(std::atan2(sine, cosine) / sine * axis);
}

Matrix3 rpy_rotation(const Vector3& rpy) { return euler_rotation(rpy, "XYZ"); }

}  // namespace snug::scene_import::internal
