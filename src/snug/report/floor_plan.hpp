// FloorPlan: what stands in a cell, from above, with what a robot reaches.
#pragma once

#include <string>
#include <vector>

#include "snug/report/markup.hpp"
#include "snug/spatial/pose.hpp"

namespace snug::report {

enum class PlanInk {
  Ground,  ///< what others stand on
  Thing,   ///< what stands there
  Robot,
  Reached,
  Unreached,
};

struct PlanOutline {
  std::string name;                      ///< shown under the mouse
  std::vector<Eigen::Vector2d> corners;  ///< m, in the order of a walk around it
  PlanInk ink = PlanInk::Thing;
  bool is_labelled = false;  ///< its name stands over it
};

struct PlanDot {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< m
  PlanInk ink = PlanInk::Reached;
  std::string about;
};

struct PlanCircle {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  ///< m
  double radius = 0.0;                               ///< m
  std::string about;
};

struct FloorPlan {
  std::string about;  ///< for those who do not see it
  std::vector<PlanOutline> outlines;
  std::vector<PlanCircle> circles;
  std::vector<PlanDot> dots;
};

/// x to the right, y upwards, to scale, with a bar of half a metre. What comes first is drawn below the rest.
[[nodiscard]] Markup floor_plan(const FloorPlan& plan);

}  // namespace snug::report
