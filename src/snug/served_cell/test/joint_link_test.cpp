// JointLink: what a simulator says of time and joints is checked before anything is steered by it.
#include "snug/click/joint_link.hpp"

#include <gtest/gtest.h>
#include <unistd.h>
#include <zmq.h>

#include <atomic>
#include <functional>
#include <limits>
#include <thread>

#include "cell.hpp"
#include "snug/click/socket.hpp"

namespace snug::served_cell {
namespace {

namespace wire = click::wire;
using click::Client;
using click::encode;
using click::Handshake;
using click::JointLink;
using click::Message;
using click::Sensor;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// A simulator in a thread of its own, each of its answers changed on the way.
class Relay {
 public:
  explicit Relay(std::function<void(Message&)> change) : change_(std::move(change)) {
    static int count = 0;
    endpoint_ = "ipc://@snug_relay_" + std::to_string(::getpid()) + "_" + std::to_string(++count);
    EXPECT_EQ(zmq_bind(socket_.get(), endpoint_.c_str()), 0);
    thread_ = std::thread([this] { run(); });
  }
  ~Relay() {
    is_stopping_ = true;
    thread_.join();
  }
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }

 private:
  void run() {
    while (!is_stopping_) {
      zmq_pollitem_t item = {socket_.get(), 0, ZMQ_POLLIN, 0};
      wire::Parts heard;
      if (zmq_poll(&item, 1, 20) <= 0 || !wire::receive(socket_.get(), heard)) continue;
      Message answer = talk_.hear(heard.parts.front());
      change_(answer);
      (void)wire::send(socket_.get(), encode(answer), false);
    }
  }
  std::function<void(Message&)> change_;
  std::string endpoint_;
  wire::Context context_ = wire::make_context();
  wire::Socket socket_ = wire::make_socket(context_.get(), ZMQ_REP);
  test::Talk talk_;
  std::atomic<bool> is_stopping_ = false;
  std::thread thread_;
};

std::string connect(std::function<void(Message&)> change) {
  const Relay relay(std::move(change));
  Client client(relay.endpoint(), 10.0);
  JointLink link(client, test::demonstrator_cell().arm()->model(), {});
  return link.connect(0.008);
}

TEST(JointLink, ConnectsToWhatItUnderstands) {
  EXPECT_EQ(connect([](Message&) {}), "");
}

TEST(JointLink, RefusesTimesThatAreNoNumbers) {
  EXPECT_NE(connect([](Message& answer) {
              if (auto* handshake = std::get_if<Handshake>(&answer)) handshake->time_step = kNaN;
            }).find("steps by nan s"),
            std::string::npos);
  EXPECT_NE(connect([](Message& answer) {
              if (auto* sensor = std::get_if<Sensor>(&answer)) sensor->time = kNaN;
            }).find("not numbers"),
            std::string::npos);
}

}  // namespace
}  // namespace snug::served_cell
