// GuardedServer: what the library does with a socket, done with deadlines. Why its own options are not enough is said
// in serve/README.md.
#include "snug/serve/internal/guarded_server.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <string>

namespace snug::serve::internal {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds kFarewell(500);  ///< for the client to take the answer and close

/// Waits until the socket can be read or written, or the time is over.
bool wait_for(socket_t socket, short event, Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    pollfd waiting = {socket, event, 0};
    const int ready = ::poll(&waiting, 1, static_cast<int>(std::max<long>(0, left)));
    if (ready >= 0) return ready > 0;
    if (errno != EINTR) return false;
  }
}

bool is_loopback(const sockaddr_storage& address) {
  constexpr unsigned kNet = 127;
  if (address.ss_family == AF_INET) {
    const auto& ip4 = reinterpret_cast<const sockaddr_in&>(address);
    return ntohl(ip4.sin_addr.s_addr) >> 24U == kNet;
  }
  if (address.ss_family != AF_INET6) return false;
  const in6_addr& ip6 = reinterpret_cast<const sockaddr_in6&>(address).sin6_addr;
  return IN6_IS_ADDR_LOOPBACK(&ip6) || (IN6_IS_ADDR_V4MAPPED(&ip6) && ip6.s6_addr[12] == kNet);
}

/// One request and its answer.
class GuardedStream : public httplib::Stream {
 public:
  GuardedStream(socket_t socket, const ConnectionLimits& limits)
      : socket_(socket), limits_(limits), deadline_(Clock::now() + limits.request) {}

  bool is_readable() const override { return begin_ < end_ || wait_for(socket_, POLLIN, deadline_); }
  bool is_writable() const override { return wait_for(socket_, POLLOUT, Clock::now() + limits_.write); }
  ssize_t read(char* to, size_t size) override {
    if (begin_ == end_ && !fill()) return -1;
    const std::size_t count = std::min(size, end_ - begin_);
    std::copy_n(buffer_.data() + begin_, count, to);
    begin_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, size_t size) override {
    for (std::size_t sent = 0; sent < size;) {
      if (!is_writable()) return -1;
      const ssize_t count = ::send(socket_, from + sent, size - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
      if (count <= 0) return -1;
      sent += static_cast<std::size_t>(count);
    }
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return socket_; }

 private:
  bool fill() {
    if (received_ >= limits_.request_bytes || !wait_for(socket_, POLLIN, deadline_)) return false;
    const ssize_t count = ::recv(socket_, buffer_.data(), buffer_.size(), 0);
    if (count <= 0) return false;
    begin_ = 0;
    end_ = static_cast<std::size_t>(count);
    received_ += end_;
    return true;
  }

  const socket_t socket_;
  const ConnectionLimits& limits_;
  const Clock::time_point deadline_;
  std::size_t received_ = 0;
  std::array<char, 4096> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace

bool is_loopback_name(std::string_view text) {
  if (text.find('\0') != std::string_view::npos) return false;  // what follows it would not be looked at below
  std::string name(text);
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  if (name == "localhost") return true;
  sockaddr_storage address{};
  auto& ip4 = reinterpret_cast<sockaddr_in&>(address);
  auto& ip6 = reinterpret_cast<sockaddr_in6&>(address);
  if (::inet_pton(AF_INET, name.c_str(), &ip4.sin_addr) == 1) {
    address.ss_family = AF_INET;
  } else if (::inet_pton(AF_INET6, name.c_str(), &ip6.sin6_addr) == 1) {
    address.ss_family = AF_INET6;
  }
  return is_loopback(address);
}

GuardedServer::GuardedServer(const ConnectionLimits& limits) : limits_(limits) {
  new_task_queue = [this] { return new httplib::ThreadPool(limits_.connections); };
}

void GuardedServer::widen_queue() { ::listen(svr_sock_, static_cast<int>(limits_.connections)); }

bool GuardedServer::is_at_loopback() const {
  sockaddr_storage address{};
  socklen_t size = sizeof address;
  return ::getsockname(svr_sock_, reinterpret_cast<sockaddr*>(&address), &size) == 0 && is_loopback(address);
}

void GuardedServer::close_connections() {
  const std::lock_guard lock(mutex_);
  is_closing_ = true;
  for (const socket_t socket : open_) ::shutdown(socket, SHUT_RDWR);
}

bool GuardedServer::process_and_close_socket(socket_t socket) {
  bool may_serve = false;
  {
    const std::lock_guard lock(mutex_);
    may_serve = !is_closing_;
    if (may_serve) open_.insert(socket);
  }
  if (may_serve) serve_connection(socket);
  ::shutdown(socket, SHUT_RDWR);
  const std::lock_guard lock(mutex_);  // the number may be another connection's as soon as it is closed
  open_.erase(socket);
  ::close(socket);
  return may_serve;
}

void GuardedServer::serve_connection(socket_t socket) {
  GuardedStream stream(socket, limits_);
  bool is_closed = false;
  const bool is_last = true;  // what follows a request may be its body, which a page of another site can write
  // Answers are whole: the library sends what lies behind them to who asks for a range that ends there.
  const auto without_ranges = [](httplib::Request& request) { request.ranges.clear(); };
  const auto answer = [&](auto& to) {  // later versions of the library ask for addresses, which nothing here reads
    if constexpr (requires { process_request(to, is_last, is_closed, without_ranges); }) {
      return process_request(to, is_last, is_closed, without_ranges);
    } else {
      return process_request(to, std::string(), 0, std::string(), 0, is_last, is_closed, without_ranges);
    }
  };
  if (!answer(stream)) return;
  // Closed with something unread, the client's system would throw the answer away.
  ::shutdown(socket, SHUT_WR);
  const Clock::time_point deadline = Clock::now() + kFarewell;
  char ignored[4096];
  while (wait_for(socket, POLLIN, deadline) && ::recv(socket, ignored, sizeof ignored, 0) > 0) continue;
}

}  // namespace snug::serve::internal
