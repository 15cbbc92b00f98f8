// Session settings: by what rules a session decides, rehearses, believes and recovers: what a cell's owner may tune.
// What a run alone decides (agent, seeds, threads, samples, time) is in packing::DecisionRun and
// session::SessionOptions.
#pragma once

#include <numbers>

#include "snug/core/field.hpp"

namespace snug::settings {

/// Where a box may go.
struct PackingSettings {
  int max_candidates = 24;  ///< returned at most
  int max_flips = 1;        ///< of the agents that flip
  double margin = 0.020;    ///< m, agent `margin`: to boxes and walls
  /// m, each box is planned this much smaller than measured along Tx and Ty: boxes give way when pressed together.
  double planned_interference = 0.001;
  /// m, the same for a box that `contact-aware` has no place for otherwise, where every place is tried before it counts
  /// (sessions). Not more than `planned_interference`: such a box has no place.
  double last_interference = 0.003;
  double min_support = 0.6;    ///< part of the lower face that has to rest on something
  double com_margin = 0.005;   ///< m, the centre of mass stays inside the support polygon by this
  double level_slack = 0.003;  ///< m, tops that differ by less carry a box together
  /// Smallest standing breadth / height; slimmer boxes tumble. 0: no limit.
  double min_slenderness = 0.25;
  double max_item_mass = 8.0;   ///< kg, payload of the robot less its tool
  double min_pick_face = 0.05;  ///< m, shorter side of the upper face at least: the lip may overhang a little

  template <class Archive>
  void fields(Archive& a) {
    a("max_candidates", max_candidates, Within{1, 1000});
    a("max_flips", max_flips, Within{0, 2});
    a("margin", margin, Within{0.0, 1.0});
    a("planned_interference", planned_interference, Within{0.0, 0.010});
    a("last_interference", last_interference, Within{0.0, 0.010});
    a("min_support", min_support, Range::Fraction);
    a("com_margin", com_margin, Within{0.0, 0.1});
    a("level_slack", level_slack, Within{0.0, 0.05});
    a("min_slenderness", min_slenderness, Within{0.0, 10.0});
    a("max_item_mass", max_item_mass, Within{0.0, 1.0e6});
    a("min_pick_face", min_pick_face, Within{0.0, 10.0});
  }
  bool operator==(const PackingSettings&) const = default;
};

/// When an item counts as placed.
struct PlaceLimits {
  double position = 0.020;                       ///< m, level distance from where it was planned
  double tilt = 6.0 * std::numbers::pi / 180.0;  ///< rad, from how it was planned
  double displacement = 0.020;                   ///< m, of a box that was there before
  double force = 150.0;                          ///< N, of the cup on the box: an attempt is given up
  /// How many times its load the cup must be able to hold, all the way; of fast motions only. Plants differ from
  /// rehearsals: more than the 2 that is to be kept.
  double hold_factor = 2.2;
  double hold_guard = 2.1;  ///< the same, as sensed in the plant: below, the motion ends

  template <class Archive>
  void fields(Archive& a) {
    a("position", position, Within{0.0, 1.0});
    a("tilt_deg", Degrees{tilt}, Within{0.0, 90.0});
    a("displacement", displacement, Within{0.0, 1.0});
    a("force", force, Within{0.0, 10000.0});
    a("hold_factor", hold_factor, Within{0.0, 1000.0});
    a("hold_guard", hold_guard, Within{0.0, 1000.0});
  }
  bool operator==(const PlaceLimits&) const = default;
};

/// How attempts are tried before one is sent.
struct RehearsalSettings {
  double accepted_rate = 1.0;  ///< success rate at which an attempt is sent at once
  double good_rate = 0.8;      ///< after `max_attempts`
  double least_rate = 0.5;     ///< below it not even the best attempt is sent
  int max_attempts = 10;       ///< for an item: candidates times insertions
  int most_attempts = 24;      ///< where none was good
  int first_samples = 3;       ///< rehearsed before the others: where most of these fail the others are not asked
  double rest = 0.4;           ///< s, after the last waypoint, before the result is looked at
  int coarse_steps = 2;        ///< physics steps of rollouts are so many times the scenario's, where the tick allows it
  /// Success expected of a motion before anything is rehearsed. From sessions in plants 101 and up.
  double prior_rate = 0.97;
  double prior_count = 4.0;  ///< how many rollouts that is worth; from the same sessions
  /// Percent of the container, fast motions alone: taken off what a place is expected to fill when the box has to be
  /// set down for it to be turned, and when it has to be picked by a side.
  double reorientation_cost = 1.5;
  double side_grasp_cost = 0.5;

  template <class Archive>
  void fields(Archive& a) {
    a("accepted_rate", accepted_rate, Range::Fraction);
    a("good_rate", good_rate, Range::Fraction);
    a("least_rate", least_rate, Range::Fraction);
    a("max_attempts", max_attempts, Within{1, 10000});
    a("most_attempts", most_attempts, Within{1, 10000});
    a("first_samples", first_samples, Within{0, 10000});
    a("rest", rest, Within{0.0, 60.0});
    a("coarse_steps", coarse_steps, Within{1, 16});
    a("prior_rate", prior_rate, Range::Fraction);
    a("prior_count", prior_count, Within{0.0, 10000.0});
    a("reorientation_cost", reorientation_cost, Within{0.0, 100.0});
    a("side_grasp_cost", side_grasp_cost, Within{0.0, 100.0});
  }
  bool operator==(const RehearsalSettings&) const = default;
};

/// How worlds are weighed and what is believed of boxes that are not seen.
struct BeliefParams {
  double rest = 0.3;           ///< s, boxes come to rest after they were put where they were seen
  double model_error = 0.004;  ///< m, what a good world may be off: contact on rough cardboard repeats to no less
  double least_weight = 0.25;  ///< of the mean, below which no world's weight falls: one surprise rules out no world
  double unseen_position = 0.005;  ///< m, standard deviation of what was not seen
  double unseen_rotation = 0.02;   ///< rad, the same
  /// Boxes are so many times as stiff as was believed, after an insertion that succeeded in the nominal rollout and was
  /// ended by load in the plant.
  double stiffer = 2.0;
  double stiffest = 4.0;  ///< times what the scenario says, at most

  template <class Archive>
  void fields(Archive& a) {
    a("rest", rest, Within{0.0, 60.0});
    a("model_error", model_error, Within{1e-6, 1.0});
    a("least_weight", least_weight, Range::Fraction);
    a("unseen_position", unseen_position, Within{0.0, 1.0});
    a("unseen_rotation", unseen_rotation, Within{0.0, 1.6});
    a("stiffer", stiffer, Within{1.0, 100.0});
    a("stiffest", stiffest, Within{1.0, 1000.0});
  }
  bool operator==(const BeliefParams&) const = default;
};

/// When something went wrong, and how long it is made up for.
struct RecoverySettings {
  int most_tries = 4;                            ///< motions that are sent for one item, those of recoveries included
  int skips = 2;                                 ///< items without a place that are skipped before the session ends
  int most_rounds = 12;                          ///< of remedies for one motion
  int most_stops = 3;                            ///< protective stops of one item; then the session ends
  int most_pictures = 3;                         ///< that tell nothing, one after the other
  double lies_turned = 0.25 * std::numbers::pi;  ///< rad, from what was planned: it takes room meant for others
  /// Percent of the container: a moved box is picked again where the filling expected in the end is larger by more than
  /// this with the box in another place.
  double gain_elsewhere = 1.0;
  double as_rehearsed = 0.004;        ///< m, from where the nominal rollout let the box go on the way
  double turned_as_rehearsed = 0.05;  ///< rad, from how it lay there
  /// m: edges that differ by more are another item's. Tapes and damp make 2 mm of the demonstrator's.
  double wrong_size = 0.010;
  double return_distance =
      0.025;                  ///< m, from both plates of the aligner: where a box that is returned to it is put down
  double at_aligner = 0.050;  ///< m, from where it was seen to arrive: still against the plates
  double on_bench = 0.200;    ///< m, level, from the middle of the surface where boxes are turned
  double on_surface = 0.030;  ///< m, of its lower face over that surface
  double under_obstacle = 0.005;  ///< m, an obstacle that shares less with a box in plan view is beside it
  double footprint = 0.030;       ///< m, a middle so far beyond the walls still is the container's affair

  template <class Archive>
  void fields(Archive& a) {
    a("most_tries", most_tries, Within{1, 1000});
    a("skips", skips, Within{0, 100000});
    a("most_rounds", most_rounds, Within{1, 1000});
    a("most_stops", most_stops, Within{0, 1000});
    a("most_pictures", most_pictures, Within{1, 1000});
    a("lies_turned_deg", Degrees{lies_turned}, Within{0.0, 180.0});
    a("gain_elsewhere", gain_elsewhere, Within{0.0, 100.0});
    a("as_rehearsed", as_rehearsed, Within{0.0, 1.0});
    a("turned_as_rehearsed", turned_as_rehearsed, Within{0.0, 3.2});
    a("wrong_size", wrong_size, Within{0.0, 1.0});
    a("return_distance", return_distance, Within{0.0, 1.0});
    a("at_aligner", at_aligner, Within{0.0, 1.0});
    a("on_bench", on_bench, Within{0.0, 2.0});
    a("on_surface", on_surface, Within{0.0, 1.0});
    a("under_obstacle", under_obstacle, Within{0.0, 1.0});
    a("footprint", footprint, Within{0.0, 1.0});
  }
  bool operator==(const RecoverySettings&) const = default;
};

/// What ends a motion, and when the cell is at rest after one, for every plant whose robot moves tick by tick.
struct MotionGuards {
  double needed_vacuum = 0.3;       ///< share of the vacuum's set point that counts as a seal
  double seal_patience = 0.45;      ///< s, with the vacuum on, until there is a seal
  double waypoint_patience = 60.0;  ///< s, for one waypoint
  double still_speed = 0.003;       ///< m/s, a tool that is slower stands
  double lagged_settle = 0.3;       ///< s, after a motion, at least, of a tool that comes in with a lag
  /// s, the same of one that stands when it arrives, so that boxes have rested since it left them.
  double exact_settle = 0.1;
  double longest_settle = 2.0;  ///< s, at most

  template <class Archive>
  void fields(Archive& a) {
    a("needed_vacuum", needed_vacuum, Range::Fraction);
    a("seal_patience", seal_patience, Within{0.0, 60.0});
    a("waypoint_patience", waypoint_patience, Within{0.1, 3600.0});
    a("still_speed", still_speed, Within{1e-6, 1.0});
    a("lagged_settle", lagged_settle, Within{0.0, 60.0});
    a("exact_settle", exact_settle, Within{0.0, 60.0});
    a("longest_settle", longest_settle, Within{0.0, 600.0});
  }
  bool operator==(const MotionGuards&) const = default;
};

}  // namespace snug::settings
