// Connection: a TCP connection to a port of a controller, with a limit to every wait.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "snug/core/descriptor.hpp"

namespace snug::remote_ur {

/// Where a controller is.
struct Endpoint {
  std::string host = "127.0.0.1";  ///< IPv4 address, or a name that has one
  int port_offset = 0;             ///< added to each port
  double patience = 5.0;           ///< s, that an answer may take
};

/// Every failure is an InputError that names host and port: nobody listens, an answer takes longer than the patience,
/// the other side closes.
class Connection {
 public:
  Connection(const Endpoint& endpoint, int port);
  /// Over a socket that is connected. `place`: for messages.
  Connection(Descriptor socket, std::string place, double patience);

  void send(std::string_view bytes) const;
  /// The patience begins anew: of one answer.
  void begin_wait();
  /// Waits until something came and appends it to received().
  void wait();
  /// Appends what has come already; waits for nothing.
  void take_waiting();
  [[nodiscard]] std::string& received() { return received_; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  [[nodiscard]] int left_ms() const;
  /// One read of what is there. False: nothing was.
  bool take();

  std::string place_;
  double patience_;
  std::chrono::steady_clock::time_point deadline_;
  Descriptor socket_;
  std::string received_;
};

}  // namespace snug::remote_ur
