// ScriptSockets: the sockets that programs on the controller open, by their names. Nothing here blocks.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "snug/core/descriptor.hpp"
#include "snug/urscript/host.hpp"

namespace snug::served_ur::internal {

/// To IPv4 addresses of this machine, unless all are allowed.
class ScriptSockets {
 public:
  explicit ScriptSockets(bool lets_out) : lets_out_(lets_out) {}

  [[nodiscard]] urscript::SocketState open(std::string_view name, std::string_view address, int port);
  [[nodiscard]] urscript::SocketState state(std::string_view name);
  /// False: it is not open, or too much waits to be sent.
  bool send(std::string_view name, std::string_view bytes);
  /// Appends what came, until `buffer` holds `most` bytes.
  void receive(std::string_view name, std::string& buffer, std::size_t most);
  void close(std::string_view name);
  void close_all() { sockets_.clear(); }

  static constexpr std::size_t kMost = 64;                           ///< open at once
  static constexpr std::size_t kMostUnsent = std::size_t{1} << 20U;  ///< bytes

 private:
  struct Socket {
    Descriptor descriptor;
    urscript::SocketState state = urscript::SocketState::Opening;
    std::string unsent;
  };
  void look(Socket& socket) const;

  bool lets_out_;
  std::map<std::string, Socket, std::less<>> sockets_;
};

}  // namespace snug::served_ur::internal
