// Client: the asking side of CLICK: one controller, connected to one simulator.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "snug/click/keys.hpp"
#include "snug/click/message.hpp"

namespace snug::click {

class Client {
 public:
  /// Throws InputError for an address that is none. Nothing is sent before the first request. With keys the simulator
  /// has to have those of its own that are expected, and what is said is encrypted.
  explicit Client(const std::string& endpoint, double patience = 10.0, const std::optional<ClientKeys>& keys = {})
      : Client(endpoint, patience, keys, "") {}
  /// One that only looks: handshakes and sensors, also while a controller is connected to a simulator of snug.
  [[nodiscard]] static Client watcher(const std::string& endpoint, double patience = 10.0,
                                      const std::optional<ClientKeys>& keys = {});
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  /// One message and its answer, or why there is none: nobody answers within the patience [s], or what comes is no
  /// message. After that the client is of no use any more.
  [[nodiscard]] Expected<Message, std::string> request(const Message& message);

  /// The handshake, its version and its joints checked.
  [[nodiscard]] Expected<Handshake, std::string> shake_hands();
  /// What a simulator senses, valid until the next sense() or control(). An Error or a Reset instead is a reason.
  using Sensed = Expected<const Sensor*, std::string>;
  [[nodiscard]] Sensed sense();
  /// One step.
  [[nodiscard]] Sensed control(const Control& control);
  /// Empty, or why it was not reset.
  [[nodiscard]] std::string reset();
  /// Ends the session; has no answer.
  void report_error(const std::string& text);

 private:
  Client(const std::string& endpoint, double patience, const std::optional<ClientKeys>& keys,
         const std::string& routing_id);
  [[nodiscard]] Sensed ask(const Message& message, const char* what);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::click
