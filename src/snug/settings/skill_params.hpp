// SkillParams: how boxes are picked, turned, put into their places and carried: what a cell's owner may tune.
#pragma once

#include <numbers>

#include "snug/core/field.hpp"

namespace snug::settings {

/// From above.
struct PickParams {
  double seal_margin = 0.001;   ///< m, of the face around the cup's sealing disc, where the face has room for it
  double above_travel = 0.020;  ///< m, of the free cup's lip over the travel height, before
  double above_box = 0.030;     ///< m, of that lip over a box that was just let go
  double max_lean = 0.26;       ///< rad, from level: what leans more is picked to return it to the aligner alone
  double leaning_lift = 0.030;  ///< m, along the face's normal, before a box that leans is brought level

  template <class Archive>
  void fields(Archive& a) {
    a("seal_margin", seal_margin, Within{0.0, 0.1});
    a("above_travel", above_travel, Within{0.0, 1.0});
    a("above_box", above_box, Within{0.0, 1.0});
    a("max_lean", max_lean, Within{0.0, 0.8});
    a("leaning_lift", leaning_lift, Within{0.0, 0.5});
  }
  bool operator==(const PickParams&) const = default;
};

/// A face that looks sideways is picked, the tool nearly level, and turned up in the air.
struct SideGraspParams {
  double incline = 0.14;           ///< rad, from how far above level the tool comes: room for the arm
  double stand_off = 0.060;        ///< m, before the face
  double above_stand_off = 0.010;  ///< m, over that, at least, where the tool comes down to it
  double lip_clearance = 0.002;    ///< m, of the lip to what the box stands on, and left of the cup's overhang
  double least_lift = 0.020;       ///< m, at least, however low the box stands already
  double turn_clearance = 0.030;   ///< m, over the travel height where the box is turned up

  template <class Archive>
  void fields(Archive& a) {
    a("incline", incline, Within{0.0, 1.0});
    a("stand_off", stand_off, Within{0.0, 1.0});
    a("above_stand_off", above_stand_off, Within{0.0, 1.0});
    a("lip_clearance", lip_clearance, Within{0.0, 0.1});
    a("least_lift", least_lift, Within{0.0, 1.0});
    a("turn_clearance", turn_clearance, Within{0.0, 1.0});
  }
  bool operator==(const SideGraspParams&) const = default;
};

/// A box is put on a flat surface, to be picked there by another face.
struct SetDownParams {
  double press = 0.003;        ///< m, commanded below the surface before the box is let go
  double slow_height = 0.010;  ///< m, of the box over the surface, from where it goes down slowly
  double retreat = 0.030;      ///< m, of the tool over where it came from, after

  template <class Archive>
  void fields(Archive& a) {
    a("press", press, Within{0.0, 0.1});
    a("slow_height", slow_height, Within{0.0, 1.0});
    a("retreat", retreat, Within{0.0, 1.0});
  }
  bool operator==(const SetDownParams&) const = default;
};

/// A hanging box is turned a quarter over its lower edge on a flat surface and let go on the way (report Figure 13).
struct PivotParams {
  double tilt = 1.5708;  ///< rad, of the box before it is let go
  double drag = 0.32;    ///< m, how far the tool is sent back along the surface with the box
  /// m, of that before the box is let go: where the precision of TwistDrag is reached, at a speed that takes most of
  /// the push away that the cup gives when it lengthens.
  double dragged = 0.12;
  double press = 0.003;           ///< m, the edge is commanded below the surface
  double tilt_before = 0.6;       ///< fraction of the tilt with which the box comes down to the surface
  double height_before = 0.030;   ///< m, of its edge over the surface then
  double left_to_surface = 0.15;  ///< rad, of the tilt, for which the surface carries the box
  double retreat = 0.060;         ///< m, of the free cup over the lying box
  double surface_room = 0.16;     ///< m, from the middle of a lying box to the edges of its surface
  double surface_drag = 0.08;     ///< m, more on the side where it comes down

  template <class Archive>
  void fields(Archive& a) {
    a("tilt", tilt, Within{0.8, 1.7});
    a("drag", drag, Within{0.0, 1.0});
    a("dragged", dragged, Within{0.0, 1.0});
    a("press", press, Within{0.0, 0.1});
    a("tilt_before", tilt_before, Range::Fraction);
    a("height_before", height_before, Within{0.0, 1.0});
    a("left_to_surface", left_to_surface, Within{0.0, 0.8});
    a("retreat", retreat, Within{0.0, 1.0});
    a("surface_room", surface_room, Within{0.0, 2.0});
    a("surface_drag", surface_drag, Within{0.0, 2.0});
  }
  bool operator==(const PivotParams&) const = default;
};

/// One side of the box goes in first, between two near neighbours, and is levelled while it is pushed.
struct TiltedParams {
  double angle = 0.17;     ///< rad, of the box
  double depth = 0.015;    ///< m, how deep the low side goes below the edge of the slot before the box is levelled
  double push = 0.004;     ///< m, how far the box is pushed beyond its place meanwhile
  double taller = 0.030;   ///< m, a neighbour taller by this is what the box is pushed against
  double above = 0.012;    ///< m, of the low side over the edge of the slot, where it comes from the side
  double at_edge = 0.006;  ///< m, of the low side over the edge, where it is pushed

  template <class Archive>
  void fields(Archive& a) {
    a("angle", angle, Within{0.0, 0.8});
    a("depth", depth, Within{0.0, 0.5});
    a("push", push, Within{0.0, 0.1});
    a("taller", taller, Within{0.0, 1.0});
    a("above", above, Within{0.0, 1.0});
    a("at_edge", at_edge, Within{0.0, 1.0});
  }
  bool operator==(const TiltedParams&) const = default;
};

/// Into the place: straight down, beside it and then against the neighbours, or one side first.
struct InsertionParams {
  double near = 0.007;             ///< m, a neighbour nearer than this is met on the way down
  double least_neighbour = 0.012;  ///< m, what is lower over the box's lower face does not guide it
  double slide_room = 0.008;       ///< m, free length beside a place in which the box can come down and slide
  double slide_start = 0.010;      ///< m, how far beside its place it comes down, at most
  double slide_margin = 0.003;     ///< m, left to what is on the free side
  double slide_gap = 0.003;        ///< m, over its support while it slides
  double overtravel = 0.005;       ///< m, how far it is commanded beyond its place, into the neighbour
  double gentle = 0.4;             ///< fraction of the overtravel, of a second try with slow motions
  double press = 0.005;            ///< m, commanded below its support before it is let go
  double entry_clearance = 0.010;  ///< m, of the box over everything packed, where it stops before it goes down
  double least_drop = 0.010;       ///< m, from that stop to its support; nearer there is no stop
  double least_rise = 0.020;       ///< m, over its support where it comes over its place
  double retreat = 0.080;          ///< m, of the tool over where it came from, after
  double graze = 0.004;            ///< m, boxes that overlap by less in plan view neither carry nor stand beside
  double inside = 0.010;           ///< m, a neighbour's side may be believed this far inside the box
  TiltedParams tilted;

  template <class Archive>
  void fields(Archive& a) {
    a("near", near, Within{0.0, 0.1});
    a("least_neighbour", least_neighbour, Within{0.0, 1.0});
    a("slide_room", slide_room, Within{0.0, 0.5});
    a("slide_start", slide_start, Within{0.0, 0.5});
    a("slide_margin", slide_margin, Within{0.0, 0.5});
    a("slide_gap", slide_gap, Within{0.0, 0.1});
    a("overtravel", overtravel, Within{0.0, 0.1});
    a("gentle", gentle, Range::Fraction);
    a("press", press, Within{0.0, 0.1});
    a("entry_clearance", entry_clearance, Within{0.0, 1.0});
    a("least_drop", least_drop, Within{0.0, 1.0});
    a("least_rise", least_rise, Within{0.0, 1.0});
    a("retreat", retreat, Within{0.0, 1.0});
    a("graze", graze, Within{0.0, 0.1});
    a("inside", inside, Within{0.0, 0.1});
    a("tilted", tilted);
  }
  bool operator==(const InsertionParams&) const = default;
};

/// On a box that leans or sticks out, from above, the vacuum off.
struct PressParams {
  double depth = 0.030;      ///< m, beyond where an undeformed cup touches the highest corner
  double stand_off = 0.020;  ///< m, of the free cup over box and travel height, before and after
  double force = 60.0;       ///< N, force guard

  template <class Archive>
  void fields(Archive& a) {
    a("depth", depth, Within{0.0, 0.5});
    a("stand_off", stand_off, Within{0.0, 1.0});
    a("force", force, Within{0.0, 10000.0});
  }
  bool operator==(const PressParams&) const = default;
};

/// From place to place.
struct TravelParams {
  double clearance = 0.06;          ///< m, over what is crossed: more than the precision of waypoints passed on the fly
  double turning_clearance = 0.03;  ///< m, the same of fast motions, for a box that turns on its way
  double retreat = 0.020;           ///< m, of the free cup over the travel height, after a motion that was broken off
  /// m, straight ways nearer to the robot's first axis are led around it. The demonstrator's gripper comes within 0.1 m
  /// of the upper arm at 0.25 m, and the arm begins to give way 0.1 m before.
  double near_base = 0.34;
  double base_radius = 0.42;   ///< m, at which they are led around it
  double least_pan = 0.2;      ///< rad, of the first axis: a fast way that turns it less goes straight
  double least_radius = 0.20;  ///< m, nearer to the first axis the arm does not reach with the tool down
  /// rad, of the tool, of which the way round is sure: waypoints may be left 25 degrees early (precision 0.05 m).
  double sure_turn = 145.0 * std::numbers::pi / 180.0;
  double longest_turn = 1.5 * std::numbers::pi;  ///< rad, of a held box the longer way round
  /// m, of the free cup's lip over a box that fast motions let go, up to where the tool leaves slowly, blowing.
  double detach = 0.003;
  double shortest_swing = 0.1;  ///< s, periods of what hangs from the cup that fast motions avoid
  double longest_swing = 0.6;   ///< s, the same

  template <class Archive>
  void fields(Archive& a) {
    a("clearance", clearance, Within{0.0, 1.0});
    a("turning_clearance", turning_clearance, Within{0.0, 1.0});
    a("retreat", retreat, Within{0.0, 1.0});
    a("near_base", near_base, Within{0.0, 2.0});
    a("base_radius", base_radius, Within{0.0, 2.0});
    a("least_pan", least_pan, Within{0.0, 3.2});
    a("least_radius", least_radius, Within{0.0, 2.0});
    a("sure_turn_deg", Degrees{sure_turn}, Within{1.0, 179.0});
    a("longest_turn_deg", Degrees{longest_turn}, Within{180.0, 360.0});
    a("detach", detach, Within{0.0, 0.1});
    a("shortest_swing", shortest_swing, Within{0.01, 5.0});
    a("longest_swing", longest_swing, Within{0.01, 5.0});
  }
  bool operator==(const TravelParams&) const = default;
};

struct SkillParams {
  PickParams pick;
  SideGraspParams side_grasp;
  SetDownParams set_down;
  PivotParams pivot;
  InsertionParams insertion;
  PressParams press;
  TravelParams travel;

  template <class Archive>
  void fields(Archive& a) {
    a("pick", pick);
    a("side_grasp", side_grasp);
    a("set_down", set_down);
    a("pivot", pivot);
    a("insertion", insertion);
    a("press", press);
    a("travel", travel);
  }
  bool operator==(const SkillParams&) const = default;
};

}  // namespace snug::settings
