// Client and Server over real sockets: a program through the wire is the program in the cell; peers come and go.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>
#include <zmq.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "cell.hpp"
#include "snug/click/client.hpp"
#include "snug/click/socket.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/test/scratch_folder.hpp"
#include "snug/served_cell/server.hpp"

namespace snug::served_cell {
namespace {

namespace wire = click::wire;
using click::Client;
using click::encode;
using click::HandshakeInit;
using click::Message;
using click::Reset;

using test::control_of;
using test::demonstrator_cell;
using test::kStill;

std::string an_address() {
  static int count = 0;
  return "ipc://" + (std::filesystem::temp_directory_path() /
                     ("snug_click_" + std::to_string(::getpid()) + "_" + std::to_string(++count)))
                        .string();
}

/// A server in a thread of its own.
class Served {
 public:
  explicit Served(SimulatorSettings settings = {}, const std::string& endpoint = an_address(), bool runs_at_once = true)
      : Served(std::move(settings), settings_of(endpoint), runs_at_once) {}
  Served(SimulatorSettings settings, ServerSettings server, bool runs_at_once = true)
      : simulator_(demonstrator_cell(), with_log(std::move(settings))), server_(simulator_, std::move(server)) {
    if (runs_at_once) run();
  }
  ~Served() { stop(); }
  void run() {
    thread_ = std::thread([this] { server_.run(); });
  }
  void stop() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] const std::string& endpoint() const { return server_.endpoint(); }
  std::vector<runs::RunResult> runs;

 private:
  SimulatorSettings with_log(SimulatorSettings settings) {
    settings.end_run = [this](int, const runs::RunResult& result) { runs.push_back(result); };
    return settings;
  }
  static ServerSettings settings_of(const std::string& endpoint) {
    ServerSettings settings;
    settings.endpoint = endpoint;
    return settings;
  }
  Simulator simulator_;
  Server server_;
  std::thread thread_;
};

TEST(ClientServer, TalkOverTcpAndIpc) {
  for (const std::string& address : {std::string("tcp://127.0.0.1:*"), an_address()}) {
    Served served({}, address);
    Client client(served.endpoint());
    const auto handshake = client.shake_hands();
    ASSERT_TRUE(handshake.has_value()) << handshake.error();
    for (int i = 1; i <= 10; ++i) {
      const auto sensor = client.control(control_of(kStill));
      ASSERT_TRUE(sensor.has_value()) << sensor.error();
      EXPECT_DOUBLE_EQ((*sensor)->time, 0.008 * i);
    }
    EXPECT_EQ(client.reset(), "");
    const auto wrong = client.control(control_of({1.0}));
    ASSERT_FALSE(wrong.has_value());
    EXPECT_NE(wrong.error().find("the simulator says: 1 values"), std::string::npos);
  }
}

TEST(ClientServer, TheFileOfAnAddressGoesWithItsServer) {
  const std::string address = an_address();
  const std::filesystem::path file = address.substr(std::string("ipc://").size());
  {
    const Served served({}, address);
    EXPECT_TRUE(std::filesystem::exists(file));
    EXPECT_THROW(Served({}, address), InputError);
    EXPECT_TRUE(std::filesystem::exists(file)) << "it is the first one's";
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(ClientServer, GiveTheCellToTheNextControllerWhenOneDies) {
  Served served;
  {
    Client client(served.endpoint());
    ASSERT_TRUE(client.shake_hands().has_value());
    ASSERT_TRUE(client.control(control_of({0.2, 0, 0, 0, 0, 0})).has_value());
    Client second(served.endpoint());
    ASSERT_TRUE(second.shake_hands().has_value()) << "it may look";
    const auto refused = second.control(control_of(kStill));
    ASSERT_FALSE(refused.has_value());
    EXPECT_NE(refused.error().find("another controller"), std::string::npos);
  }
  Client next(served.endpoint());
  const auto handshake = next.shake_hands();
  ASSERT_TRUE(handshake.has_value()) << handshake.error();
  const auto sensor = next.sense();
  ASSERT_TRUE(sensor.has_value());
  EXPECT_EQ((*sensor)->time, 0.0);
  served.stop();
  ASSERT_EQ(served.runs.size(), 1u);
  EXPECT_EQ(served.runs[0].ended_by, "the controller left");
}

/// A peer that says something and does not wait for the answer.
class Impolite {
 public:
  explicit Impolite(const std::string& endpoint) : socket_(wire::make_socket(context_.get(), ZMQ_DEALER, 10000)) {
    EXPECT_EQ(zmq_connect(socket_.get(), endpoint.c_str()), 0);
  }
  void say(const Message& message) { EXPECT_TRUE(wire::send(socket_.get(), encode(message), false)); }

 private:
  wire::Context context_ = wire::make_context();  // ends when all is sent
  wire::Socket socket_;
};

TEST(ClientServer, PeerThatIsGoneBeforeItIsReadDoesNotKeepTheCell) {
  using namespace std::chrono_literals;
  for (const std::string& address : {std::string("tcp://127.0.0.1:*"), an_address()}) {
    for (const bool is_followed : {false, true}) {  // by a peer that stays, silent, and gets its descriptor
      Served served({}, address, false);
      Impolite(served.endpoint()).say(HandshakeInit{});
      std::this_thread::sleep_for(100ms);  // for ZeroMQ to see that it left
      std::unique_ptr<Impolite> follower;
      if (is_followed) follower = std::make_unique<Impolite>(served.endpoint());
      std::this_thread::sleep_for(100ms);
      served.run();
      Client client(served.endpoint());
      const auto handshake = client.shake_hands();
      EXPECT_TRUE(handshake.has_value()) << address << ": " << handshake.error();
    }
  }
}

TEST(ClientServer, ComingAndGoingOfManyLeavesTheControllerAlone) {
  for (const std::string& address : {std::string("tcp://127.0.0.1:*"), an_address()}) {
    Served served({}, address);
    for (int round = 0; round < 20; ++round) {
      for (int i = 0; i < 5; ++i) Impolite(served.endpoint()).say(HandshakeInit{});
      Client client(served.endpoint());
      const auto handshake = client.shake_hands();
      ASSERT_TRUE(handshake.has_value()) << address << ", round " << round << ": " << handshake.error();
      for (int i = 1; i <= 5; ++i) {
        Impolite(served.endpoint()).say(HandshakeInit{});
        Impolite(served.endpoint()).say(Reset{});
        const auto sensor = client.control(control_of(kStill));
        ASSERT_TRUE(sensor.has_value()) << address << ", round " << round << ": " << sensor.error();
        EXPECT_DOUBLE_EQ((*sensor)->time, 0.008 * i);
      }
    }
    served.stop();
    EXPECT_GE(served.runs.size(), 19u) << "of the last one the end may come too late";
    for (const runs::RunResult& result : served.runs) EXPECT_NEAR(result.duration, 0.04, 1e-12);
  }
}

TEST(ClientServer, GiveUpOnSilence) {
  Client client(an_address(), 0.05);
  const auto handshake = client.shake_hands();
  ASSERT_FALSE(handshake.has_value());
  EXPECT_NE(handshake.error().find("nobody answers within 0.05 s"), std::string::npos);
}

/// Bytes that a stranger writes to the port, and what the simulator has answered them.
std::string write_raw(const std::string& endpoint, const std::string& bytes) {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  EXPECT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  const timeval patience{0, 300000};
  ::setsockopt(socket, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  std::string answer;
  char buffer[4096];
  (void)!::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  for (ssize_t got = 0; (got = ::recv(socket, buffer, sizeof buffer, 0)) > 0;)
    answer.append(buffer, static_cast<std::size_t>(got));
  ::close(socket);
  return answer;
}

std::string framed(const std::string& payload) {  // ZMTP 1.0: length with the flags, flags, bytes
  return static_cast<char>(payload.size() + 1) + std::string(1, '\0') + payload;
}

/// What a browser sends for `fetch(address, {method: "POST", mode: "no-cors", body})`: the page chooses path and body.
/// As ZMTP 1.0 'P' is a length, 80, and so on; the body is padded up to where the frame ends that reaches into it.
std::string request_of_a_page(const std::string& frames) {
  for (std::size_t pad = 0; pad < 200; ++pad) {
    const std::string head = "POST /" + std::string(pad, 'x') +
                             " HTTP/1.1\r\nHost: 127.0.0.1:5555\r\nOrigin: http://page.example\r\nContent-Type: "
                             "text/plain;charset=UTF-8\r\nContent-Length: 300\r\n\r\n";
    std::size_t begin = 0, at = 0;
    while (at < head.size()) {
      begin = at;
      at += 1 + static_cast<std::size_t>(head[at]);
    }
    if (begin + 1 >= head.size() || (head[begin + 1] & 1) != 0) continue;  // a frame of the same message would follow
    std::string body = std::string(at - head.size(), '\0') + frames;
    body.resize(300, 'x');
    return head + body;
  }
  ADD_FAILURE() << "no path is long enough";
  return {};
}

TEST(Server, DoesNotTakeBytesWithoutAGreetingForMessages) {
  ServerSettings settings;
  settings.endpoint = "tcp://127.0.0.1:*";
  Served served({}, settings);
  const std::vector<Message> messages = {HandshakeInit{}, control_of({0.2, 0, 0, 0, 0, 0})};
  std::string frames;
  for (const Message& message : messages) frames += framed(encode(message));
  (void)write_raw(served.endpoint(), request_of_a_page(frames));
  (void)write_raw(served.endpoint(), std::string("\1\0", 2) + frames);  // an empty routing id, as old peers greet
  // ZMTP 2.0: signature, revision 1, a DEALER, an empty identity, then frames
  std::string second("\xff\0\0\0\0\0\0\0\1\x7f\1\5\0\0", 14);
  for (const Message& message : messages) {
    const std::string frame = encode(message);
    second += std::string(1, '\0') + static_cast<char>(frame.size()) + frame;
  }
  (void)write_raw(served.endpoint(), second);
  Client client(served.endpoint());
  ASSERT_TRUE(client.shake_hands().has_value());
  served.stop();
  EXPECT_TRUE(served.runs.empty()) << "a stranger's Control began a run";
}

TEST(Server, LetsInWhoHasAKeyOfItsFolderAndNobodyElse) {
  const snug::test::ScratchFolder folder;
  for (const char* name : {"server", "controller"}) click::make_keys(folder / "keys", name);
  for (const char* name : {"server", "controller"}) click::make_keys(folder / "strangers", name);
  for (const std::string& address : {std::string("tcp://127.0.0.1:*"), an_address()}) {
    ServerSettings settings;
    settings.endpoint = address;
    settings.keys = click::load_server_keys(folder / "keys");
    Served served({}, settings);
    const click::ClientKeys right = click::load_client_keys(folder / "keys");
    click::ClientKeys wrong_server = right, wrong_client = right;
    wrong_server.server_public_key = click::load_client_keys(folder / "strangers").server_public_key;
    wrong_client.own = click::load_client_keys(folder / "strangers").own;
    EXPECT_FALSE(Client(served.endpoint(), 0.3).shake_hands().has_value()) << "without keys";
    EXPECT_FALSE(Client(served.endpoint(), 0.3, wrong_server).shake_hands().has_value());
    EXPECT_FALSE(Client(served.endpoint(), 0.3, wrong_client).shake_hands().has_value());
    Client client(served.endpoint(), 10.0, right);
    const auto handshake = client.shake_hands();
    ASSERT_TRUE(handshake.has_value()) << handshake.error();
    EXPECT_TRUE(client.control(control_of(kStill)).has_value());
  }
}

TEST(Server, IsBoundForOtherMachinesWithKeys) {
  const snug::test::ScratchFolder folder;
  for (const char* name : {"server", "controller"}) click::make_keys(folder / "keys", name);
  ServerSettings settings;
  settings.endpoint = "tcp://0.0.0.0:*";
  EXPECT_THROW(Served({}, settings), InputError);
  settings.keys = click::load_server_keys(folder / "keys");
  const Served served({}, settings);
  const std::string port = served.endpoint().substr(served.endpoint().rfind(':'));
  Client client("tcp://127.0.0.1" + port, 10.0, click::load_client_keys(folder / "keys"));
  EXPECT_TRUE(client.shake_hands().has_value());
}

TEST(Server, GivesTheCellOfASilentControllerToTheNext) {
  using namespace std::chrono_literals;
  ServerSettings settings;
  settings.endpoint = an_address();
  settings.lease = 0.5;
  Served served({}, settings);
  Client silent(served.endpoint()), next(served.endpoint());
  ASSERT_TRUE(silent.shake_hands().has_value());
  EXPECT_TRUE(silent.control(control_of(kStill)).has_value());
  ASSERT_TRUE(next.shake_hands().has_value());
  EXPECT_FALSE(next.control(control_of(kStill)).has_value()) << "it was not silent for long";
  std::this_thread::sleep_for(600ms);
  EXPECT_TRUE(next.shake_hands().has_value());
  EXPECT_TRUE(silent.control(control_of(kStill)).has_value()) << "nobody else wants to command";
  EXPECT_FALSE(next.control(control_of(kStill)).has_value());
  std::this_thread::sleep_for(600ms);
  EXPECT_TRUE(next.control(control_of(kStill)).has_value());
  EXPECT_FALSE(silent.control(control_of(kStill)).has_value());
  served.stop();
  ASSERT_EQ(served.runs.size(), 1u);
  EXPECT_EQ(served.runs[0].ended_by, "the controller was silent, and another one took its place");
}

TEST(Server, RefusesAddressesThatAreNoneOrNotForEverybody) {
  for (const char* endpoint : {"", "5555", "udp://127.0.0.1:1", "tcp://", "tcp://127.0.0.1", "tcp://127.0.0.1:99999",
                               "tcp://*:5555", "tcp://0.0.0.0:5555", "ipc://", "ipc:///no/such/folder/socket"}) {
    EXPECT_THROW(Served({}, endpoint), InputError) << endpoint;
  }
  const snug::test::ScratchFolder folder;
  const std::filesystem::path file = folder / "file";
  std::ofstream(file) << "precious";
  EXPECT_THROW(Served({}, "ipc://" + file.string()), InputError);
  EXPECT_TRUE(std::filesystem::exists(file)) << "ZeroMQ would have removed it";
  Served served;
  EXPECT_THROW(Served({}, served.endpoint()), InputError) << "another server is there";
}

}  // namespace
}  // namespace snug::served_cell
