// GuardedServer: httplib's server behind connections that are limited in time, size and number. Internal to the module.
#pragma once

#include <httplib.h>

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace snug::serve::internal {

/// What one connection may take.
struct ConnectionLimits {
  std::chrono::milliseconds request{5000};     ///< from the first byte of a request to its last
  std::chrono::milliseconds keep_alive{2000};  ///< until the first byte of the next one
  std::chrono::milliseconds write{5000};       ///< without the client taking anything
  std::size_t request_bytes = std::size_t{256} << 10U;
  std::size_t connections = 128;  ///< at the same time; those after them wait
};

/// A thread for each connection, so that slow ones hold up nobody; made when needed, kept until the end.
class ConnectionThreads : public httplib::TaskQueue {
 public:
  explicit ConnectionThreads(std::size_t most) : most_(most) {}
  void enqueue(std::function<void()> task) override;
  void shutdown() override;

 private:
  void work();

  const std::size_t most_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  std::vector<std::thread> threads_;
  std::size_t idle_ = 0;
  bool is_over_ = false;
};

class GuardedServer : public httplib::Server {
 public:
  explicit GuardedServer(const ConnectionLimits& limits = {});
  /// Lets as many connections wait for their turn as may be open; the library's own number is 5. After binding.
  void widen_queue();
  /// Ends all connections, whatever they are doing, and those to come.
  void close_connections();

 private:
  bool process_and_close_socket(socket_t socket) override;
  void serve_connection(socket_t socket);

  const ConnectionLimits limits_;
  std::mutex mutex_;
  std::set<socket_t> open_;
  bool is_closing_ = false;
};

}  // namespace snug::serve::internal
