// ObserverPort: an address at which CLICK observers see a cell that something else drives.
#include "snug/served_cell/observer_port.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "snug/click/authenticator.hpp"
#include "snug/click/socket.hpp"
#include "snug/core/input_error.hpp"
#include "snug/served_cell/simulator.hpp"

namespace snug::served_cell {
namespace {

constexpr int kMostAnswers = 64;  // in one call: who asks on and on does not keep the cell from going on

std::string answer_of_observer(const ServedCell& cell, std::string_view frame, const auto& sense) {
  if (frame.size() > kLargestFrame) return click::encode(click::Error{"a frame that is too large"});
  const auto message = click::decode(frame);
  if (!message) return click::encode(click::Error{message.error()});
  if (const auto* init = std::get_if<click::HandshakeInit>(&*message)) {
    if (init->version == click::kVersion) return click::encode(cell.handshake());
    return click::encode(
        click::Error{fmt::format("version {} is not supported, expected {}", init->version, click::kVersion)});
  }
  if (std::holds_alternative<click::SensorRequest>(*message)) return sense();
  return click::encode(
      click::Error{fmt::format("a {} is for controllers; this address is for observers", click::name_of(*message))});
}

}  // namespace

struct ObserverPort::Impl {
  Impl(const cell::Simulation& simulation, const std::string& wanted) : cell(simulation, settings()) {
    click::wire::check_endpoint(wanted);
    const auto refuse = [&](const std::string& got, const char* expected) {
      throw InputError("command line", "--observers", "'" + wanted + "'" + got, expected);
    };
    if (!click::wire::is_local(wanted)) refuse(", which other machines can reach", "an address of this machine");
    socket = click::wire::make_socket(context.get(), ZMQ_ROUTER, 200);
    click::wire::set(socket.get(), ZMQ_MAXMSGSIZE, static_cast<std::int64_t>(kLargestFrame));
    click::wire::refuse_old_peers(socket.get());
    std::string address = wanted;
    constexpr std::string_view kHere = "tcp://localhost:";  // a name that ZeroMQ binds to nothing
    if (address.starts_with(kHere)) address.replace(0, kHere.size(), "tcp://127.0.0.1:");
    if (zmq_bind(socket.get(), address.c_str()) != 0)
      refuse(std::string(": ") + zmq_strerror(zmq_errno()), "an address that is free");
    std::array<char, 256> bound{};
    std::size_t size = bound.size();
    endpoint = zmq_getsockopt(socket.get(), ZMQ_LAST_ENDPOINT, bound.data(), &size) == 0 ? bound.data() : wanted;
  }
  ~Impl() {
    // ZeroMQ leaves the file of ipc:// behind.
    if (const std::string file = click::wire::path_of(endpoint); !file.empty()) ::unlink(file.c_str());
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  static ServedCellSettings settings() {
    ServedCellSettings one;
    one.is_plant = true;
    return one;
  }

  ServedCell cell;
  click::wire::Context context = click::wire::make_context();
  click::wire::Socket socket;
  std::string endpoint;
  WrittenBodies written;
};

ObserverPort::ObserverPort(const cell::Simulation& simulation, const std::string& endpoint)
    : impl_(std::make_unique<Impl>(simulation, endpoint)) {}
ObserverPort::~ObserverPort() = default;
const std::string& ObserverPort::endpoint() const { return impl_->endpoint; }

void ObserverPort::answer(const cell::CellState& state, const cell::ArmReading& reading, const Wrench& load) {
  for (int i = 0; i < kMostAnswers; ++i) {
    click::wire::Parts message;
    if (!click::wire::receive(impl_->socket.get(), message)) return;
    if (message.parts.size() < 2) continue;
    const std::string reply = answer_of_observer(impl_->cell, message.parts.back(), [&] {
      return impl_->cell.write_sensor(state, reading, load, impl_->written);
    });
    bool is_sent = true;  // its identity, and the empty frame of REQ sockets, where there is one
    for (std::size_t k = 0; k + 1 < message.parts.size(); ++k)
      is_sent = is_sent && click::wire::send(impl_->socket.get(), message.parts[k], true);
    if (is_sent) (void)click::wire::send(impl_->socket.get(), reply, false);
  }
}

}  // namespace snug::served_cell
