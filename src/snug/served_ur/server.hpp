// Server: a UR controller at an address: its five ports, in time.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "snug/served_cell/pacer.hpp"
#include "snug/served_ur/controller.hpp"

namespace snug::served_ur {

struct ServerSettings {
  std::string host = "127.0.0.1";         ///< IPv4 address, or localhost
  int port_offset = 0;                    ///< added to each of the five ports
  std::vector<std::string> clients = {};  ///< IPv4 addresses that may connect besides loopback; "any": all
  double speed = 1.0;                     ///< simulated seconds a second
  /// Address at which observers see the cell over CLICK (served_cell::ObserverPort); none: nobody looks on.
  std::optional<std::string> observers = {};
  std::function<void(const std::string& line)> log = {};  ///< for people
};

enum class Port : int { Dashboard = 29999, Primary = 30001, Secondary = 30002, RealTime = 30003, Rtde = 30004 };

/// One thread answers all clients between the periods of the controller. Not more than kMostClients of a port; a client
/// that does not read is disconnected, so is one that says a line of a request of HTTP, or one with control characters
/// (TLS, STUN): a page in a browser on this machine could send them, and what follows would be run as a program.
class Server {
 public:
  static constexpr int kMostClients = 16;  ///< of each port

  /// Binds. Throws InputError for an address that cannot be had or that others can reach without `clients`.
  Server(Controller& controller, ServerSettings settings);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// Runs the controller until stop(), or until a client shuts it down. Throws as Controller::step.
  void run();
  /// From any thread and from signal handlers.
  void stop() noexcept;
  [[nodiscard]] const served_cell::Pacer& pacer() const;
  /// As it was bound; empty: there is none.
  [[nodiscard]] std::string observers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::served_ur
