// Connection: a TCP connection to a port of a controller, with a limit to every wait.
#include "snug/remote_ur/connection.hpp"

#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>
#include <utility>

#include "snug/core/input_error.hpp"

namespace snug::remote_ur {
namespace {

constexpr std::size_t kMostReceived = std::size_t{1} << 20U;  // bytes that wait to be read: no answer is as long

sockaddr_in resolve(const std::string& host, int port, const std::string& place) {
  addrinfo hints = {};
  hints.ai_family = AF_INET;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  const int error = ::getaddrinfo(host.c_str(), nullptr, &hints, &found);
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> owner(found, ::freeaddrinfo);
  if (error != 0 || found == nullptr || port < 1 || port > 65535)
    throw InputError("command line", place, error != 0 ? ::gai_strerror(error) : "no such port",
                     "the address of a UR controller, such as 192.168.0.10");
  sockaddr_in at = {};
  std::memcpy(&at, found->ai_addr, sizeof at);
  at.sin_port = htons(static_cast<std::uint16_t>(port));
  return at;
}

}  // namespace

Connection::Connection(const Endpoint& endpoint, int port)
    : place_(fmt::format("{} port {}", endpoint.host, port + endpoint.port_offset)), patience_(endpoint.patience) {
  const sockaddr_in at = resolve(endpoint.host, port + endpoint.port_offset, place_);
  socket_ = Descriptor(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const int yes = 1;
  (void)::setsockopt(socket_.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  begin_wait();
  if (::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at) == 0) return;
  if (errno != EINPROGRESS) fail(std::strerror(errno));
  pollfd source = {socket_.get(), POLLOUT, 0};
  if (::poll(&source, 1, left_ms()) <= 0) fail("nobody answers");
  int error = 0;
  socklen_t size = sizeof error;
  (void)::getsockopt(socket_.get(), SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) fail(std::strerror(error));
}

Connection::Connection(Descriptor socket, std::string place, double patience)
    : place_(std::move(place)), patience_(patience), socket_(std::move(socket)) {
  begin_wait();
}

void Connection::fail(const std::string& what) const {
  throw InputError("command line", place_, what, "a UR controller that listens there (`snug serve --ur` is one)");
}

void Connection::begin_wait() {
  deadline_ = std::chrono::steady_clock::now() +
              std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::duration<double>(patience_));
}

int Connection::left_ms() const {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - std::chrono::steady_clock::now());
  return static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 3'600'000));
}

void Connection::send(std::string_view bytes) const {
  // short lines and frames: they fit into the buffer of a connection that the other side reads
  const ssize_t count = ::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (count != static_cast<ssize_t>(bytes.size())) fail("the connection has ended");
}

void Connection::wait() {
  pollfd source = {socket_.get(), POLLIN, 0};
  const int left = left_ms();
  if (left == 0 || ::poll(&source, 1, left) <= 0) fail(fmt::format("no answer within {} s", patience_));
  (void)take();
}

bool Connection::take() {
  std::array<char, 4096> bytes;
  const ssize_t count = ::recv(socket_.get(), bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (count == 0) fail("the connection was closed");
  if (count < 0 && errno != EAGAIN && errno != EINTR) fail(std::strerror(errno));
  if (count > 0) received_.append(bytes.data(), static_cast<std::size_t>(count));
  if (received_.size() > kMostReceived) fail("more than 1 MB without an answer");
  return count > 0;
}

void Connection::take_waiting() {
  while (take()) {
  }
}

}  // namespace snug::remote_ur
