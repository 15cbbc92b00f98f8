// Server: a UR controller at an address: its five ports, in time.
#include "snug/served_ur/server.hpp"

#include <fmt/format.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/text.hpp"
#include "snug/served_cell/observer_port.hpp"
#include "snug/served_ur/dashboard.hpp"
#include "snug/served_ur/internal/address.hpp"
#include "snug/served_ur/internal/connection.hpp"
#include "snug/ur/primary.hpp"
#include "snug/urscript/program.hpp"

namespace snug::served_ur {
namespace {

using Clock = served_cell::Pacer::Clock;
using internal::Connection;

constexpr std::array kPorts = {Port::Dashboard, Port::Primary, Port::Secondary, Port::RealTime, Port::Rtde};
constexpr Clock::duration kLockstepPatience = std::chrono::milliseconds(1);
constexpr double kStatePeriod = 0.1;        // s, between robot states of the primary and secondary ports
constexpr std::size_t kLongestLine = 4096;  // bytes, of the dashboard

}  // namespace

struct Server::Impl {
  Impl(Controller& to_serve, ServerSettings server_settings);

  void run();
  void step();
  void go_in_time(std::vector<pollfd>& sources);
  void go_in_lockstep(std::vector<pollfd>& sources);
  void wait(std::vector<pollfd>& sources, Clock::duration patience);
  void accept_all(std::size_t listener);
  void greet(Connection& client);
  void read(Connection& client);
  void read_dashboard(Connection& client);
  void read_scripts(Connection& client);
  void read_rtde(Connection& client);
  void show_observers();
  [[nodiscard]] bool has_pace_setter() const;
  void log(const std::string& line) const {
    if (settings.log) settings.log(line);
  }

  Controller& controller;
  ServerSettings settings;
  internal::Guests guests;
  served_cell::Pacer pacer;
  std::array<Descriptor, kPorts.size()> listeners;
  Descriptor stop_fd;
  std::atomic<bool> is_stopping = false;
  std::optional<served_cell::ObserverPort> observers;
  ur::InputOwners owners;  ///< outlives the connections
  std::vector<std::unique_ptr<Connection>> clients;
  int connections = 0;         ///< so far
  bool is_step_asked = false;  ///< by who sets the pace
};

Server::Impl::Impl(Controller& to_serve, ServerSettings server_settings)
    : controller(to_serve),
      settings(std::move(server_settings)),
      guests(settings.clients),
      pacer(Controller::period_of(to_serve.model().model) / settings.speed),
      stop_fd(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  SNUG_CHECK(stop_fd.is_open(), "no descriptor left");
  const in_addr address = internal::parse_address(settings.host, "--ur");
  if (!internal::is_loopback(address) && !guests.has_others()) {
    throw InputError("command line", "--ur", "'" + settings.host + "', which other machines can reach",
                     "127.0.0.1, or --ur-clients with the addresses that may move the robot");
  }
  for (std::size_t i = 0; i < kPorts.size(); ++i) {
    listeners[i] = internal::listen_at(address, static_cast<int>(kPorts[i]) + settings.port_offset, settings.host);
  }
  if (settings.observers) observers.emplace(controller.simulation(), *settings.observers);
}

void Server::Impl::run() {
  std::vector<pollfd> sources;
  while (!is_stopping) {
    if (has_pace_setter())
      go_in_lockstep(sources);
    else
      go_in_time(sources);
    std::erase_if(clients, [](const auto& client) { return !client->is_open(); });
  }
}

void Server::Impl::go_in_time(std::vector<pollfd>& sources) {
  const Clock::time_point now = Clock::now();
  if (!pacer.is_started()) pacer.start(now);
  if (now >= pacer.due()) {
    pacer.step(now);
    step();
  }
  wait(sources, pacer.due() - Clock::now());
}

/// A period for each data package of who sets the pace, when all is heard that anybody had said before it.
void Server::Impl::go_in_lockstep(std::vector<pollfd>& sources) {
  pacer.stop();
  const bool is_asked = is_step_asked;
  wait(sources, is_asked ? Clock::duration::zero() : kLockstepPatience);
  const bool is_set = has_pace_setter();
  if (!is_asked || !is_set) {
    is_step_asked = is_step_asked && is_set;
    return show_observers();
  }
  is_step_asked = false;
  step();
  for (const auto& client : clients)
    if (client->port() == Port::Rtde) read_rtde(*client);  // what came with it
}

bool Server::Impl::has_pace_setter() const {
  return std::ranges::any_of(clients, [](const auto& client) {
    return client->is_open() && client->port() == Port::Rtde && client->rtde->sets_pace();
  });
}

void Server::Impl::show_observers() {
  if (observers) observers->answer(controller.state(), controller.reading(), controller.tool_load());
}

void Server::Impl::step() {
  controller.step();
  show_observers();
  const ur::RobotData& data = controller.data();
  const auto states_each = std::llround(kStatePeriod / Controller::period_of(controller.model().model));
  std::string secondary;
  for (const std::string& message : controller.take_messages()) secondary += message;
  if (controller.period() % states_each == 0) {
    secondary += ur::robot_state(data, controller.robot(), controller.model());
  }
  std::string real_time;
  for (const auto& client : clients) {
    if (client->port() == Port::Rtde) {
      client->send(client->rtde->package(data, controller.period()));
    } else if (client->port() == Port::RealTime) {
      if (real_time.empty()) real_time = ur::real_time_state(data);
      client->send(real_time);
    } else if (client->port() != Port::Dashboard) {
      client->send(secondary);
    }
  }
}

/// At most for `patience`, until somebody says something; then hears all who do.
void Server::Impl::wait(std::vector<pollfd>& sources, Clock::duration patience) {
  sources.assign(1, {stop_fd.get(), POLLIN, 0});
  for (const Descriptor& listener : listeners) sources.push_back({listener.get(), POLLIN, 0});
  for (const auto& client : clients) {
    sources.push_back({client->fd(), static_cast<short>(client->has_unsent() ? POLLIN | POLLOUT : POLLIN), 0});
  }
  const std::int64_t left =
      std::max<std::int64_t>(0, std::chrono::duration_cast<std::chrono::nanoseconds>(patience).count());
  const timespec timeout = {static_cast<std::time_t>(left / 1000000000), static_cast<long>(left % 1000000000)};
  if (::ppoll(sources.data(), sources.size(), &timeout, nullptr) <= 0) return;
  const std::size_t first_client = 1 + listeners.size();
  const std::size_t count = clients.size();
  for (std::size_t i = 0; i < count; ++i) {
    const short events = sources[first_client + i].revents;
    if ((events & POLLOUT) != 0) clients[i]->flush();
    if ((events & (POLLIN | POLLHUP | POLLERR)) != 0) read(*clients[i]);
  }
  for (std::size_t i = 0; i < listeners.size(); ++i) {
    if ((sources[1 + i].revents & POLLIN) != 0) accept_all(i);
  }
}

void Server::Impl::accept_all(std::size_t listener) {
  sockaddr_in peer = {};
  socklen_t size = sizeof peer;
  Descriptor socket(
      ::accept4(listeners[listener].get(), reinterpret_cast<sockaddr*>(&peer), &size, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!socket.is_open()) return;
  const Port port = kPorts[listener];
  const auto here = std::ranges::count_if(clients, [&](const auto& client) { return client->port() == port; });
  if (here >= kMostClients || !guests.is_welcome(peer.sin_addr)) return;
  const int yes = 1;
  (void)::setsockopt(socket.get(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof yes);
  clients.push_back(std::make_unique<Connection>(std::move(socket), port));
  greet(*clients.back());
}

void Server::Impl::greet(Connection& client) {
  ++connections;
  const double time = controller.data().timestamp;
  if (client.port() == Port::Dashboard) {
    client.send(dashboard_greeting() + "\n");
  } else if (client.port() == Port::Rtde) {
    client.rtde = std::make_unique<ur::RtdeSession>(controller.model(), connections, owners);
  } else if (client.port() != Port::RealTime) {
    client.send(ur::version_message(time, controller.model()) +
                ur::robot_state(controller.data(), controller.robot(), controller.model()));
  }
}

void Server::Impl::read(Connection& client) {
  client.receive();
  if (client.port() == Port::Dashboard)
    read_dashboard(client);
  else if (client.port() == Port::Rtde)
    read_rtde(client);
  else
    read_scripts(client);
}

void Server::Impl::read_dashboard(Connection& client) {
  std::string line;
  while (client.is_open() && client.take_line(line)) {
    if (internal::is_strangers(line)) return client.close();
    const DashboardAnswer answer = answer_dashboard(line, controller);
    client.send(answer.line + "\n");
    if (answer.is_last) client.close_after_sending();
    if (answer.is_shutdown) {
      log("a client shut the controller down");
      is_stopping = true;
    }
    if (answer.is_last) return;
  }
  if (client.received().size() > kLongestLine) client.close();
}

void Server::Impl::read_scripts(Connection& client) {
  while (client.is_open()) {
    const std::string_view bytes = client.received();
    const std::size_t end = bytes.find('\n');
    if (end == std::string_view::npos) return;
    const std::string_view line = bytes.substr(0, end);
    if (internal::is_strangers(line)) return client.close();
    if (controller.obey(line) || trim(line).empty()) {
      client.take(end + 1);
      continue;
    }
    const std::size_t size = urscript::find_program_end(bytes);
    if (size == 0) return;
    controller.run_program(bytes.substr(0, size));
    client.take(size);
  }
}

void Server::Impl::read_rtde(Connection& client) {
  while (client.is_open() && !(is_step_asked && client.rtde->sets_pace())) {
    const ur::rtde::NextFrame next = ur::rtde::next_frame(client.received());
    if (next.is_broken) return client.close();
    if (!next.frame) return;
    const ur::RtdeSession::Reply reply = client.rtde->answer(*next.frame, controller.inputs());
    client.send(reply.bytes);
    client.take(next.size);
    is_step_asked = is_step_asked || (reply.sets_inputs && client.rtde->sets_pace());
  }
}

Server::Server(Controller& controller, ServerSettings settings)
    : impl_(std::make_unique<Impl>(controller, std::move(settings))) {}
Server::~Server() = default;

void Server::run() { impl_->run(); }

void Server::stop() noexcept {
  impl_->is_stopping = true;
  (void)::eventfd_write(impl_->stop_fd.get(), 1);
}

const served_cell::Pacer& Server::pacer() const { return impl_->pacer; }
std::string Server::observers() const { return impl_->observers ? impl_->observers->endpoint() : std::string(); }

}  // namespace snug::served_ur
