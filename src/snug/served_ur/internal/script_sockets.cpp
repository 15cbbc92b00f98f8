// ScriptSockets: the sockets that programs on the controller open, by their names. Nothing here blocks.
#include "snug/served_ur/internal/script_sockets.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "snug/served_ur/internal/address.hpp"

namespace snug::served_ur::internal {
namespace {

using urscript::SocketState;

bool would_block() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

SocketState ScriptSockets::open(std::string_view name, std::string_view address, int port) {
  close(name);
  in_addr to = {};
  const std::string text = address == "localhost" ? "127.0.0.1" : std::string(address);
  if (::inet_pton(AF_INET, text.c_str(), &to) != 1 || port < 1 || port > 65535 || sockets_.size() >= kMost) {
    return SocketState::Closed;
  }
  if (!is_loopback(to) && !lets_out_) return SocketState::Closed;
  Descriptor descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  (void)::setsockopt(descriptor.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  sockaddr_in at = {};
  at.sin_family = AF_INET;
  at.sin_addr = to;
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  const int result = ::connect(descriptor.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at);
  if (result != 0 && errno != EINPROGRESS) return SocketState::Closed;
  Socket& socket = sockets_[std::string(name)];
  socket.descriptor = std::move(descriptor);
  look(socket);
  return socket.state;
}

/// Whether a connection came about, or broke.
void ScriptSockets::look(Socket& socket) const {
  if (socket.state == SocketState::Opening) {
    pollfd source = {socket.descriptor.get(), POLLOUT, 0};
    if (::poll(&source, 1, 0) <= 0) return;
    int error = 0;
    socklen_t size = sizeof error;
    (void)::getsockopt(socket.descriptor.get(), SOL_SOCKET, SO_ERROR, &error, &size);
    socket.state = error == 0 ? SocketState::Open : SocketState::Closed;
  }
  if (socket.state != SocketState::Open || socket.unsent.empty()) return;
  const ssize_t count =
      ::send(socket.descriptor.get(), socket.unsent.data(), socket.unsent.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count > 0) socket.unsent.erase(0, static_cast<std::size_t>(count));
  if (count < 0 && !would_block()) socket.state = SocketState::Closed;
}

SocketState ScriptSockets::state(std::string_view name) {
  const auto found = sockets_.find(name);
  if (found == sockets_.end()) return SocketState::Closed;
  look(found->second);
  return found->second.state;
}

bool ScriptSockets::send(std::string_view name, std::string_view bytes) {
  const auto found = sockets_.find(name);
  if (found == sockets_.end() || found->second.state != SocketState::Open) return false;
  if (found->second.unsent.size() + bytes.size() > kMostUnsent) return false;
  found->second.unsent += bytes;
  look(found->second);
  return found->second.state == SocketState::Open;
}

void ScriptSockets::receive(std::string_view name, std::string& buffer, std::size_t most) {
  const auto found = sockets_.find(name);
  if (found == sockets_.end() || found->second.state != SocketState::Open) return;
  std::array<char, 4096> bytes;
  while (buffer.size() < most) {
    const std::size_t room = std::min(bytes.size(), most - buffer.size());
    const ssize_t count = ::recv(found->second.descriptor.get(), bytes.data(), room, MSG_DONTWAIT);
    if (count > 0) {
      buffer.append(bytes.data(), static_cast<std::size_t>(count));
    } else {
      if (count == 0 || !would_block()) found->second.state = SocketState::Closed;
      return;
    }
  }
}

void ScriptSockets::close(std::string_view name) {
  if (const auto found = sockets_.find(name); found != sockets_.end()) sockets_.erase(found);
}

}  // namespace snug::served_ur::internal
