// 03: a list of placements becomes a program, the demonstrator's cell runs it, and every box is accounted for.
#include <cstdio>

#include "snug/model/placements.hpp"
#include "snug/model/scenario.hpp"
#include "snug/runs/run.hpp"
#include "snug/session/task.hpp"

using namespace snug;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: 03_packing_run SCENARIO.yaml PLACEMENTS.yaml\n");
    return 2;
  }
  const model::Scenario scenario = model::load_scenario(argv[1]);
  const auto placements = model::load_placements(argv[2], scenario);
  const auto program = session::make_program(scenario, "1", placements, argv[2]);
  if (!program) {
    std::printf("no program: %s\n", program.error().text.c_str());
    return 1;
  }

  runs::RunOptions options;
  options.program = *program;
  options.sequence = "1";
  const runs::RunResult result = runs::run(scenario, options);
  for (const cell::BoxResult& box : result.boxes) {
    std::printf("%s  %-8s at (%.3f, %.3f, %.3f) m in the tote\n", box.id.c_str(), cell::name_of(box.state),
                box.X_TP.p.x(), box.X_TP.p.y(), box.X_TP.p.z());
  }
  std::printf("filled to %.2f %%, %.0f s simulated\n", result.filling_degree_percent, result.duration);
  return result.failure ? 1 : 0;
}
