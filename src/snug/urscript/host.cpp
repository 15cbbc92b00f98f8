// Host without sockets and RTDE: what a controller says that lets no program out.
#include "snug/urscript/host.hpp"

namespace snug::urscript {

std::optional<std::uint64_t> Host::input_count(std::string_view /*name*/) const { return std::nullopt; }
SocketState Host::open_socket(std::string_view /*name*/, std::string_view /*address*/, int /*port*/) {
  return SocketState::Closed;
}
SocketState Host::socket_state(std::string_view /*name*/) { return SocketState::Closed; }
bool Host::send(std::string_view /*name*/, std::string_view /*bytes*/) { return false; }
void Host::receive(std::string_view /*name*/, std::string& /*buffer*/, std::size_t /*most*/) {}
void Host::close_socket(std::string_view /*name*/) {}

}  // namespace snug::urscript
