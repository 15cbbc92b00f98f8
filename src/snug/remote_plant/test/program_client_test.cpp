// ProgramClient: a program through the wire is the program in the cell.
#include "snug/remote_plant/program_client.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <thread>

#include "snug/click/test/stranger.hpp"
#include "snug/motion/waypoint_name.hpp"
#include "snug/served_cell/server.hpp"

namespace snug::remote_plant {
namespace {

const cell::Simulation& cell_with_robot() {
  static const cell::Simulation simulation(
      model::load_scenario(std::filesystem::path(SNUG_SOURCE_DIR) / "scenarios/box-demonstrator.yaml"), "1",
      {motion::LaggedTracking{}, cup::CupMode::Holding, "ur10"});
  return simulation;
}

/// A server in a thread of its own.
class ProgramServer {
 public:
  explicit ProgramServer(served_cell::SimulatorSettings settings)
      : simulator_(cell_with_robot(), with_log(std::move(settings))), server_(simulator_, at_an_address()) {
    thread_ = std::thread([this] { server_.run(); });
  }
  ~ProgramServer() { stop(); }
  void stop() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const std::string& endpoint() const { return server_.endpoint(); }
  std::vector<runs::RunResult> runs;

 private:
  served_cell::SimulatorSettings with_log(served_cell::SimulatorSettings settings) {
    settings.end_run = [this](int, const runs::RunResult& result) { runs.push_back(result); };
    return settings;
  }
  static served_cell::ServerSettings at_an_address() {
    static int count = 0;
    served_cell::ServerSettings settings;
    settings.endpoint = "ipc://@snug_program_client_" + std::to_string(::getpid()) + "_" + std::to_string(++count);
    return settings;
  }
  served_cell::Simulator simulator_;
  served_cell::Server server_;
  std::thread thread_;
};

TEST(ProgramClient, DoesAProgramBitByBitAsTheCellDoes) {
  const cell::Simulation& simulation = cell_with_robot();
  motion::Program program{"test", {}};
  for (const char* name : {"home", "PrePick027", "Box027", "PostPick027"}) {
    motion::Waypoint row = motion::named_waypoint(name, simulation.scenario().controller.X_WE_start);
    row.X_WE.p += Vector3(0.0, 0.02 * static_cast<double>(program.waypoints.size()), 0.02);
    row.io.vacuum = program.waypoints.size() == 3;
    program.waypoints.push_back(row);
  }
  const motion::PreparedProgram plan = simulation.prepare(program);
  cell::CellState state = simulation.make_state();
  cell::CellWorkspace work = simulation.make_workspace();
  while (!simulation.advance(plan, state, work).has_ended) continue;
  const double settled = simulation.time(state) + 1.0;
  while (simulation.time(state) < settled) (void)simulation.advance(plan, state, work);

  for (const bool by_position : {false, true}) {
    served_cell::SimulatorSettings settings;
    if (by_position) settings.cell.controls = {control::DriveKind::Position};
    ProgramServer served(settings);
    click::Client client(served.endpoint());
    ProgramClientSettings controller;
    controller.sequence = &simulation.sequence();
    const ProgramClientResult result = run_program(client, simulation.scenario(), *simulation.arm(), plan, controller);
    EXPECT_EQ(result.failure, "");
    served.stop();
    ASSERT_EQ(served.runs.size(), 1u);
    EXPECT_EQ(served.runs[0].ended_by, "reset by the controller");
    if (by_position) continue;  // the same way, not the same bits: positions leave the speeds within a tick open
    EXPECT_EQ(served.runs[0].state_hash, simulation.hash(state));
    EXPECT_EQ(served.runs[0].duration, simulation.time(state));
  }
}

TEST(ProgramClient, EndsWhereTheTimeOfTheSimulatorStandsStill) {
  const cell::Simulation& simulation = cell_with_robot();
  served_cell::Simulator simulator(simulation, {});
  const click::test::Stranger stranger([&](const click::Message& asked) -> click::Message {
    // Everything as it should be, but a Control is answered as a question would be.
    const bool is_step = std::holds_alternative<click::Control>(asked);
    return *click::decode(
        *simulator.answer("peer", click::encode(is_step ? click::Message(click::SensorRequest{}) : asked)));
  });
  const motion::Program program{"test", {motion::named_waypoint("home", simulation.scenario().controller.X_WE_start)}};
  const motion::PreparedProgram plan = simulation.prepare(program);
  click::Client client(stranger.endpoint());
  ProgramClientSettings settings;
  settings.patience = 0.5;
  const ProgramClientResult result = run_program(client, simulation.scenario(), *simulation.arm(), plan, settings);
  EXPECT_TRUE(result.has_begun);
  EXPECT_NE(result.failure.find("stays at 0 s"), std::string::npos) << result.failure;
  EXPECT_LT(result.wall, 30.0);
}

}  // namespace
}  // namespace snug::remote_plant
