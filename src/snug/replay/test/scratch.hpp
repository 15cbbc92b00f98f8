// Scratch files and a small made-up run for the tests of this module.
#pragma once

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "snug/core/rng.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/record/recording.hpp"

namespace snug::replay::test {

using snug::test::ScratchFolder;

inline Vector3 random_vector(Rng& rng, double scale) {
  return {rng.uniform(-scale, scale), rng.uniform(-scale, scale), rng.uniform(-scale, scale)};
}

inline record::PoseSample random_pose(Rng& rng) {
  return {random_vector(rng, 2.0), Quaternion(rng.normal(), rng.normal(), rng.normal(), rng.normal()).normalized()};
}

inline record::BodyInfo body_info(const std::string& name, record::BodyKind kind, const record::ShapeInfo& shape) {
  record::BodyInfo body;
  body.name = name;
  body.kind = kind;
  if (kind == record::BodyKind::Dynamic) body.type = "B1";
  if (kind == record::BodyKind::Dynamic) body.mass = 0.5;
  body.shapes = {shape};
  return body;
}

/// A table (static), a tool (kinematic) and two boxes, of which the second comes late; poses at random, so that every
/// number differs from frame to frame.
inline record::Recording random_recording(Rng& rng, int frames) {
  record::Recording recording;
  record::ShapeInfo box, capsule, hull, cylinder;
  box.half = {0.1, 0.2, 0.05};
  capsule.kind = record::ShapeKind::Capsule;
  capsule.radius = 0.02;
  capsule.half_length = 0.1;
  hull.kind = record::ShapeKind::Hull;
  hull.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  cylinder.kind = record::ShapeKind::Cylinder;
  cylinder.radius = 0.03;
  cylinder.half_length = 0.2;
  record::RecordingHeader& header = recording.header;
  header.bodies = {
      body_info("table", record::BodyKind::Static, box), body_info("tool", record::BodyKind::Kinematic, capsule),
      body_info("BOX001", record::BodyKind::Dynamic, box), body_info("BOX002", record::BodyKind::Dynamic, hull)};
  header.bodies[0].shapes.push_back(cylinder);  // a leg of the table
  header.dt = 0.001;
  header.record_period = 0.008;
  header.seed = 18446744073709551615U;
  header.version = "0.1.0";
  header.sequence = "1";
  for (int i = 0; i < frames; ++i) {
    record::Frame frame;
    frame.time = 0.008 * (i + 1);
    frame.step = 8 * (i + 1);
    frame.program_row = i / 10;
    frame.X_WE = random_pose(rng);
    frame.X_WE_command = random_pose(rng);
    frame.V_WE = {random_vector(rng, 1.0), random_vector(rng, 1.0)};
    frame.cup.vacuum_command = i % 3 == 0;
    frame.cup.attached_body = i % 4 == 0 ? 2 : -1;
    frame.cup.pressure_gauge = rng.uniform(-6e4, 0.0);
    frame.cup.X_ES = random_pose(rng);
    frame.cup.length = rng.uniform(0.04, 0.08);
    frame.cup.bend = rng.uniform(0.0, 0.5);
    frame.cup.F_PSo_S = {random_vector(rng, 100.0), random_vector(rng, 5.0)};
    frame.F_flange = {random_vector(rng, 100.0), random_vector(rng, 5.0)};
    frame.solver = {rng.uniform(0.0, 1e-5), rng.index(50), static_cast<record::SolverStatus>(rng.index(4))};
    frame.bodies.resize(4);
    for (record::BodySample& body : frame.bodies) body.X_WB = random_pose(rng);
    frame.bodies[0].X_WB = record::PoseSample();
    frame.bodies[3].present = i >= frames / 2;
    for (int k = 0; k < (i % 5 == 0 ? 0 : 6); ++k) {
      record::ContactSample contact;
      contact.body_a = k < 2 ? 0 : 2;
      contact.body_b = k < 2 ? 2 : 1;
      Rng still = Rng(static_cast<std::uint64_t>(k < 2 ? k : 100 + i / 3 + k)).split("contact");  // some rest
      contact.p_WQ = random_vector(still, 1.0);
      contact.n_AB_W = random_vector(still, 1.0).normalized();
      contact.force_B_W = random_vector(still, 50.0);
      contact.phi = still.uniform(-1e-3, 1e-3);
      contact.state = static_cast<record::ContactState>(still.index(4));
      frame.contacts.push_back(contact);
    }
    recording.frames.push_back(std::move(frame));
  }
  recording.events = {{0.1, "seal", "BOX001", "sealed", {{"offset_mm", 1.5}}},
                      {0.2, "release", "BOX001", "let go", {}},
                      {0.3, "seal", "BOX002", "sealed", {}}};
  return recording;
}

/// The same with the two joints of an arm.
inline record::Recording random_robot_recording(Rng& rng, int frames) {
  record::Recording recording = random_recording(rng, frames);
  recording.header.joints = {"shoulder", "elbow"};
  for (record::Frame& frame : recording.frames) {
    for (int i = 0; i < 2; ++i) frame.joints.push_back({rng.normal(), rng.normal(), 100.0 * rng.normal()});
  }
  return recording;
}

}  // namespace snug::replay::test
