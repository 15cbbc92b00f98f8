// Random recordings and scratch files for the tests of this module.
#pragma once

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "snug/core/rng.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/record/recording.hpp"

namespace snug::record::test {

using snug::test::ScratchFolder;

inline Vector3 random_vector(Rng& rng, double scale) {
  return {rng.uniform(-scale, scale), rng.uniform(-scale, scale), rng.uniform(-scale, scale)};
}

inline PoseSample random_pose(Rng& rng) {
  Quaternion quat(rng.normal(), rng.normal(), rng.normal(), rng.normal());
  return {random_vector(rng, 2.0), quat.normalized()};
}

/// A multiple of `quantum` below 2^24 quanta: what the file keeps exactly.
inline double on_grid(double value, double quantum) { return std::round(value / quantum) * quantum; }

inline Vector3 on_grid(const Vector3& v, double quantum) {
  return {on_grid(v.x(), quantum), on_grid(v.y(), quantum), on_grid(v.z(), quantum)};
}

inline ContactSample random_contact(Rng& rng, int bodies) {
  ContactSample contact;
  contact.body_a = rng.index(bodies);
  contact.body_b = rng.index(bodies);
  contact.p_WQ = on_grid(random_vector(rng, 2.0), kPointQuantum);
  contact.n_AB_W = on_grid(random_vector(rng, 1.0).normalized(), kPointQuantum);
  contact.force_B_W = on_grid(random_vector(rng, 300.0), kForceQuantum);
  contact.phi = on_grid(rng.uniform(-1e-3, 1e-3), kGapQuantum);
  contact.state = static_cast<ContactState>(rng.index(4));
  return contact;
}

inline BodyInfo random_body(Rng& rng, int number) {
  BodyInfo body;
  body.name = std::string("BOX0").append(std::to_string(10 + number));
  body.type = number % 2 == 0 ? "B1" : "";
  body.kind = static_cast<BodyKind>(2 - number % 3);
  body.mass = rng.uniform(0.2, 2.0);
  body.com = random_vector(rng, 0.05);
  for (int i = 0; i < number % 4; ++i) {
    ShapeInfo shape;
    shape.kind = static_cast<ShapeKind>(i % 4);
    shape.X_BG = random_pose(rng);
    shape.half = random_vector(rng, 0.2);
    shape.radius = rng.uniform();
    shape.half_length = rng.uniform();
    for (int v = 0; v < 5 * (i % 3); ++v) shape.vertices.push_back(random_vector(rng, 0.3));
    body.shapes.push_back(shape);
  }
  return body;
}

inline RecordingHeader random_header(Rng& rng, int bodies) {
  RecordingHeader header;
  header.scenario_text = "gravity: [0, 0, -9.81]\n# \xC2\xB5 = 0.2\n";
  header.program_text = ".1,.2,.3,0,0,0,PrePick013,0,0,0,0,0,0";
  header.program_name = "poses.csv";
  header.sequence = "1";
  header.seed = rng.next();
  header.version = "0.1.0 test";
  header.settings = R"({"cup": "phases"})";
  header.dt = 0.004;
  header.record_period = 0.008;
  for (int i = 0; i < bodies; ++i) header.bodies.push_back(random_body(rng, i));
  for (int i = bodies; i > 1; --i) header.joints.push_back("joint " + std::to_string(i));
  header.container = {"tote1", random_pose(rng), random_pose(rng), Vector3(0.37, 0.57, 0.25)};
  return header;
}

/// Everything random; contacts come and go and sometimes stay, bodies appear one by one.
inline void randomize(Frame& frame, Rng& rng, int index, const RecordingHeader& header) {
  const int bodies = static_cast<int>(header.bodies.size());
  frame.time = index * header.record_period;
  frame.step = 2 * index;
  frame.program_row = index / 50 - 1;
  frame.X_WE = random_pose(rng);
  frame.V_WE = {random_vector(rng, 1.0), random_vector(rng, 1.0)};
  frame.X_WE_command = random_pose(rng);
  frame.cup = {rng.index(2) == 1,      rng.index(2) == 1,
               rng.uniform(-6e4, 0.0), rng.index(bodies + 1) - 1,
               random_pose(rng),       rng.uniform(),
               rng.uniform(),          {random_vector(rng, 50.0), random_vector(rng, 3.0)}};
  frame.F_flange = {random_vector(rng, 50.0), random_vector(rng, 3.0)};
  frame.solver = {rng.uniform(), rng.index(100), static_cast<SolverStatus>(rng.index(4))};
  frame.joints.resize(header.joints.size());
  for (JointSample& joint : frame.joints) joint = {rng.normal(), rng.normal(), rng.normal()};
  frame.bodies.resize(header.bodies.size());
  for (int i = 0; i < bodies; ++i) {
    BodySample& body = frame.bodies[static_cast<std::size_t>(i)];
    const bool stays = i % 2 == 0 && index % 400 > 5;
    if (!stays) body = {true, random_pose(rng), {random_vector(rng, 1.0), random_vector(rng, 1.0)}};
  }
  if (bodies == 0) return;
  switch (rng.index(4)) {
    case 0:
      break;  // as in the previous frame
    case 1:
      frame.contacts.clear();
      break;
    case 2:
      if (!frame.contacts.empty()) frame.contacts.erase(frame.contacts.begin() + rng.index(int(frame.contacts.size())));
      break;
    default:
      for (int i = rng.index(8); i > 0; --i) frame.contacts.push_back(random_contact(rng, bodies));
  }
}

inline Event random_event(Rng& rng, int index) {
  Event event{0.1 * index, "seal", "BOX013", "lip on the face; gap \xE2\x89\xA4 1 mm", {}};
  if (index % 3 == 0) event.body.clear();
  if (index % 7 == 0) event.text = std::string(1024, 'x');
  for (int i = rng.index(4); i > 0; --i)
    event.numbers.push_back({std::string("n").append(std::to_string(i)), rng.normal()});
  return event;
}

inline Recording random_recording(Rng& rng, int bodies, int frames, int events) {
  Recording recording;
  recording.header = random_header(rng, bodies);
  Frame frame;
  for (int i = 0; i < frames; ++i) {
    randomize(frame, rng, i, recording.header);
    recording.frames.push_back(frame);
  }
  for (int i = 0; i < events; ++i) recording.events.push_back(random_event(rng, i));
  return recording;
}

}  // namespace snug::record::test
