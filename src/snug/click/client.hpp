// Client: the asking side of CLICK: one controller, connected to one simulator.
#pragma once

#include <memory>
#include <string>

#include "snug/click/message.hpp"

namespace snug::click {

class Client {
 public:
  /// Throws InputError for an address that is none. Nothing is sent before the first request.
  explicit Client(const std::string& endpoint, double patience = 10.0) : Client(endpoint, patience, "") {}
  /// One that only looks: handshakes and sensors, also while a controller is connected to a simulator of snug.
  [[nodiscard]] static Client watcher(const std::string& endpoint, double patience = 10.0);
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  /// One message and its answer, or why there is none: nobody answers within the patience [s], or what comes is no
  /// message. After that the client is of no use any more.
  [[nodiscard]] Expected<Message, std::string> request(const Message& message);

  /// The handshake, its version and its joints checked.
  [[nodiscard]] Expected<Handshake, std::string> shake_hands();
  [[nodiscard]] Expected<Sensor, std::string> sense();
  /// One step. An Error or a Reset instead of sensors is a reason.
  [[nodiscard]] Expected<Sensor, std::string> control(const Control& control);
  /// Empty, or why it was not reset.
  [[nodiscard]] std::string reset();
  /// Ends the session; has no answer.
  void report_error(const std::string& text);

 private:
  Client(const std::string& endpoint, double patience, const std::string& routing_id);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::click
