// Server: its five ports as clients and strangers meet them.
#include "snug/served_ur/server.hpp"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "snug/core/descriptor.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/rng.hpp"
#include "snug/served_ur/test/served.hpp"
#include "snug/ur/rtde.hpp"

namespace snug::served_ur {
namespace {

using namespace std::string_literals;

using test::Served;

/// A client of one port.
class Client {
 public:
  Client(const Served& served, Port port) : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in at = {};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    at.sin_port = htons(static_cast<std::uint16_t>(static_cast<int>(port) + served.offset()));
    EXPECT_EQ(::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&at), sizeof at), 0);
  }
  void say(const std::string& bytes) const { (void)::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  /// What comes until `count` bytes are there, the other side closes, or five seconds are over.
  std::string hear(std::size_t count) {
    while (bytes_.size() < count && receive()) {
    }
    const std::string heard = bytes_.substr(0, count);
    bytes_.erase(0, count);
    return heard;
  }
  std::string line() {
    while (bytes_.find('\n') == std::string::npos && receive()) {
    }
    const std::string heard = bytes_.substr(0, bytes_.find('\n'));
    bytes_.erase(0, heard.size() + 1);
    return heard;
  }
  /// The other side has closed, within five seconds.
  bool is_closed() {
    while (receive()) bytes_.clear();
    return is_closed_;
  }

 private:
  bool receive() {
    pollfd source = {socket_.get(), POLLIN, 0};
    if (is_closed_ || ::poll(&source, 1, 5000) <= 0) return false;
    char buffer[4096];
    const ssize_t count = ::recv(socket_.get(), buffer, sizeof buffer, 0);
    is_closed_ = count <= 0;
    if (count > 0) bytes_.append(buffer, static_cast<std::size_t>(count));
    return count > 0;
  }
  Descriptor socket_;
  std::string bytes_;
  bool is_closed_ = false;
};

TEST(Server, SpeaksOnItsFivePorts) {
  const Served served;
  Client dashboard(served, Port::Dashboard);
  EXPECT_TRUE(dashboard.line().starts_with("Connected: "));
  dashboard.say("robotmode\nquit\n");
  EXPECT_EQ(dashboard.line(), "Robotmode: RUNNING");
  EXPECT_EQ(dashboard.line(), "Disconnected");
  EXPECT_TRUE(dashboard.is_closed());
  for (const Port port : {Port::Primary, Port::Secondary}) {
    Client client(served, port);
    const std::string version = client.hear(5);
    EXPECT_EQ(version[4], 20);  // the version first
    (void)client.hear(static_cast<std::size_t>(version[3]) - 5);
    EXPECT_EQ(client.hear(5)[4], 16);
  }
  Client real_time(served, Port::RealTime);
  EXPECT_EQ(real_time.hear(1140).substr(0, 4), "\0\0\x04\x74"s);
  Client rtde(served, Port::Rtde);
  rtde.say("\x00\x05V\x00\x02"s);
  EXPECT_EQ(rtde.hear(4), "\x00\x04V\x01"s);
}

TEST(Server, PowerGoesOffAndOnByLinesOfThePrimaryPort) {
  const Served served;
  Client primary(served, Port::Primary), dashboard(served, Port::Dashboard);
  (void)dashboard.line();
  const auto wait_for = [&](const std::string& mode) {
    for (int i = 0; i < 200; ++i) {
      dashboard.say("robotmode\n");
      if (dashboard.line() == "Robotmode: " + mode) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  };
  primary.say("power off\n");
  EXPECT_TRUE(wait_for("POWER_OFF"));
  primary.say("power on\n");
  EXPECT_TRUE(wait_for("IDLE"));
  primary.say("set robotmode run\n");
  EXPECT_TRUE(wait_for("RUNNING"));
}

TEST(Server, ClosesOnRequestsOfBrowsers) {
  const Served served;
  for (const Port port : {Port::Dashboard, Port::Primary, Port::Secondary, Port::RealTime, Port::Rtde}) {
    Client page(served, port);
    page.say("POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\npower off\n");
    EXPECT_TRUE(page.is_closed()) << static_cast<int>(port);
  }
  // A ticket of TLS, and a name in STUN, are bytes that a page's server chose.
  const std::string hello = "\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03"s, stun = "\x00\x03\x00\x10\x21\x12\xa4\x42"s;
  for (const Port port : {Port::Dashboard, Port::Primary, Port::Secondary, Port::RealTime, Port::Rtde}) {
    for (const std::string& head : {hello, stun}) {
      Client page(served, port);
      page.say(head + "\npower off\n");
      EXPECT_TRUE(page.is_closed()) << static_cast<int>(port);
    }
  }
  Client dashboard(served, Port::Dashboard);
  (void)dashboard.line();
  dashboard.say("robotmode\n");
  EXPECT_EQ(dashboard.line(), "Robotmode: RUNNING");
}

TEST(Server, LetsInSoManyAndGoesOn) {
  const Served served;
  std::vector<std::unique_ptr<Client>> many;
  for (int i = 0; i < Server::kMostClients; ++i) {
    many.push_back(std::make_unique<Client>(served, Port::Dashboard));
    EXPECT_TRUE(many.back()->line().starts_with("Connected: "));
  }
  Client last(served, Port::Dashboard);
  EXPECT_TRUE(last.is_closed());
  many.front()->say("running\n");
  EXPECT_EQ(many.front()->line(), "Program running: false");
}

TEST(Server, OutlivesNoise) {
  const Served served;
  Rng rng = Rng(48).split("noise");
  for (int i = 0; i < 60; ++i) {
    Client client(served, std::array{Port::Dashboard, Port::Primary, Port::RealTime,
                                     Port::Rtde}[static_cast<std::size_t>(i % 4)]);
    std::string noise(static_cast<std::size_t>(1 + rng.index(3000)), '\0');
    for (char& c : noise) c = static_cast<char>(rng.index(256));
    client.say(noise);
  }
  Client dashboard(served, Port::Dashboard);
  EXPECT_TRUE(dashboard.line().starts_with("Connected: "));
}

TEST(Server, RefusesAddressesThatOthersCanReachUnlessTheyAreNamed) {
  Controller controller(test::demonstrator_cell(), {});
  ServerSettings settings;
  settings.port_offset = 31000 + static_cast<int>(::getpid() % 400) * 10;
  settings.host = "0.0.0.0";
  EXPECT_THROW(Server(controller, settings), InputError);
  settings.clients = {"not an address"};
  EXPECT_THROW(Server(controller, settings), InputError);
  settings.clients = {"192.0.2.7"};
  EXPECT_NO_THROW(Server(controller, settings));
  settings.host = "robot";
  EXPECT_THROW(Server(controller, settings), InputError);
}

}  // namespace
}  // namespace snug::served_ur
