// Reads the reference vectors of the cup model, and makes random inputs for its tests.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "snug/core/rng.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::cup::test {

inline std::filesystem::path vectors_path(const std::string& name) {
  return std::filesystem::path(SNUG_SOURCE_DIR) / ".." / "shared" / "data" / "cup" / name;
}

/// The file's content, or null where the reference data is not installed: the test skips then.
inline nlohmann::json load_vectors(const std::string& name) {
  std::ifstream file(vectors_path(name));
  return file ? nlohmann::json::parse(file) : nlohmann::json();
}

/// The largest of some errors, which the test records beside its verdict.
class Worst {
 public:
  explicit Worst(std::string name) : name_(std::move(name)) {}
  Worst(const Worst&) = delete;
  Worst& operator=(const Worst&) = delete;
  ~Worst() { testing::Test::RecordProperty(name_, fmt::format("{:.3g}", value_)); }

  double add(double error) {
    value_ = std::max(value_, error);
    return error;
  }

 private:
  std::string name_;
  double value_ = 0.0;
};

inline Vector3 vector3(const nlohmann::json& v) {
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
}

inline Vector6 vector6(const nlohmann::json& v) {
  Vector6 out;
  for (int i = 0; i < 6; ++i) out[i] = v.at(static_cast<std::size_t>(i)).get<double>();
  return out;
}

template <int n>
Eigen::Matrix<double, n, n> square(const nlohmann::json& rows) {
  Eigen::Matrix<double, n, n> out;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      out(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j)).get<double>();
    }
  }
  return out;
}

inline Matrix3 matrix3(const nlohmann::json& rows) { return square<3>(rows); }
inline Matrix6 matrix6(const nlohmann::json& rows) { return square<6>(rows); }
inline Pose pose(const nlohmann::json& h) { return {matrix3(h.at("R")), vector3(h.at("o"))}; }
/// From [w, x, y, z].
inline Quaternion quaternion(const nlohmann::json& q) {
  return Quaternion(q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>(), q.at(3).get<double>())
      .normalized();
}

inline Vector3 random_vector(Rng& rng, double size) {
  return {rng.uniform(-size, size), rng.uniform(-size, size), rng.uniform(-size, size)};
}

/// Rotation vector and position with entries up to the sizes given.
inline Pose random_pose(Rng& rng, double turn, double shift) {
  return {exp_rotation(random_vector(rng, turn)), random_vector(rng, shift)};
}

/// Symmetric and positive definite, with blocks in the size of a real cup: kN/m, tens of N, Nm/rad.
inline Matrix6 random_stiffness(Rng& rng) {
  Matrix6 A;
  for (int i = 0; i < 36; ++i) A(i / 6, i % 6) = rng.uniform(-1.0, 1.0);
  Vector6 scale;
  scale << 60.0, 60.0, 60.0, 2.0, 2.0, 2.0;
  const Matrix6 spd = A * A.transpose() + Matrix6::Identity();
  return scale.asDiagonal() * spd * scale.asDiagonal();
}

/// Central difference of fourth order of f at zero.
template <class F>
auto difference(const F& f, double h) -> decltype(f(h)) {
  return ((8.0 * (f(h) - f(-h)) - (f(2.0 * h) - f(-2.0 * h))) / (12.0 * h));
}

}  // namespace snug::cup::test
