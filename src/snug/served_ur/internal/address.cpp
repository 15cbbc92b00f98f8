// IPv4 addresses: whom a server listens to, and whom it lets in.
#include "snug/served_ur/internal/address.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "snug/core/input_error.hpp"

namespace snug::served_ur::internal {

in_addr parse_address(const std::string& text, const char* option) {
  in_addr address = {};
  if (::inet_pton(AF_INET, text == "localhost" ? "127.0.0.1" : text.c_str(), &address) != 1) {
    throw InputError("command line", option, "'" + text + "'", "an IPv4 address such as 127.0.0.1");
  }
  return address;
}

bool is_loopback(in_addr address) { return ntohl(address.s_addr) >> 24U == 127U; }

Guests::Guests(const std::vector<std::string>& addresses) {
  for (const std::string& text : addresses) {
    if (text == "any")
      lets_in_all_ = true;
    else
      addresses_.push_back(parse_address(text, "--ur-clients"));
  }
}

bool Guests::is_welcome(in_addr address) const {
  return lets_in_all_ || is_loopback(address) ||
         std::ranges::any_of(addresses_, [&](in_addr known) { return known.s_addr == address.s_addr; });
}

Descriptor listen_at(in_addr address, int port, const std::string& host) {
  Descriptor socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  (void)::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  sockaddr_in at = {};
  at.sin_family = AF_INET;
  at.sin_addr = address;
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  if (::bind(socket.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) != 0 ||
      ::listen(socket.get(), SOMAXCONN) != 0) {
    throw InputError("command line", "--ur, --ur-port-offset",
                     fmt::format("{} port {}: {}", host, port, std::strerror(errno)),
                     "an address of this machine whose ports are free");
  }
  return socket;
}

}  // namespace snug::served_ur::internal
