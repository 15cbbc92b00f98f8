// Listener: a guarded server at an address, who may ask it, and how it begins and ends. Internal to the module.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "snug/serve/internal/guarded_server.hpp"
#include "snug/serve/internal/visitors.hpp"
#include "snug/serve/server.hpp"

namespace snug::serve::internal {

/// How often a stream that has nothing to tell sends a comment, by which a watcher that left is noticed.
inline constexpr std::chrono::milliseconds kHeartbeat(500);

class Listener {
 public:
  explicit Listener(ServerSettings settings, const ConnectionLimits& limits = {});
  /// Begins to listen; requests wait until run(). Throws InputError when the address cannot be had.
  void bind(TokenUse token);

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::string address() const;
  void run();
  void stop();
  [[nodiscard]] bool is_stopping() const { return is_stopping_; }
  /// After bind().
  [[nodiscard]] const Visitors& visitors() const { return *visitors_; }

  GuardedServer server;
  std::atomic<int> watchers = 0;  ///< open streams

 private:
  ServerSettings settings_;
  std::atomic<bool> is_stopping_ = false, is_in_run_ = false;
  std::optional<Visitors> visitors_;
  int port_ = 0;
};

/// Not set_content: that packs with brotli at its slowest, seconds for a page.
void answer_whole(httplib::Response& response, std::shared_ptr<const std::string> bytes, const std::string& type);
/// A place among the watchers; false, with an answer that says so, when all are taken.
[[nodiscard]] bool take_place(std::atomic<int>& watchers, int most, httplib::Response& response);

}  // namespace snug::serve::internal
