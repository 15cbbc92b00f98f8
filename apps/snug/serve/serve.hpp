// serve: the cell for controllers in other programs: as a CLICK simulator, or as a controller of Universal Robots.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/snug/command_line/scenario_options.hpp"
#include "apps/snug/command_line/shared_options.hpp"
#include "apps/snug/command_line/verb.hpp"
#include "snug/serve/server.hpp"
#include "snug/served_cell/server.hpp"
#include "snug/ur/robot_data.hpp"

namespace snug::app {

/// Of --ur.
struct UrOptions {
  std::optional<std::string> host;  ///< present: the cell is served so
  std::string model = "ur10";
  int port_offset = 0;
  std::vector<std::string> clients;      ///< addresses that may connect
  std::string programs;                  ///< folder of the programs that the dashboard loads; empty: none
  std::optional<std::string> observers;  ///< CLICK address for who looks on
};

struct ServeOptions {
  std::string scenario;
  ScenarioChanges changes;
  std::optional<std::string> sequence;  ///< absent: the first
  std::vector<std::string> skipped;     ///< boxes of the sequence that do not come
  std::optional<std::string> robot;     ///< absent: the scenario's
  PhysicsWords physics;
  std::optional<std::uint64_t> plant_seed;  ///< the cell is a plant that is packed
  std::string rpy = "xyz";
  std::vector<std::string> controls = {"velocity"};
  served_cell::ServedCellSettings cell;
  served_cell::ServerSettings server;
  UrOptions ur;
  std::optional<double> batch;        ///< s, simulated
  bool runs_at_once = false;          ///< async: before there is a controller
  std::optional<std::string> keys;    ///< folder: who may drive it
  bool once = false;                  ///< ends with the first run that its controller does not reset
  std::optional<std::string> record;  ///< HDF5 file; of further runs: with their number before the ending
  bool json = false;
  bool shows = false;     ///< a page with the run
  bool is_quiet = false;  ///< opens no browser
  serve::ServerSettings page;
};

/// What `serve` and `run` have: scenario and its changes, --sequence, --plant-seed, --model, -o and --json.
/// The row of --model.
OptionRow add_cell(const Verb& verb, ServeOptions& options);

/// One of those that --model offers.
[[nodiscard]] ur::Model ur_model_of(const std::string& name);
/// Serves until Ctrl-C, until a client shuts the controller down, or with `once` until the first run is over.
[[nodiscard]] int run_serve_ur(const ServeOptions& options);

}  // namespace snug::app
