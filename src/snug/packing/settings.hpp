// PackingSettings: what a user can set about deciding where boxes go.
#pragma once

#include <cstdint>

namespace snug::packing {

struct PackingSettings {
  double decision_time = 0.5;  ///< s an item on one core of the reference machine: turned into a number of roll-outs
  std::uint64_t seed = 1;
  int threads = 1;          ///< results do not depend on it
  int max_candidates = 24;  ///< returned at most
  int max_flips = 1;        ///< of the agents that flip
  double margin = 0.020;    ///< m, agent `margin`: to boxes and walls
  /// m, each box is planned this much smaller than measured along Tx and Ty: boxes give way when pressed together.
  double planned_interference = 0.001;
  /// m, the same for a box that `contact-aware` has no place for otherwise; for callers that try a place before they
  /// count on it. Not more than `planned_interference`: such a box has no place.
  double last_interference = 0.0;
  double min_support = 0.6;    ///< part of the lower face that has to rest on something
  double com_margin = 0.005;   ///< m, the centre of mass stays inside the support polygon by this
  double level_slack = 0.003;  ///< m, tops that differ by less carry a box together
  /// Smallest standing breadth / height; slimmer boxes tumble. 0: no limit.
  double min_slenderness = 0.25;
  double max_item_mass = 8.0;   ///< kg, payload of the robot less its tool
  double min_pick_face = 0.05;  ///< m, shorter side of the upper face at least: the lip may overhang a little

  template <class Archive>
  void fields(Archive& a) {
    a("decision_time", decision_time);
    a("seed", seed);
    a("threads", threads);
    a("max_candidates", max_candidates);
    a("max_flips", max_flips);
    a("margin", margin);
    a("planned_interference", planned_interference);
    a("last_interference", last_interference);
    a("min_support", min_support);
    a("com_margin", com_margin);
    a("level_slack", level_slack);
    a("min_slenderness", min_slenderness);
    a("max_item_mass", max_item_mass);
    a("min_pick_face", min_pick_face);
  }
  bool operator==(const PackingSettings&) const = default;
};

}  // namespace snug::packing
