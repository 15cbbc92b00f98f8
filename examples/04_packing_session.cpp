// 04: boxes come one by one; each is given a place without knowing the next, put there by the simulated robot and
// looked at.
#include <cstdio>

#include "snug/model/scenario.hpp"
#include "snug/task/session.hpp"

using namespace snug;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: 04_packing_session SCENARIO.yaml SEQUENCE\n");
    return 2;
  }
  const model::Scenario scenario = model::load_scenario(argv[1]);
  task::SessionOptions options;
  options.agent = "margin";  // quick: looks at the places of one item only, "contact-aware" also at what may follow
  options.samples = 0;       // motions are tried once as planned, not in courses of events that could be
  const task::SessionResult result =
      task::pack(scenario, argv[2], options, [](const task::SessionResult& so_far, int item, int items) {
        std::printf("item %d of %d: %d packed, %.1f %% of the container\n", item, items, so_far.executed_boxes,
                    so_far.executed_percent);
      });
  for (const task::ItemReport& item : result.items) {
    if (item.is_placed)
      std::printf("%s  placed, %.1f mm from its planned place, after %d attempts\n", item.id.c_str(),
                  1e3 * item.position_error, item.attempts);
    else
      std::printf("%s  not placed: %s\n", item.id.c_str(), item.reason.c_str());
  }
  std::printf("program of %zu waypoints, %.0f s\n", result.program.waypoints.size(), result.duration);
  return result.executed_boxes > 0 ? 0 : 1;
}
