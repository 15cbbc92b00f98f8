// SimulatedRun: what of a recording can be measured, as columns over time.
#include "snug/validation/simulated_run.hpp"

#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"

namespace snug::validation {
namespace {

using record::Frame;
using record::PoseSample;

void reserve(SimulatedRun& run, std::size_t frames) {
  run.bodies.resize(run.header.bodies.size());
  run.joints.resize(run.header.joints.size());
  run.times.reserve(frames);
  for (auto& track : run.bodies) track.reserve(frames);
}

void append(SimulatedRun& run, const Frame& frame) {
  run.times.push_back(frame.time);
  for (std::size_t i = 0; i < run.bodies.size(); ++i)
    run.bodies[i].push_back(frame.bodies[i].present ? frame.bodies[i].X_WB : record::lost_pose());
  for (std::size_t i = 0; i < run.joints.size(); ++i) run.joints[i].push_back(frame.joints[i]);
  run.tool.push_back(frame.X_WE);
  run.lip.emplace_back(frame.X_WE.pose() * frame.cup.X_ES.pose());
  run.tool_twist.push_back(frame.V_WE);
  run.wrench.push_back(frame.F_flange);
  run.attached.push_back(frame.cup.attached_body);
  run.vacuum.push_back(frame.cup.vacuum_command ? 1 : 0);
  run.blow_off.push_back(frame.cup.blow_off_command ? 1 : 0);
}

void require_frames(const SimulatedRun& run, const std::string& where) {
  if (run.times.size() < 2)
    throw InputError(where, "", std::to_string(run.times.size()) + " frames", "a recording of two frames or more");
}

}  // namespace

SimulatedRun load_run(const std::filesystem::path& path) {
  record::RecordingReader reader(path);
  SimulatedRun run;
  run.name = path.filename().string();
  run.header = reader.header();
  run.events = reader.events();
  run.result = reader.result();
  reserve(run, reader.frame_count());
  Frame frame;
  for (std::size_t i = 0; i < reader.frame_count(); ++i) {
    reader.read_frame(i, frame);
    append(run, frame);
  }
  require_frames(run, path.string());
  return run;
}

SimulatedRun make_run(const record::Recording& recording, const std::string& name) {
  SimulatedRun run;
  run.name = name;
  run.header = recording.header;
  run.events = recording.events;
  run.result = recording.result;
  reserve(run, recording.frames.size());
  for (const Frame& frame : recording.frames) append(run, frame);
  require_frames(run, name);
  return run;
}

std::vector<std::size_t> find_boxes(const record::RecordingHeader& header) {
  std::vector<std::size_t> boxes, dynamic;
  for (std::size_t i = 0; i < header.bodies.size(); ++i) {
    if (header.bodies[i].kind != record::BodyKind::Dynamic) continue;
    dynamic.push_back(i);
    if (!header.bodies[i].type.empty()) boxes.push_back(i);
  }
  return boxes.empty() ? dynamic : boxes;
}

PoseSample PoseCursor::at(double time, double longest_gap) {
  while (next_ < times_.size() && times_[next_] <= time) ++next_;
  if (next_ == 0) return record::lost_pose();
  const PoseSample& before = poses_[next_ - 1];
  if (times_[next_ - 1] == time) return before;
  if (next_ == times_.size()) return record::lost_pose();
  const PoseSample& after = poses_[next_];
  const double gap = times_[next_] - times_[next_ - 1];
  if (gap > longest_gap || !record::is_tracked(before) || !record::is_tracked(after)) return record::lost_pose();
  const double share = (time - times_[next_ - 1]) / gap;
  return {before.p + share * (after.p - before.p), before.quat.slerp(share, after.quat)};
}

}  // namespace snug::validation
