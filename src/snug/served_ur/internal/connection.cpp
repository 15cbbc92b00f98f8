// Connection: one client of a port: what it sent and was not read yet, what it has not taken yet.
#include "snug/served_ur/internal/connection.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

namespace snug::served_ur::internal {

void Connection::receive() {
  in_.erase(0, std::exchange(taken_, 0));
  std::array<char, 65536> buffer;
  const ssize_t count = ::recv(fd(), buffer.data(), buffer.size(), MSG_DONTWAIT);
  if (count > 0) {
    in_.append(buffer.data(), static_cast<std::size_t>(count));
    if (in_.size() > kMostUnread) close();
  } else if (count == 0 || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)) {
    close();
  }
}

bool Connection::take_line(std::string& line) {
  const std::string_view bytes = received();
  const std::size_t end = bytes.find('\n');
  if (end == std::string_view::npos) return false;
  line = bytes.substr(0, end);
  take(end + 1);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

void Connection::send(std::string_view bytes) {
  out_ += bytes;
  if (out_.empty() || !is_open_) return;
  const ssize_t count = ::send(fd(), out_.data(), out_.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR) return close();
  if (count > 0) out_.erase(0, static_cast<std::size_t>(count));
  if (out_.size() > kMostUnsent || (out_.empty() && is_closing_)) close();
}

void Connection::close_after_sending() {
  is_closing_ = true;
  if (out_.empty()) close();
}

bool is_strangers(std::string_view line) {
  const auto is_control = [](char c) {
    return (c > '\0' && c < ' ' && c != '\t' && c != '\r') ||
           c == '\x7f';  // NUL: clients in C send the end of a string
  };
  return line.find(" HTTP/") != std::string_view::npos || std::ranges::any_of(line, is_control);
}

}  // namespace snug::served_ur::internal
