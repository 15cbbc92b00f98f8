// What the report states of the real experiment, to set our figures beside.
#include "snug/validation/reported.hpp"

#include <numbers>

namespace snug::validation {

const Means& reported_means() {
  constexpr double kDegree = std::numbers::pi / 180.0;
  static const Means means = {8.50e-3, 1.77 * kDegree, 23.46e-3, 3.12 * kDegree, 20.15, 1.48, 54};
  return means;
}

const std::vector<KeyMoment>& key_moments() {
  static const std::vector<KeyMoment> moments = {
      {"1", "Box016", "flipping"}, {"1", "Box018", "packing"}, {"2", "Box026", "flipping"}, {"2", "Box028", "packing"},
      {"3", "Box025", "flipping"}, {"3", "Box028", "packing"}, {"4", "Box029", "packing"},  {"4", "Box015", "packing"},
      {"5", "Box014", "packing"},  {"5", "Box027", "packing"}};
  return moments;
}

}  // namespace snug::validation
