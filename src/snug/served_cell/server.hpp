// Server: a simulator at an address: messages in, answers out, steps in time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "snug/click/keys.hpp"
#include "snug/served_cell/pacer.hpp"
#include "snug/served_cell/simulator.hpp"

namespace snug::served_cell {

struct ServerSettings {
  std::string endpoint = "tcp://127.0.0.1:5555";  ///< or ipc://PATH; port * is any that is free
  /// Whom it lets in, by their keys, and who it is. An address that other machines can reach needs them.
  std::optional<click::ServerKeys> keys = {};
  /// s of the clock: a controller that says nothing for longer gives its place to the next one that commands.
  double lease = 60.0;
  /// Simulated seconds a second. Async: 1 when absent. Sync: a Control waits for its time; absent, it does not.
  std::optional<double> speed;
  bool is_async = false;      ///< as the simulator
  bool step_by_step = false;  ///< steps only as `read_steps` allows
  int steps_fd = -1;          ///< is readable when read_steps may be called (step by step)
  /// How many steps more may be done; -1 to go on without asking, kReset to reset the cell.
  std::function<int()> read_steps = {};
  std::function<void(const std::string& line)> log = {};  ///< for people
  std::optional<double> stop_after = {};                  ///< s, simulated: the run and the server end then
  std::function<void()> controller_left = {};             ///< told when one has
};
inline constexpr int kReset = -2;

/// How the server spent its time.
struct ServerTimes {
  Histogram own;      ///< s, a message from its receipt to its answer without the cell's step
  Histogram service;  ///< s, with it
};

class Server {
 public:
  /// Binds. Throws InputError for an address that cannot be had, that others can reach without keys, that another
  /// server has, or whose file is something else.
  Server(Simulator& simulator, ServerSettings settings);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// The address as it was bound, with the port.
  [[nodiscard]] const std::string& endpoint() const;
  /// Answers until stop(). Throws as Simulator::answer.
  void run();
  /// From any thread and from signal handlers.
  void stop() noexcept;

  [[nodiscard]] const ServerTimes& times() const;
  [[nodiscard]] const Pacer& pacer() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::served_cell
