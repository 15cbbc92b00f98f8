// SentProgram: any plant, and beside it the program that it is sent.
#include "snug/plant/sent_program.hpp"

#include <algorithm>
#include <utility>

#include "snug/motion/program_csv.hpp"
#include "snug/motion/waypoint_name.hpp"

namespace snug::plant {

SentProgram::SentProgram(Plant& plant, OutputFile& file, const motion::Tracking& tracking, std::string robot)
    : plant_(plant), file_(file), program_{"pack", {}, tracking, std::move(robot)} {}

void SentProgram::start(const Motion& motion) {
  const bool is_finite = std::ranges::all_of(
      motion.waypoints, [](const motion::Waypoint& one) { return one.X_WE.p.allFinite() && one.X_WE.R.allFinite(); });
  if (is_finite && !motion.waypoints.empty()) {  // else it is refused
    const double now = plant_.read().time;
    if (program_.waypoints.empty()) begin_ = now;
    const std::size_t first = program_.waypoints.size();
    program_.waypoints.insert(program_.waypoints.end(), motion.waypoints.begin(), motion.waypoints.end());
    const double since = now - begin_;
    if (since >= 0.0 && since <= motion::kLatestDeparture)
      program_.waypoints[first].not_before = motion::as_named(since);
    file_.replace(kUnfinishedProgram + motion::format_program(program_));
    if (!file_.is_published() && !file_.replaces_file()) file_.publish();
  }
  plant_.start(motion);
}

void SentProgram::finish() {
  if (program_.waypoints.empty()) return;
  file_.replace(motion::format_program(program_));
  if (!file_.is_published()) file_.publish();
}

}  // namespace snug::plant
