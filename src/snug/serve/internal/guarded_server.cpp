// GuardedServer: what the library does with a socket, done with deadlines. Its own have none for a whole request: a
// client that sends a byte now and then would hold a thread for ever, and the server's end with it.
#include "snug/serve/internal/guarded_server.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace snug::serve::internal {
namespace {

using Clock = std::chrono::steady_clock;
constexpr int kRequestsPerConnection = 100;

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

/// One request and its answer on a connection.
class GuardedStream : public httplib::Stream {
 public:
  GuardedStream(socket_t socket, const ConnectionLimits& limits) : socket_(socket), limits_(limits) {}
  void begin_request() {
    deadline_ = Clock::now() + limits_.request;
    received_ = 0;
  }
  /// Is there something that was received but not asked for yet?
  [[nodiscard]] bool has_more() const { return begin_ < end_; }

  bool is_readable() const override { return has_more() || wait_for(socket_, POLLIN, deadline_); }
  bool is_writable() const override { return wait_for(socket_, POLLOUT, Clock::now() + limits_.write); }
  ssize_t read(char* to, size_t size) override {
    if (!has_more() && !fill()) return -1;
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
  Clock::time_point deadline_;
  std::size_t received_ = 0;
  std::array<char, 4096> buffer_;
  std::size_t begin_ = 0, end_ = 0;
};

}  // namespace

void ConnectionThreads::enqueue(std::function<void()> task) {
  const std::lock_guard lock(mutex_);
  tasks_.push_back(std::move(task));
  if (tasks_.size() > idle_ && threads_.size() < most_) threads_.emplace_back([this] { work(); });
  changed_.notify_one();
}

void ConnectionThreads::work() {
  std::unique_lock lock(mutex_);
  for (;;) {
    ++idle_;
    changed_.wait(lock, [this] { return !tasks_.empty() || is_over_; });
    --idle_;
    if (tasks_.empty()) return;
    const std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    lock.unlock();
    task();
    lock.lock();
  }
}

void ConnectionThreads::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

GuardedServer::GuardedServer(const ConnectionLimits& limits) : limits_(limits) {
  new_task_queue = [this] { return new ConnectionThreads(limits_.connections); };
}

void GuardedServer::widen_queue() { ::listen(svr_sock_, static_cast<int>(limits_.connections)); }

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
  for (int left = kRequestsPerConnection; left > 0; --left) {
    if (!stream.has_more() && !wait_for(socket, POLLIN, Clock::now() + limits_.keep_alive)) return;
    stream.begin_request();
    bool is_closed = false;
    if (!process_request(stream, left == 1, is_closed, nullptr) || is_closed) return;
  }
}

}  // namespace snug::serve::internal
