// Jammed boxes: scenes on which sweeps over the contacts converge slowly.
#pragma once

#include <array>

#include "scene.hpp"

namespace snug::physics::test {

/// Bodies 0-4: container of 570 x 370 x 250 mm. Two rows of three boxes lie in it with `slack` of play in all across
/// the width, and a seventh box stands tilted in the gap between the rows, pressed down.
inline WorldModel jammed_boxes(double slack) {
  const double width = 0.5 * (0.37 - 0.1 - slack);
  std::vector<BodyModel> boxes;
  for (int i = 0; i < 6; ++i) {
    const double side = i < 3 ? -1.0 : 1.0;
    const Vector3 size(0.18, width, 0.12);
    boxes.push_back(box(size, 0.4, {0.185 * (i % 3 - 1), side * (0.185 - 0.5 * width), 0.06}));
  }
  boxes.push_back(box({0.3, 0.1, 0.1}, 0.5, {0.0, 0.0, 0.19}));
  boxes.back().X_WB.R = exp_rotation(Vector3(0.15, 0.0, 0.0));
  WorldModel model = in_container(boxes);
  for (ContactLaw& law : model.laws) law.restitution = 0.0;
  return model;
}

/// Presses the seventh box down.
struct Press {
  std::array<ExternalWrench, 1> wrenches;
  explicit Press(double force) { wrenches[0] = {BodyId{11}, {Vector3(0.0, 0.0, -force), Vector3::Zero()}}; }
  [[nodiscard]] WorldInput input() const {
    WorldInput input;
    input.wrenches = wrenches;
    return input;
  }
};

}  // namespace snug::physics::test
