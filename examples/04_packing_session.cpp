// 04: boxes come one by one; each is given a place without knowing the next, put there by a simulated robot that nobody
// knows exactly, and looked at.
#include <cstdio>

#include "snug/model/scenario.hpp"
#include "snug/session/session.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

using namespace snug;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: 04_packing_session SCENARIO.yaml SEQUENCE\n");
    return 2;
  }
  const model::Scenario scenario = model::load_scenario(argv[1]);
  simulated_plant::SimulatedPlantOptions drawn;
  drawn.seed = 7;  // of the cell that is packed; the planner does not know it
  simulated_plant::SimulatedPlant plant(scenario, argv[2], drawn);

  session::SessionOptions options;
  options.agent = "margin";  // quick: looks at the places of one item only, "contact-aware" also at what may follow
  options.samples = 0;       // motions are rehearsed in the nominal world alone
  const session::SessionResult result =
      session::pack(scenario, argv[2], options, plant, [](const session::SessionResult& so_far, int item, int items) {
        std::printf("item %d of %d: %zu packed, %.1f %% of the container\n", item, items, so_far.plan.size(),
                    so_far.planned_percent);
      });
  for (const session::ItemReport& item : result.items) {
    if (item.is_packed())
      std::printf("%s  placed, seen %.1f mm from its planned place, after %d attempts\n", item.id.c_str(),
                  1e3 * item.position_error, item.attempts);
    else
      std::printf("%s  %s: %s\n", item.id.c_str(), session::name_of(item.end), item.reason.c_str());
  }
  std::printf("%zu waypoints, %.0f s, %s\n", result.program.waypoints.size(), result.duration, result.stopped.c_str());
  return result.plan.empty() ? 1 : 0;
}
