// EstimatorSettings: every number that the estimation of boxes was tuned with, its unit and where it comes from.
#pragma once

namespace snug::box_estimation {

/// Where a number comes from.
enum class Basis {
  Derived,  ///< follows from geometry, from other settings, or from a probability, as said
  Chosen,   ///< by hand on disturbed frames of `snug bench camera`, seeds below 50000 (docs/camera.md, Figures, where
            ///< seeds from 50000 on judge); settings_sweep_test.cpp has each a tenth off
};

// Each struct lists its fields once: name, value, unit, basis, and the reason. `Archive` is called with these five.

/// Which boxes are where they are believed to be, which are doubted, and which were seen at all.
struct TrackingSettings {
  int least_points = 150;
  double least_part_on = 0.6;
  double least_part_on_after = 0.85;
  double least_of_pixels = 0.08;
  double most_spread = 0.015;
  double least_visible = 0.04;
  double least_frame_part = 0.5;
  double most_above = 0.5;
  double most_high_above = 0.25;
  double most_tolerance = 0.02;
  double least_tolerance = 6e-3;
  double least_fit_tolerance = 2.5e-3;
  double least_gone = 0.7;
  double part_that_tells = 0.15;
  double taken_overlap = 0.01;
  double over_rim = 0.12;
  int most_rounds = 4;
  double doubtful_part_on = 0.97;
  double doubtful_misfit = 3e-3;
  double doubtful_deviations = 4.0;
  double doubtful_overlap = 6e-3;

  template <class Archive>
  void fields(Archive& a) {
    a("least_points", least_points, "px", Basis::Chosen,
      "on a box, to say that it was seen: 12 mm x 12 mm at 1 mm a pixel");
    a("least_part_on", least_part_on, "1", Basis::Chosen,
      "of the points where a box should be, to fit it from its belief");
    a("least_part_on_after", least_part_on_after, "1", Basis::Chosen, "the same after the fit: what is left is noise");
    a("least_of_pixels", least_of_pixels, "1", Basis::Chosen, "of the pixels where a box should be seen");
    a("most_spread", most_spread, "m", Basis::Chosen, "standard deviation: a pose less sure than this was not seen");
    a("least_visible", least_visible, "1", Basis::Chosen, "of what a box would show alone");
    a("least_frame_part", least_frame_part, "1", Basis::Chosen, "of pixels with a point, or the frame is not used");
    a("most_above", most_above, "1", Basis::Chosen, "of pixels with points above the region: the view is blocked");
    a("most_high_above", most_high_above, "1", Basis::Chosen, "the same where no box can lie: beyond over_rim");
    a("most_tolerance", most_tolerance, "m", Basis::Chosen, "of a face from where it was believed to be");
    a("least_tolerance", least_tolerance, "m", Basis::Chosen, "added to it, where the camera's errors are less");
    a("least_fit_tolerance", least_fit_tolerance, "m", Basis::Chosen,
      "of a face after the fit, where the camera's errors are less");
    a("least_gone", least_gone, "1", Basis::Chosen, "of a place that tells: it is empty");
    a("part_that_tells", part_that_tells, "1", Basis::Chosen, "of what a box would show alone, to say so");
    a("taken_overlap", taken_overlap, "m", Basis::Chosen, "of solids: one of them is not there");
    a("over_rim", over_rim, "m", Basis::Chosen, "so high over the region boxes are looked for (decision 0031)");
    a("most_rounds", most_rounds, "", Basis::Chosen, "of looking for lost boxes: those that are found uncover others");
    a("doubtful_part_on", doubtful_part_on, "1", Basis::Chosen, "seen through by more: it may be another box");
    a("doubtful_misfit", doubtful_misfit, "m", Basis::Chosen,
      "of sides: too long or short by more, it may be another box");
    a("doubtful_deviations", doubtful_deviations, "1", Basis::Derived,
      "standard deviations from the belief: 1 of 16 000");
    a("doubtful_overlap", doubtful_overlap, "m", Basis::Chosen, "so deep in a box that was found");
  }
  bool operator==(const TrackingSettings&) const = default;
};

/// Planes through the points of a face.
struct FaceSettings {
  int border = 2;
  int least_points = 40;
  double bias_left = 0.15;
  double side_bias_left = 0.5;
  double side_facing = 0.7;
  double most_tilt = 0.15;

  template <class Archive>
  void fields(Archive& a) {
    a("border", border, "px", Basis::Chosen, "points nearer to the end of what is seen of a face are left out");
    a("least_points", least_points, "px", Basis::Chosen, "on a face that is fitted");
    a("bias_left", bias_left, "1", Basis::Chosen,
      "part of the interreflection's bias that stays: faces end at corners here and there");
    a("side_bias_left", side_bias_left, "1", Basis::Chosen,
      "the same of faces seen from the side: their lower ends are corners with what the box stands on");
    a("side_facing", side_facing, "1", Basis::Chosen,
      "cosine to the view below which a face is one seen from the side");
    a("most_tilt", most_tilt, "rad", Basis::Derived,
      "three times a belief's spread: what is tilted more is a strip of points of something else");
  }
  bool operator==(const FaceSettings&) const = default;
};

/// Where faces end.
struct EdgeSettings {
  double inset = 0.04;
  int least_lines = 8;
  double least_part = 0.35;
  int window = 3;
  double offset_error = 0.12;
  double drift_error = 0.2;
  int widest_shadow = 40;
  int least_pixels_of_face = 200;
  double least_facing = 0.5;
  double ridge_error = 0.3;

  template <class Archive>
  void fields(Archive& a) {
    a("inset", inset, "1", Basis::Chosen, "of an edge's length, left out at either end");
    a("least_lines", least_lines, "px", Basis::Chosen, "across an edge, on which its end is seen");
    a("least_part", least_part, "1", Basis::Chosen, "of the lines across an edge on which its end has to be seen");
    a("window", window, "samples", Basis::Chosen, "around an edge once it is known roughly");
    a("offset_error", offset_error, "samples", Basis::Chosen, "of what all lines of an edge have in common");
    a("drift_error", drift_error, "px", Basis::Chosen, "of the drift across the grid that a fit finds");
    a("widest_shadow", widest_shadow, "px", Basis::Chosen, "of no points, in which what casts it is looked for");
    a("least_pixels_of_face", least_pixels_of_face, "px", Basis::Chosen,
      "of a face whose edges are looked for, or behind a ridge");
    a("least_facing", least_facing, "1", Basis::Derived,
      "cosine to the view: on flatter faces pixels are more than twice as long");
    a("ridge_error", ridge_error, "1", Basis::Chosen, "of how far points count as a face's own behind a ridge");
  }
  bool operator==(const EdgeSettings&) const = default;
};

/// Gauss-Newton on all of them.
struct FitSettings {
  double overlap = 1.0e-3;
  double deepest_overlap = 0.03;
  double wide_gate_from_belief = 0.025;
  double wide_gate = 0.008;
  double gate_from_belief = 0.006;
  double gate_rough = 0.004;
  double gate = 0.0015;
  int reach_rough = 16;
  int reach_near = 9;
  int reach = 7;

  template <class Archive>
  void fields(Archive& a) {
    a("overlap", overlap, "m", Basis::Chosen,
      "how far solids may overlap, a standard deviation: soft boxes give way by about that");
    a("deepest_overlap", deepest_overlap, "m", Basis::Chosen,
      "deeper, another box is thought to be there: not pushed apart");
    a("wide_gate_from_belief", wide_gate_from_belief, "m", Basis::Derived, "of the first step: 2.5 spreads of 10 mm");
    a("wide_gate", wide_gate, "m", Basis::Chosen, "of the second");
    a("gate_from_belief", gate_from_belief, "m", Basis::Chosen,
      "of points from the offset that most agree on, first step");
    a("gate_rough", gate_rough, "m", Basis::Chosen, "second step");
    a("gate", gate, "m", Basis::Chosen, "later, where four deviations of a point are less");
    a("reach_rough", reach_rough, "px", Basis::Chosen,
      "on either side of where an edge should be, until the last but one");
    a("reach_near", reach_near, "px", Basis::Chosen, "in the last step but one");
    a("reach", reach, "px", Basis::Chosen, "in the last");
  }
  bool operator==(const FitSettings&) const = default;
};

/// Rough poses of boxes that are not where they were.
struct SearchSettings {
  int block = 6;
  double same_normal = 0.985;
  int least_blocks = 6;
  double fit = 0.007;
  double size_error = 0.0020;
  int samples = 14;
  double least_part = 0.75;
  double least_score = 6e-4;
  double unexplained = 1.5e-3;
  double rim = 0.05;
  int most_poses = 12;
  double same_place = 0.006;
  double same_turn = 0.08;
  double touch = 0.006;
  double in_the_air = 0.6;

  template <class Archive>
  void fields(Archive& a) {
    a("block", block, "px", Basis::Chosen, "side of the blocks that patches grow from");
    a("same_normal", same_normal, "1", Basis::Chosen, "cosine between neighbouring blocks of a patch: 10 degrees");
    a("least_blocks", least_blocks, "", Basis::Chosen, "of a patch");
    a("fit", fit, "m", Basis::Chosen, "by so much a patch may be wider or narrower than a face");
    a("size_error", size_error, "m", Basis::Chosen, "of the side of a rectangle around a patch, a standard deviation");
    a("samples", samples, "", Basis::Chosen, "a side, of a face that is compared with the frame");
    a("least_part", least_part, "1", Basis::Chosen, "of the points where a proposed box should be");
    a("least_score", least_score, "m^2", Basis::Chosen, "area of a proposed box that agrees with the frame");
    a("unexplained", unexplained, "m", Basis::Chosen, "beyond the tolerance of fitted faces");
    a("rim", rim, "m", Basis::Chosen, "beside the region: boxes may lie on its rim");
    a("most_poses", most_poses, "", Basis::Chosen, "that are proposed of a box: each costs a fit");
    a("same_place", same_place, "m", Basis::Chosen, "poses that are not proposed twice");
    a("same_turn", same_turn, "rad", Basis::Chosen, "the same of turns");
    a("touch", touch, "m", Basis::Chosen, "beyond this gap things do not touch");
    a("in_the_air", in_the_air, "1", Basis::Chosen, "likeliness of a place where a box touches nothing");
  }
  bool operator==(const SearchSettings&) const = default;
};

/// Which of the proposed poses boxes have, all together.
struct RelocationSettings {
  double spread = 0.012;
  double turn = 0.05;
  int fit_steps = 4;
  int fit_steps_from_belief = 6;
  int margin = 20;
  int least_points = 150;
  double least_part_there = 0.8;
  double most_overlap = 0.02;
  int most_tries = 100'000;
  double seen_through = 1.0;
  double least_gain = 300.0;
  double evidence = 800.0;
  double apart_error = 0.8e-3;
  double most_misfit = 6.0;
  double unseen = 1.0;
  double in_the_air = -0.5;
  double overlap_error = 4e-3;
  double most_overlapped = 2.0;
  double near = 0.3;
  double covered = 1.5;
  double elsewhere = 0.03;
  double in_place = 1.0;

  template <class Archive>
  void fields(Archive& a) {
    a("spread", spread, "m", Basis::Chosen,
      "how far a box may be from where a pose was proposed, a standard deviation");
    a("turn", turn, "rad", Basis::Chosen, "the same of turns: rectangles are turned in steps of 2 degrees");
    a("fit_steps", fit_steps, "", Basis::Chosen, "of Gauss-Newton from a proposed pose");
    a("fit_steps_from_belief", fit_steps_from_belief, "", Basis::Chosen, "from a belief");
    a("margin", margin, "px", Basis::Derived,
      "around a box that is fitted by itself: more than the reach of its edges");
    a("least_points", least_points, "px", Basis::Chosen, "on it");
    a("least_part_there", least_part_there, "1", Basis::Chosen, "of the points that tell whether it is there");
    a("most_overlap", most_overlap, "m", Basis::Chosen, "of boxes that are fitted one by one");
    a("most_tries", most_tries, "", Basis::Chosen, "combinations of places: a bound on time");
    a("seen_through", seen_through, "px", Basis::Chosen, "more than for others, for each point behind the box");
    a("least_gain", least_gain, "px", Basis::Chosen, "less explains nothing");
    a("evidence", evidence, "px", Basis::Chosen, "that one unit of log-likelihood weighs");
    a("apart_error", apart_error, "m", Basis::Chosen, "of how far apart opposite edges are seen, a standard deviation");
    a("most_misfit", most_misfit, "1", Basis::Chosen, "standard deviations: farther off is not less likely");
    a("unseen", unseen, "1", Basis::Chosen, "log-likelihood of a side of which not both ends are seen");
    a("in_the_air", in_the_air, "1", Basis::Chosen, "log-likelihood: it touches nothing");
    a("overlap_error", overlap_error, "m", Basis::Chosen, "of how deep a box is in another, a standard deviation");
    a("most_overlapped", most_overlapped, "1", Basis::Chosen, "standard deviations");
    a("near", near, "1", Basis::Chosen, "log-likelihood: at its old place, and turned as it was");
    a("covered", covered, "1", Basis::Chosen, "log-likelihood: its old place is not seen to be empty");
    a("elsewhere", elsewhere, "m", Basis::Chosen, "from its old place");
    a("in_place", in_place, "1", Basis::Chosen, "log-likelihood: fitted from its old place, or where it was tracked");
  }
  bool operator==(const RelocationSettings&) const = default;
};

/// What is neither box nor surroundings.
struct ObstacleSettings {
  int cell = 4;
  int least_points = 250;
  double alike = 0.006;
  int least_alike = 4;
  int largest_map = 2000;
  double unexplained = 2.5e-3;

  template <class Archive>
  void fields(Archive& a) {
    a("cell", cell, "px", Basis::Chosen,
      "side of the cells that clusters are made of: edges that a fit leaves over are thinner");
    a("least_points", least_points, "px", Basis::Derived, "of an obstacle: at 1 mm a pixel 16 mm x 16 mm");
    a("alike", alike, "m", Basis::Chosen, "of depths of neighbours on one surface");
    a("least_alike", least_alike, "", Basis::Chosen, "of 8 neighbours: half");
    a("largest_map", largest_map, "cells", Basis::Derived, "a side of the height map: 10 m, a bound on memory");
    a("unexplained", unexplained, "m", Basis::Chosen, "beyond the tolerance of fitted faces");
  }
  bool operator==(const ObstacleSettings&) const = default;
};

/// What a session has to know of a box, beside its pose.
struct FindingSettings {
  double moved_distance = 0.010;
  double moved_angle = 0.05235987755982988;
  double moved_deviations = 3.0;
  double leaning = 0.06981317007977318;
  double rim_slack = 0.005;
  double wrong_size = 3e-3;
  double wrong_size_deviations = 4.0;

  template <class Archive>
  void fields(Archive& a) {
    a("moved_distance", moved_distance, "m", Basis::Chosen,
      "and moved_deviations: it is not where it was believed to be");
    a("moved_angle", moved_angle, "rad", Basis::Chosen, "the same of turns: 3 degrees");
    a("moved_deviations", moved_deviations, "1", Basis::Derived, "of the belief: 1 of 370");
    a("leaning", leaning, "rad", Basis::Chosen, "no axis within 4 degrees of the vertical");
    a("rim_slack", rim_slack, "m", Basis::Chosen, "by which a box may reach over a wall without lying on it");
    a("wrong_size", wrong_size, "m", Basis::Chosen,
      "sides longer or shorter by this, and by wrong_size_deviations, are a finding");
    a("wrong_size_deviations", wrong_size_deviations, "1", Basis::Derived, "standard deviations: 1 of 16 000");
  }
  bool operator==(const FindingSettings&) const = default;
};

/// All of them. The defaults are for cameras of 1 mm a pixel over totes of 0.3 to 0.8 m with boxes of 40 mm and more.
struct EstimatorSettings {
  TrackingSettings tracking;
  FaceSettings faces;
  EdgeSettings edges;
  FitSettings fit;
  SearchSettings search;
  RelocationSettings relocation;
  ObstacleSettings obstacles;
  FindingSettings findings;

  /// `section(name, settings)` for each part.
  template <class Section>
  void sections(Section&& section) {
    section("tracking", tracking);
    section("faces", faces);
    section("edges", edges);
    section("fit", fit);
    section("search", search);
    section("relocation", relocation);
    section("obstacles", obstacles);
    section("findings", findings);
  }
  bool operator==(const EstimatorSettings&) const = default;
};

}  // namespace snug::box_estimation
