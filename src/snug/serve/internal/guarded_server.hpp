// GuardedServer: httplib's server behind connections that are limited in time, size and number. Internal to the module.
#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <set>
#include <string_view>

#include "snug/serve/internal/httplib.hpp"

namespace snug::serve::internal {

/// What one connection may take.
struct ConnectionLimits {
  std::chrono::milliseconds request{5000};  ///< until the last byte of the request
  std::chrono::milliseconds write{5000};    ///< without the client taking anything
  std::size_t request_bytes = std::size_t{256} << 10U;
  std::size_t connections = 128;  ///< at the same time, a thread each; those after them wait
};

/// "localhost", or a numeric address of 127.0.0.0/8, ::1, or one of those written as IPv6 (no brackets, no port).
[[nodiscard]] bool is_loopback_name(std::string_view name);

/// One request a connection: there is no next one that anything could be taken for.
class GuardedServer : public httplib::Server {
 public:
  explicit GuardedServer(const ConnectionLimits& limits = {});
  /// Lets as many connections wait for their turn as may be open; the library's own number is 5. After binding.
  void widen_queue();
  /// Is the address that it listens at one that only this machine can reach? After binding.
  [[nodiscard]] bool is_at_loopback() const;
  /// Ends all connections, whatever they are doing, and those to come.
  void close_connections();

 private:
  bool process_and_close_socket(socket_t socket) override;
  void serve_connection(socket_t socket);

  const ConnectionLimits limits_;
  std::mutex mutex_;
  std::set<socket_t> open_;
  bool is_closing_ = false;
};

}  // namespace snug::serve::internal
