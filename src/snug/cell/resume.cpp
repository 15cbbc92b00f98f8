// Resume: the bodies of a scene as a frame of a recording has them.
#include "snug/cell/resume.hpp"

#include <fmt/format.h>

#include <cmath>

#include "snug/core/input_error.hpp"
#include "snug/record/reader.hpp"

namespace snug::cell {
namespace {

/// The frame that the scene goes on from.
record::Frame read_start(const model::InitialState& from, record::RecordingReader& reader) {
  const std::string name = from.recording.string();
  if (reader.frame_count() == 0) throw InputError(name, "", "a recording without frames", "at least one frame");
  const double first = reader.times().front(), last = reader.times().back();
  const double slack = 1e-9 * (1.0 + last);  // times are written with a few digits
  const double time = from.time.value_or(last);
  if (!(time >= first - slack && time <= last + slack)) {
    throw InputError(name, "initial_state.time", fmt::format("{} s", time),
                     fmt::format("a recorded instant, {} to {} s", first, last));
  }
  record::Frame frame;
  reader.read_frame(reader.find_frame(time + slack), frame);
  return frame;
}

}  // namespace

void resume(const model::InitialState& from, const CellWorld& world, physics::WorldState& state) {
  record::RecordingReader reader(from.recording);
  const record::RecordingHeader& header = reader.header();
  const record::Frame frame = read_start(from, reader);
  const double dt = world.model.settings.dt;
  state.step_index = std::llround(frame.time / dt);
  int group = -1;
  for (std::size_t i = 0; i < world.model.bodies.size(); ++i) {
    const physics::BodyModel& model = world.model.bodies[i];
    if (model.kind == physics::BodyKind::Static) continue;
    const int recorded = record::find_body(header, model.name);
    if (recorded < 0) {
      throw InputError(from.recording.string(), "initial_state", "no body '" + model.name + "'",
                       "a recording with all moving bodies of the scenario");
    }
    const record::BodySample& sample = frame.bodies[static_cast<std::size_t>(recorded)];
    physics::BodyState& body = state.bodies[i];
    body.is_present = sample.present;
    if (!sample.present) continue;
    body.quat_WB = sample.X_WB.quat.normalized();
    const Vector3 p_BoBcm_W = body.quat_WB * model.inertia.com;
    body.p_WBcm = sample.X_WB.p + p_BoBcm_W;
    body.velocity = sample.V_WB.linear + sample.V_WB.angular.cross(p_BoBcm_W);
    body.angular_velocity = sample.V_WB.angular;
    body.sleep_group = -1;
    if (model.kind != physics::BodyKind::Dynamic || frame.step == 0 || !(sample.V_WB == Twist{})) continue;
    if (group < 0) group = static_cast<int>(i);
    body.sleep_group = group;
  }
}

}  // namespace snug::cell
