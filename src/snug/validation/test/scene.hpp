// A small run for the tests of this module: three boxes carried into a container, the first set down and re-picked.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "snug/record/test/random_recording.hpp"
#include "snug/validation/simulated_run.hpp"

namespace snug::validation::test {

using record::test::ScratchFolder;

/// A box in the hand: when, from where, to where; rests before and after.
struct Carry {
  std::size_t body;
  double start, end;  ///< s
  Pose from, to;
};

inline Pose at(double x, double y, double z, const Vector3& w = Vector3::Zero()) {
  return {exp_rotation(w), Vector3(x, y, z)};
}

/// Fifth-order blend: at rest at both ends.
inline Pose blend(const Carry& carry, double time) {
  const double s = std::clamp((time - carry.start) / (carry.end - carry.start), 0.0, 1.0);
  const double b = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
  const Vector3 lift(0.0, 0.0, 0.3 * std::sin(3.14159265358979 * b));
  const Vector3 w = log_rotation(carry.from.R.transpose() * carry.to.R);
  return {carry.from.R * exp_rotation(b * w), carry.from.p + b * (carry.to.p - carry.from.p) + lift};
}

/// With the box while it is held; in between, from where one was left to where the next one is.
inline Pose tool_at(const std::vector<Carry>& carries, double time) {
  Carry way{0, 0.0, carries.front().start, at(0.0, 0.0, 0.4), carries.front().from};
  for (std::size_t i = 0; i < carries.size(); ++i) {
    if (time < carries[i].start) return blend(way, time);
    if (time < carries[i].end) return blend(carries[i], time);
    const bool is_last = i + 1 == carries.size();
    way = {0, carries[i].end, is_last ? carries[i].end + 4.0 : carries[i + 1].start, carries[i].to,
           is_last ? at(0.0, 0.0, 0.4) : carries[i + 1].from};
  }
  return blend(way, time);
}

inline SimulatedRun example_run() {
  SimulatedRun run;
  run.name = "example.h5";
  run.header.sequence = "small";
  run.header.record_period = 0.008;
  run.header.container = {"tote", Pose{Matrix3::Identity(), Vector3(0.5, -0.35, -0.28)}, Pose{},
                          Vector3(0.37, 0.57, 0.25)};
  const Vector3 half(0.1, 0.08, 0.05);
  for (const char* name : {"BOX013", "BOX014", "BOX030"}) {
    record::BodyInfo body{name, "B1", record::BodyKind::Dynamic, 0.8, Vector3::Zero(), {}};
    record::ShapeInfo shape;
    shape.half = half;
    body.shapes = {shape};
    run.header.bodies.push_back(body);
  }
  const Pose start = at(-0.5, -0.4, 0.0);
  const std::vector<Carry> carries = {
      {0, 3.0, 8.0, start, at(0.2, 0.4, 0.05, Vector3(0.0, 1.5, 0.0))},
      {0, 11.0, 16.0, at(0.2, 0.4, 0.05, Vector3(0.0, 1.5, 0.0)), at(0.45, -0.5, -0.18, Vector3(0.0, 1.5, 0.4))},
      {1, 21.0, 27.5, start, at(0.45, -0.3, -0.23, Vector3(0.0, 0.0, 0.3))},
      {2, 33.0, 39.2, start, at(0.45, -0.15, -0.23, Vector3(0.0, 0.0, -3.1))}};
  run.bodies.resize(3);
  std::vector<Pose> poses(3, start);
  for (int step = 0; step <= 5500; ++step) {
    const double time = 0.008 * step;
    run.times.push_back(time);
    int held = -1;
    for (const Carry& carry : carries) {
      if (time < carry.start) continue;
      poses[carry.body] = blend(carry, time);
      if (time < carry.end) held = static_cast<int>(carry.body);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const bool is_there = time >= 20.0 * static_cast<double>(i) - (i > 1 ? 8.0 : 0.0);
      run.bodies[i].push_back(is_there ? record::PoseSample(poses[i]) : record::lost_pose());
    }
    const Pose X_WE = tool_at(carries, time);
    run.tool.emplace_back(X_WE);
    run.lip.emplace_back(X_WE);
    run.tool_twist.push_back({});
    run.attached.push_back(held);
    run.vacuum.push_back(held >= 0 ? 1 : 0);
    // A weight that hangs while held, and swings with the motion.
    const double weight = held >= 0 ? 8.0 : 0.0;
    run.wrench.push_back(
        {Vector3(0.3 * weight * std::sin(2.0 * time), 0.2 * weight, -weight - std::sin(5.0 * time) * (held >= 0)),
         Vector3(0.05 * weight, 0.02 * weight * std::sin(3.0 * time), 0.0)});
  }
  for (const Carry& carry : carries) {
    const std::string& name = run.header.bodies[carry.body].name;
    run.events.push_back({carry.start, carry.body == 0 && carry.start > 5.0 ? "repick" : "seal", name, "", {}});
    run.events.push_back({carry.end, "release", name, "", {}});
  }
  run.result = R"({"boxes": [{"id": "BOX013", "state": "packed"}, {"id": "BOX014", "state": "packed"},
                   {"id": "BOX030", "state": "outside"}], "protective_stop": null})";
  return run;
}

}  // namespace snug::validation::test
