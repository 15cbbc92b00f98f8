// CellPlace: where the robot's base and the aligner can stand so that the tool reaches all that packing needs.
#pragma once

#include <string>
#include <vector>

#include "snug/model/scenario.hpp"
#include "snug/runs/program_check.hpp"

namespace snug::runs {

struct PlaceOptions {
  bool moves_robot = true;
  bool moves_height = true;  ///< of the base, with moves_robot
  bool moves_aligner = true;
  std::vector<std::string> stand_with_robot;  ///< static bodies that move with the base: a plinth
  int threads = 1;
  CheckOptions check;
};

/// A place of base and aligner, with what was found out there.
struct PlacedCell {
  Pose X_WB;                    ///< root link of the robot
  Pose X_WA;                    ///< aligner
  Pose X_WE_start;              ///< tool at its start, over the way from the aligner to the container
  std::vector<double> posture;  ///< rad (m), the joints there
  int reached = 0;              ///< of PlaceSearch::asked
  std::string missing;          ///< what keeps the tool from the first pose that is not reached; empty: nothing
  double margin = 0.0;  ///< m, how far pick and container could be moved before one of them is out of the arm's reach
  double travel = 0.0;  ///< m, from the middle of the picks to the middle of the container, level
};

struct PlaceSearch {
  std::string robot, container;
  int asked = 0;      ///< poses that are needed: see place_cell
  int tried = 0;      ///< places whose margins were computed
  PlacedCell before;  ///< the cell as it is
  /// At most five that were looked at pose by pose; the most poses reached first, then enough margin, then the shortest
  /// travel. Empty: the arm is too short for any.
  std::vector<PlacedCell> places;
  double reach = 0.0;  ///< m, of the tool, pointing down, from the arm's first axis
};

/// The poses that are needed: the tool straight down, as at its start and turned by a quarter, with a low box on the
/// container's floor, half way up, at the rim and with a high box over the rim, at 4 x 4 points where boxes can stand,
/// and at the picks and over them. A pose is reached where the arm, from joints that it starts with, passes all tests
/// of `snug check` along a straight way at its end. Places are found by how the reach of the arm depends on distance
/// and height from its first, vertical axis; then the best are looked at with all that stands in the cell, by the dozen
/// until one reaches everything, at most sixty. The aligner stays at its height, beside the container, on what it
/// stands on. Throws InputError for a scenario without robot, tool, aligner or target container, for a robot whose
/// first axis is not vertical, and for a body that is not there. The result does not depend on `threads`.
[[nodiscard]] PlaceSearch place_cell(const model::Scenario& scenario, const PlaceOptions& options);

/// The scenario's text with base, aligner, start and posture of a place; comments and layout stay.
[[nodiscard]] std::string write_place(const model::Scenario& scenario, const PlacedCell& place,
                                      const PlaceOptions& options);

[[nodiscard]] std::string format_json(const PlaceSearch& search);
/// For people.
[[nodiscard]] std::string format_table(const PlaceSearch& search);

}  // namespace snug::runs
