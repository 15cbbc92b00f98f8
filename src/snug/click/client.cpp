// Client: the asking side of CLICK: one controller, connected to one simulator.
#include "snug/click/client.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <atomic>
#include <utility>

#include "snug/click/internal/sensor_reader.hpp"
#include "snug/click/names.hpp"
#include "snug/click/socket.hpp"
#include "snug/click/spin_wait.hpp"
#include "snug/core/text.hpp"

namespace snug::click {
namespace {

using Reason = Unexpected<std::string>;

constexpr std::int64_t kLongestAnswer = std::int64_t{16} << 20;  ///< of an answer
constexpr int kLinger = 200;                                     ///< ms, for what was said last

/// Names are shown on terminals and in tables, and are looked up: they are short text, or the peer is no simulator.
std::string find_bad_name(const Handshake& handshake) {
  constexpr std::size_t kLongestName = 100;
  const auto is_bad = [](const std::string& name) { return name.size() > kLongestName || !is_printable(name); };
  for (const auto& [name, object] : handshake.objects) {
    if (is_bad(name)) return name;
    for (const auto* names : {&object.controls, &object.joints}) {
      const auto bad = std::ranges::find_if(*names, is_bad);
      if (bad != names->end()) return *bad;
    }
    for (const auto& [event, is_on] : object.events) {
      if (is_bad(event)) return event;
    }
  }
  return {};
}

/// The answer as one of the kind that was asked for.
template <class T>
Expected<T, std::string> expect(Expected<Message, std::string> answer, const char* what) {
  if (!answer) return Reason(std::move(answer.error()));
  if (auto* expected = std::get_if<T>(&*answer)) return std::move(*expected);
  if (const auto* error = std::get_if<Error>(&*answer))
    return Reason("the simulator says: " + printable(error->text, kLongestMessage));
  if (std::holds_alternative<Reset>(*answer)) return Reason("the simulator was reset");
  return Reason(fmt::format("the simulator answered {} with a {}", what, name_of(*answer)));
}

}  // namespace

struct Client::Impl {
  Impl(const std::string& address, double seconds, const std::optional<ClientKeys>& keys, const std::string& routing_id)
      : endpoint(address), patience(seconds), has_keys(keys) {
    wire::check_endpoint(endpoint);
    socket = wire::make_socket(context.get(), ZMQ_REQ, kLinger);
    if (!routing_id.empty()) {
      (void)zmq_setsockopt(socket.get(), ZMQ_ROUTING_ID, routing_id.data(), routing_id.size());
    }
    if (keys) {
      wire::set(socket.get(), ZMQ_CURVE_SERVERKEY, keys->server_public_key);
      wire::set(socket.get(), ZMQ_CURVE_PUBLICKEY, keys->own.public_key);
      wire::set(socket.get(), ZMQ_CURVE_SECRETKEY, keys->own.secret_key);
    }
    wire::set(socket.get(), ZMQ_MAXMSGSIZE, kLongestAnswer);
    wire::set(socket.get(), ZMQ_IPV6, endpoint.starts_with("tcp://[") ? 1 : 0);
    const int milliseconds = static_cast<int>(1e3 * patience);
    wire::set(socket.get(), ZMQ_RCVTIMEO, milliseconds);
    wire::set(socket.get(), ZMQ_SNDTIMEO, milliseconds);
    if (zmq_connect(socket.get(), endpoint.c_str()) != 0) {
      // check_endpoint said yes: what is left is a host that cannot be.
      throw std::runtime_error(endpoint + ": " + zmq_strerror(errno));
    }
  }

  std::string endpoint;
  double patience;
  bool has_keys;
  wire::Context context = wire::make_context();
  wire::Socket socket;

  wire::SpinWait spin;
  internal::SensorReader sensors;

  /// The bytes of the answer to a message.
  [[nodiscard]] Expected<std::string, std::string> exchange(const Message& message);

  /// False: errno says why none came.
  bool receive(zmq_msg_t& answer) {
    bool is_there = false;
    const auto has_ended = [&] {
      is_there = zmq_msg_recv(&answer, socket.get(), ZMQ_DONTWAIT) >= 0;
      return is_there || errno != EAGAIN;
    };
    if (spin.wait(has_ended, wire::SpinWait::Clock::now())) return is_there;
    return zmq_msg_recv(&answer, socket.get(), 0) >= 0;
  }
};

Client::Client(const std::string& endpoint, double patience, const std::optional<ClientKeys>& keys,
               const std::string& routing_id)
    : impl_(std::make_unique<Impl>(endpoint, patience, keys, routing_id)) {}

Client Client::watcher(const std::string& endpoint, double patience, const std::optional<ClientKeys>& keys) {
  static std::atomic<int> count = 0;
  return {endpoint, patience, keys, fmt::format("{}-{}-{}", kWatcher, ::getpid(), count++)};
}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;

Expected<std::string, std::string> Client::Impl::exchange(const Message& message) {
  const std::string frame = encode(message);
  const auto fail = [&](const char* what) {
    return Reason(errno == EAGAIN ? fmt::format("{}: nobody answers{} within {} s", endpoint,
                                                has_keys ? " who has these keys" : "", patience)
                                  : fmt::format("{}: {}: {}", endpoint, what, zmq_strerror(errno)));
  };
  if (zmq_send(socket.get(), frame.data(), frame.size(), 0) < 0) return fail("sending");
  zmq_msg_t answer;
  zmq_msg_init(&answer);
  if (!receive(answer)) {
    zmq_msg_close(&answer);
    return fail("receiving");
  }
  std::string bytes(static_cast<const char*>(zmq_msg_data(&answer)), zmq_msg_size(&answer));
  zmq_msg_close(&answer);
  return bytes;
}

Expected<Message, std::string> Client::request(const Message& message) {
  const auto answer = impl_->exchange(message);
  if (!answer) return Reason(answer.error());
  return decode(*answer);
}

Client::Sensed Client::ask(const Message& message, const char* what) {
  const auto answer = impl_->exchange(message);
  if (!answer) return Reason(answer.error());
  if (const Sensor* sensor = impl_->sensors.read(*answer)) return sensor;
  auto sensor = expect<Sensor>(decode(*answer), what);
  if (!sensor) return Reason(std::move(sensor.error()));
  return &impl_->sensors.learn(*answer, std::move(*sensor));
}

Expected<Handshake, std::string> Client::shake_hands() {
  auto handshake = expect<Handshake>(request(HandshakeInit{}), "the handshake");
  if (!handshake) return handshake;
  if (handshake->version != kVersion) {
    return Reason(fmt::format("the simulator speaks version {}, not {}", handshake->version, kVersion));
  }
  if (const std::string bad = find_bad_name(*handshake); !bad.empty()) {
    return Reason(fmt::format("the simulator uses the name '{}', which is invalid", printable(bad, 100)));
  }
  for (const auto& [name, object] : handshake->objects) {
    if (object.controls.size() != object.control_types.size()) {
      return Reason(fmt::format("object '{}' has {} joints to control and {} types for them", name,
                                object.controls.size(), object.control_types.size()));
    }
  }
  return handshake;
}

Client::Sensed Client::sense() { return ask(SensorRequest{}, "a SensorRequest"); }

Client::Sensed Client::control(const Control& control) { return ask(control, "a Control"); }

std::string Client::reset() {
  const auto answer = expect<Reset>(request(Reset{}), "a Reset");
  return answer ? "" : answer.error();
}

void Client::report_error(const std::string& text) {
  const std::string frame = encode(Error{text});
  (void)zmq_send(impl_->socket.get(), frame.data(), frame.size(), ZMQ_DONTWAIT);
}

}  // namespace snug::click
