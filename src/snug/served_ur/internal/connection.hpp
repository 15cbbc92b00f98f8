// Connection: one client of a port: what it sent and was not read yet, what it has not taken yet.
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "snug/core/descriptor.hpp"
#include "snug/served_ur/server.hpp"
#include "snug/ur/rtde.hpp"

namespace snug::served_ur::internal {

class Connection {
 public:
  Connection(Descriptor socket, Port port) : socket_(std::move(socket)), port_(port) {}

  [[nodiscard]] int fd() const { return socket_.get(); }
  [[nodiscard]] Port port() const { return port_; }
  [[nodiscard]] bool is_open() const { return is_open_; }
  [[nodiscard]] bool has_unsent() const { return !out_.empty(); }

  /// Reads what there is into received(). Closes where the client has gone, or sent more than it may wait with.
  void receive();
  [[nodiscard]] std::string_view received() const { return std::string_view(in_).substr(taken_); }
  /// The first bytes of received() are read.
  void take(std::size_t bytes) { taken_ += bytes; }
  /// Takes the next whole line, without its end and a carriage return; false: there is none.
  [[nodiscard]] bool take_line(std::string& line);
  /// Sends what the client takes, keeps the rest. Closes where too much has to be kept.
  void send(std::string_view bytes);
  void flush() { send({}); }
  void close() { is_open_ = false; }
  /// Once everything is sent.
  void close_after_sending();

  std::unique_ptr<ur::RtdeSession> rtde;  ///< of a client of that port

  static constexpr std::size_t kMostUnread = std::size_t{5} << 20U;  ///< bytes: a script has at most 4 MB
  static constexpr std::size_t kMostUnsent = std::size_t{1} << 20U;  ///< bytes

 private:
  Descriptor socket_;
  Port port_;
  std::string in_, out_;
  std::size_t taken_ = 0;  ///< bytes of in_
  bool is_open_ = true, is_closing_ = false;
};

/// A line that no client of a text port says: the first of a request of HTTP, or one with control characters, as those
/// of TLS and STUN have. A page in a browser can send all of these to any port, with lines of its own behind.
[[nodiscard]] bool is_strangers(std::string_view line);

}  // namespace snug::served_ur::internal
