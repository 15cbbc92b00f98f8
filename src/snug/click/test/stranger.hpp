// Stranger: a simulator of another make, for tests of clients.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>
#include <zmq.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <utility>

#include "snug/click/message.hpp"
#include "snug/click/socket.hpp"

namespace snug::click::test {

/// A simulator of another make: it answers each frame by what it is told to.
class Stranger {
 public:
  explicit Stranger(std::function<Message(const Message& asked)> answer) : answer_(std::move(answer)) {
    EXPECT_EQ(zmq_bind(socket_.get(), endpoint_.c_str()), 0);
    thread_ = std::thread([this] { run(); });
  }
  ~Stranger() {
    is_stopping_ = true;
    thread_.join();
  }
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }

 private:
  void run() {
    while (!is_stopping_) {
      wire::Parts asked;
      if (!wire::receive(socket_.get(), asked)) {
        std::this_thread::sleep_for(std::chrono::microseconds(100));
        continue;
      }
      const auto message = decode(asked.parts.back());
      if (!message || std::holds_alternative<Error>(*message)) continue;
      for (std::size_t i = 0; i + 1 < asked.parts.size(); ++i) (void)wire::send(socket_.get(), asked.parts[i], true);
      (void)wire::send(socket_.get(), encode(answer_(*message)), false);
    }
  }
  static int& count() {
    static int made = 0;
    return made;
  }
  std::function<Message(const Message&)> answer_;
  std::string endpoint_ = "ipc://@snug_stranger_" + std::to_string(::getpid()) + "_" + std::to_string(++count());
  wire::Context context_ = wire::make_context();
  wire::Socket socket_ = wire::make_socket(context_.get(), ZMQ_ROUTER);
  std::atomic<bool> is_stopping_ = false;
  std::thread thread_;
};

}  // namespace snug::click::test
