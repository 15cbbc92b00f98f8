// DryRun: a plant that is packed, and a robot elsewhere that makes each motion before it, in the air.
#include "snug/remote_ur/dry_run.hpp"

#include <utility>

namespace snug::remote_ur {

void DryRun::start(const plant::Motion& motion) {
  motion_ = motion;
  robot_.start(motion);
}

std::vector<plant::Event> DryRun::advance() {
  if (!motion_) return packed_.advance();
  for (const plant::Event& event : robot_.advance()) {
    const auto* ended = plant::get<plant::MotionEnded>(event);
    if (ended == nullptr) continue;
    const plant::Motion motion = *std::exchange(motion_, std::nullopt);
    if (ended->feedback.end.reason == plant::EndReason::Completed) {
      packed_.start(motion);
      continue;
    }
    plant::Feedback fed = packed_.read();
    fed.times.clear();
    if (ended->feedback.end.reason == plant::EndReason::Cancelled) {
      fed.end = ended->feedback.end;
      return {{fed.time, plant::MotionEnded{fed}}};
    }
    fed.end = {plant::EndReason::Fault, ended->feedback.end.waypoint, 0.0, 0.0,
               "dry run: " + plant::describe(ended->feedback.end, motion.waypoints)};
    return {{fed.time, plant::FaultRaised{plant::EndReason::Fault, fed.end.where}},
            {fed.time, plant::MotionEnded{fed}}};
  }
  return {};
}

void DryRun::cancel() {
  if (motion_) return robot_.cancel();
  packed_.cancel();
}

void DryRun::acknowledge() {
  robot_.acknowledge();
  packed_.acknowledge();
}

}  // namespace snug::remote_ur
