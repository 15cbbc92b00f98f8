// Prints the hashes of the states that twenty scenes, a heap and a packing session come to, as JSON: what builds by
// different compilers, for different processors, are compared by (tools/same_bytes.py).
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "bench/figures/drawn_scenes.hpp"
#include "snug/core/input_error.hpp"
#include "snug/model/scenario.hpp"
#include "snug/motion/program_csv.hpp"
#include "snug/runs/run.hpp"
#include "snug/session/session.hpp"
#include "snug/simulated_plant/simulated_plant.hpp"

namespace {

using namespace snug;

constexpr double kUntil = 0.5;      // s: every scene is in contact by then
constexpr double kHeapUntil = 1.5;  // s: most boxes are one group, which is swept
constexpr int kItems = 3;           // of the session
const std::vector<std::string> kScenes = {"bench/s1-stack.yaml",
                                          "bench/s2-drop.yaml",
                                          "bench/s3-creep.yaml",
                                          "bench/s3-slide-0.yaml",
                                          "bench/s3-slide-22.yaml",
                                          "bench/s3-slide-45.yaml",
                                          "bench/s4-bounce.yaml",
                                          "bench/s5-swing.yaml",
                                          "bench/s6a.yaml",
                                          "bench/s6b.yaml",
                                          "bench/s6c.yaml",
                                          "conveyor.yaml",
                                          "drop.yaml",
                                          "push.yaml",
                                          "slide.yaml",
                                          "stack.yaml",
                                          "init/scene.yaml",
                                          "tosses/cube.yaml"};

std::uint64_t run_scene(const model::Scenario& scenario, double until = kUntil) {
  runs::RunOptions options;
  options.until = until;
  return runs::run(scenario, options).state_hash;
}

/// Boxes of a cell are decided on, rehearsed in sampled worlds, and packed by the arm. FNV-1a of what was sent goes
/// with the state.
std::string run_session(const std::filesystem::path& scenarios) {
  const model::Scenario scenario = model::load_scenario(scenarios / "init/cell.yaml");
  simulated_plant::SimulatedPlantOptions drawn;
  drawn.seed = 4;
  simulated_plant::SimulatedPlant plant(scenario, "first", drawn);
  session::SessionOptions options;
  options.samples = 2;
  options.decision.time = 0.02;
  int done = 0;
  options.is_interrupted = [&done] { return done >= kItems; };
  const session::SessionResult result =
      session::pack(scenario, "first", options, plant, [&done](const session::SessionResult&, int, int) { ++done; });
  std::uint64_t sent = 0xcbf29ce484222325;
  for (const char c : motion::format_program(result.program))
    sent = (sent ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}-{:016x}-{}", plant.simulation().hash(plant.state()), sent, result.plan.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: snug_states FOLDER-OF-SCENARIOS\n");
    return 2;
  }
  const std::filesystem::path scenarios = argv[1];
  try {
    for (const std::string& name : kScenes) {
      fmt::print("{} \"{}\": \"{:016x}\"", name == kScenes.front() ? "{\n" : ",\n", name,
                 run_scene(model::load_scenario(scenarios / name)));
    }
    fmt::print(",\n \"drawn drop\": \"{:016x}\"", run_scene(bench::drawn_drop({.seed = 3})));
    fmt::print(",\n \"drawn pile\": \"{:016x}\"", run_scene(bench::drawn_pile({.count = 27, .side = 3, .seed = 2})));
    fmt::print(",\n \"drawn heap\": \"{:016x}\"", run_scene(bench::drawn_pile({300, 7, 2}), kHeapUntil));
    fmt::print(",\n \"session\": \"{}\"\n}}\n", run_session(scenarios));
  } catch (const InputError& error) {
    std::fprintf(stderr, "snug_states: %s\n", error.what());
    return 2;
  }
  return 0;
}
