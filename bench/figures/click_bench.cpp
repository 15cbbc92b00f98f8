// measure_click: what a controller in another thread waits for a step of the demonstrator's cell at rest.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>

#include "bench/figures/internal/click_bench.hpp"
#include "snug/click/client.hpp"
#include "snug/core/check.hpp"
#include "snug/served_cell/server.hpp"

namespace snug::bench::internal {
namespace {

constexpr int kRoundTrips = 5000;
constexpr int kWarmUp = 500;  ///< first ones: the box comes to rest

struct RoundTrips {
  double median = 0.0;  ///< s
  double own = 0.0;     ///< s, of the server without the cell's step, median
};

RoundTrips measure(const cell::Simulation& simulation, const std::string& robot, const std::string& endpoint) {
  served_cell::Simulator simulator(simulation, {});
  served_cell::ServerSettings settings;
  settings.endpoint = endpoint;
  served_cell::Server server(simulator, settings);
  std::thread serving([&] { server.run(); });
  click::Client client(server.endpoint());
  const auto handshake = client.shake_hands();
  SNUG_CHECK(handshake.has_value(), "our server answers our client");
  click::Control control;
  control.objects[robot].list = click::CommandList::Values;
  control.objects[robot].values.assign(handshake->objects.find(robot)->second.controls.size(), 0.0);
  std::vector<double> times;
  for (int i = 0; i < kRoundTrips + kWarmUp; ++i) {
    const auto start = std::chrono::steady_clock::now();
    SNUG_CHECK(client.control(control).has_value(), "a standing arm goes on standing");
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    if (i >= kWarmUp) times.push_back(took.count());
  }
  server.stop();
  serving.join();
  std::nth_element(times.begin(), times.begin() + kRoundTrips / 2, times.end());
  return {times[kRoundTrips / 2], server.times().own.quantile(0.5)};
}

}  // namespace

void measure_click(const BenchOptions& options, std::vector<Figure>& figures) {
  const model::Scenario scenario = model::load_scenario(options.scenario);
  cell::SimulationOptions of_cell;
  of_cell.robot = scenario.robot->name;
  const cell::Simulation simulation(scenario, "1", of_cell);
  const std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("snug_bench_" + std::to_string(::getpid()));
  const RoundTrips ipc = measure(simulation, of_cell.robot, "ipc://" + path.string());
  const RoundTrips tcp = measure(simulation, of_cell.robot, "tcp://127.0.0.1:*");
  const auto add = [&](const char* name, double seconds, const char* target, double most) {
    figures.push_back({name, 1e6 * seconds, "us", target, 1e6 * seconds <= most});
  };
  add("click.ipc.round_trip_us", ipc.median, "<= 150", 150.0);
  add("click.tcp.round_trip_us", tcp.median, "<= 200", 200.0);
  add("click.own_us", std::max(ipc.own, tcp.own), "<= 30", 30.0);
}

}  // namespace snug::bench::internal
