// Connections: which peers are still there, whatever ZeroMQ's news of them says and when.
#pragma once

#include <sys/types.h>

#include <map>
#include <string>

namespace snug::served_cell::internal {

/// A connection as the kernel knows it: a descriptor is used again at once by who comes next, the number of a socket is
/// not.
struct Connection {
  int fd = -1;
  ino_t socket = 0;
  auto operator<=>(const Connection&) const = default;
};
/// fd -1 when the descriptor is closed, or no socket.
[[nodiscard]] Connection find_connection(int fd);

/// ZeroMQ names the descriptor of a message and of a connection that was closed, but both are read later, in either
/// order, when another peer may have the descriptor. So the kernel is asked, and a connection belongs to the peer that
/// came by it last.
class Connections {
 public:
  enum class Sender {
    Known,  ///< as before, or new
    Back,   ///< its connection before is gone, and with it what it had begun
    Gone,   ///< nobody would read an answer
  };
  /// A message of this peer came by this descriptor; when ZeroMQ does not know it (below 0) the peer counts as there.
  [[nodiscard]] Sender see(const std::string& peer, int fd);
  /// Is there still the connection by which the peer was seen last?
  [[nodiscard]] bool is_there(const std::string& peer) const;
  /// Drops what is known of connections that are closed.
  void forget_closed();

 private:
  std::map<std::string, Connection> of_peers_;
  std::map<Connection, std::string> peers_;
};

}  // namespace snug::served_cell::internal
