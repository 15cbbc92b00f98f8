// Server: a simulator at an address: messages in, answers out, steps in time.
#include "snug/served_cell/server.hpp"

#include <fmt/format.h>

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <zmq.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include "snug/click/authenticator.hpp"
#include "snug/click/socket.hpp"
#include "snug/click/spin_wait.hpp"
#include "snug/core/check.hpp"
#include "snug/core/input_error.hpp"
#include "snug/core/stopwatch.hpp"
#include "snug/served_cell/internal/connections.hpp"

namespace snug::served_cell {
namespace {

namespace wire = click::wire;

using Clock = Pacer::Clock;

// Bytes, beyond which ZeroMQ itself closes the connection: frames up to it get an Error that says why.
constexpr std::int64_t kMostBytes = std::int64_t{80} << 20;
constexpr int kMostWaiting = 2;                             // messages of a peer that nobody has read yet
constexpr int kMostUnread = 256;                            // answers that a peer does not read: then it is gone for us
constexpr auto kTakeOver = std::chrono::milliseconds(200);  // for the news that the controller before has left
// ZeroMQ tells that a connection is closed just before it closes it: then it is looked at again and again.
constexpr auto kLookAgain = std::chrono::milliseconds(2);
constexpr auto kLookFor = std::chrono::seconds(1);
// Then, and without news, seldom: on a machine that stands still the closing takes longer than that.
constexpr auto kLookSeldom = std::chrono::milliseconds(500);
constexpr const char* kMonitor = "inproc://events";

/// ZeroMQ removes a file that is in the way: only a socket that nobody listens at may be.
void check_file(const std::string& endpoint) {
  const std::string path = wire::path_of(endpoint);
  struct stat status = {};
  if (path.empty() || ::lstat(path.c_str(), &status) != 0) return;
  if (!S_ISSOCK(status.st_mode)) {
    throw InputError("command line", "--click", "'" + endpoint + "', where there is a file", "a path that is free");
  }
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return;  // bind will say so
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool is_taken = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(probe);
  if (is_taken) {
    throw InputError("command line", "--click", "'" + endpoint + "', where another program listens",
                     "an address that is free");
  }
}

int fd_of(void* socket) {
  int fd = -1;
  std::size_t size = sizeof fd;
  SNUG_CHECK(zmq_getsockopt(socket, ZMQ_FD, &fd, &size) == 0, "a socket has a descriptor");
  return fd;
}

bool is_readable(void* socket) {
  int events = 0;
  std::size_t size = sizeof events;
  return zmq_getsockopt(socket, ZMQ_EVENTS, &events, &size) == 0 && (events & ZMQ_POLLIN) != 0;
}

/// A message that waits for its turn.
struct Request {
  Simulator::Peer peer;
  std::vector<std::string> envelope;  ///< up to an empty frame: what REQ sockets send before and want back
  std::string frame;
  Clock::time_point received;
};

}  // namespace

struct Server::Impl {
  Impl(Simulator& to_serve, ServerSettings server_settings);
  ~Impl() {
    // ZeroMQ leaves the file of ipc:// behind. It is still ours: nobody else can listen at it before the socket closes.
    if (const std::string file = wire::path_of(endpoint); !file.empty()) ::unlink(file.c_str());
    if (stop_fd >= 0) ::close(stop_fd);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void bind();
  void run();
  void read_monitor();
  [[nodiscard]] bool read_message();
  [[nodiscard]] bool must_wait(const Request& request, Clock::time_point& until);
  void serve(const Request& request);
  void serve_kept();
  void step_in_time();
  void ask_for_steps();
  void lose(const Simulator::Peer& peer, const std::string& why = "the controller left");
  [[nodiscard]] bool is_driven();
  [[nodiscard]] bool is_silent() const;
  void look_for_controller();
  void wait();
  void log(const std::string& line) const {
    if (settings.log) settings.log(line);
  }

  Simulator& simulator;
  ServerSettings settings;
  Pacer pacer;
  ServerTimes times;
  wire::Context context = wire::make_context();
  std::optional<wire::Authenticator> authenticator;  ///< with keys
  wire::Socket socket, monitor;
  std::string endpoint;
  int stop_fd = -1;
  std::atomic<bool> is_stopping = false;
  internal::Connections connections;
  Simulator::Peer controller;          ///< while there is one
  Clock::time_point controller_heard;  ///< when its last message came
  Clock::time_point next_look, look_until;
  std::vector<Request> kept;
  int steps_allowed = 0;  ///< step by step; -1: all
  Clock::time_point next_due = Clock::time_point::max(), last_message;
  wire::SpinWait spin;
};

Server::Impl::Impl(Simulator& to_serve, ServerSettings server_settings)
    : simulator(to_serve),
      settings(std::move(server_settings)),
      pacer(to_serve.handshake().time_step / settings.speed.value_or(1.0)) {
  wire::check_endpoint(settings.endpoint);
  if (!settings.keys && !wire::is_local(settings.endpoint)) {
    throw InputError("command line", "--click", "'" + settings.endpoint + "', which other machines can reach",
                     "an address such as tcp://127.0.0.1:5555, or --keys DIR (`snug keys DIR` makes them)");
  }
  check_file(settings.endpoint);
  stop_fd = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  SNUG_CHECK(stop_fd >= 0, "no descriptor left");
  bind();
}

void Server::Impl::bind() {
  socket = wire::make_socket(context.get(), ZMQ_ROUTER, 200);
  wire::set(socket.get(), ZMQ_ROUTER_MANDATORY, 1);
  wire::set(socket.get(), ZMQ_MAXMSGSIZE, kMostBytes);
  wire::set(socket.get(), ZMQ_RCVHWM, kMostWaiting);
  wire::set(socket.get(), ZMQ_SNDHWM, kMostUnread);
  wire::set(socket.get(), ZMQ_IPV6, settings.endpoint.starts_with("tcp://[") ? 1 : 0);
  wire::set(socket.get(), ZMQ_TCP_KEEPALIVE, 1);
  wire::refuse_old_peers(socket.get());
  if (settings.keys) {
    authenticator.emplace(context.get(), settings.keys->allowed);
    wire::set(socket.get(), ZMQ_CURVE_SERVER, 1);
    wire::set(socket.get(), ZMQ_CURVE_SECRETKEY, settings.keys->own.secret_key);
  }
  SNUG_CHECK(zmq_socket_monitor(socket.get(), kMonitor, ZMQ_EVENT_DISCONNECTED) == 0, "a socket can be watched");
  monitor = wire::make_socket(context.get(), ZMQ_PAIR);
  SNUG_CHECK(zmq_connect(monitor.get(), kMonitor) == 0, "a monitor can be read");
  std::string address = settings.endpoint;
  constexpr std::string_view kHere = "tcp://localhost:";  // a name that ZeroMQ binds to nothing
  if (address.starts_with(kHere)) address.replace(0, kHere.size(), "tcp://127.0.0.1:");
  if (zmq_bind(socket.get(), address.c_str()) != 0) {
    throw InputError("command line", "--click", "'" + settings.endpoint + "': " + zmq_strerror(errno),
                     "an address of this machine that is free");
  }
  std::array<char, 512> bound{};
  std::size_t size = bound.size();
  SNUG_CHECK(zmq_getsockopt(socket.get(), ZMQ_LAST_ENDPOINT, bound.data(), &size) == 0,
             "a bound socket has an address");
  endpoint = bound.data();
}

/// News that a connection was closed: which one, the kernel knows better.
void Server::Impl::read_monitor() {
  wire::Parts event;
  bool is_told = false;
  while (wire::receive(monitor.get(), event)) is_told = true;
  if (!is_told) return;
  connections.forget_closed();
  next_look = Clock::now();
  look_until = next_look + kLookFor;
}

void Server::Impl::lose(const Simulator::Peer& peer, const std::string& why) {
  std::erase_if(kept, [&](const Request& request) { return request.peer == peer; });
  if (!simulator.leave(peer, why)) return;
  log(why);
  if (settings.controller_left) settings.controller_left();
}

/// Has the controller nothing to say any more? One that waits for its step has said something.
bool Server::Impl::is_silent() const {
  if (Clock::now() < controller_heard + std::chrono::duration<double>(settings.lease)) return false;
  return std::ranges::none_of(kept, [this](const Request& request) { return request.peer == controller; });
}

/// By a controller that is still there; one that is not is lost.
bool Server::Impl::is_driven() {
  if (simulator.has_controller() && !connections.is_there(controller)) lose(controller);
  return simulator.has_controller();
}

void Server::Impl::look_for_controller() {
  const Clock::time_point now = Clock::now();
  if (now >= next_look) {
    next_look = now + (now < look_until ? Clock::duration(kLookAgain) : Clock::duration(kLookSeldom));
    (void)is_driven();
  }
  if (simulator.has_controller()) next_due = std::min(next_due, next_look);
}

bool Server::Impl::read_message() {
  read_monitor();
  wire::Parts message;
  if (!wire::receive(socket.get(), message)) return false;
  if (message.parts.size() < 2) return true;  // a peer that says nothing
  if (simulator.is_controller(message.parts.front())) controller_heard = Clock::now();
  Request request;
  request.received = last_message = Clock::now();
  request.peer = std::move(message.parts.front());
  const auto sender = connections.see(request.peer, message.fd);
  if (sender != internal::Connections::Sender::Known) lose(request.peer);
  if (sender == internal::Connections::Sender::Gone) return true;
  const auto first = message.parts.begin() + 1;
  const auto delimiter = std::find(first, message.parts.end(), std::string());
  // A lone empty frame is a message of a DEALER socket, not a delimiter.
  const bool has_envelope = delimiter != message.parts.end() && delimiter + 1 != message.parts.end();
  const auto payload = has_envelope ? delimiter + 1 : first;
  request.envelope.assign(first, payload);
  // Several frames are no message: the reader says so.
  request.frame = payload + 1 == message.parts.end() ? std::move(*payload) : "\xff";
  Clock::time_point until;
  if (must_wait(request, until))
    kept.push_back(std::move(request));
  else
    serve(request);
  return true;
}

/// Until when, as far as that is known.
bool Server::Impl::must_wait(const Request& request, Clock::time_point& until) {
  until = Clock::time_point::max();
  const Clock::time_point now = Clock::now();
  const bool would_control = !simulator.is_controller(request.peer) && !Simulator::is_watcher(request.peer);
  const bool is_control = would_control && Simulator::is_control(request.frame);
  if ((is_control || (would_control && Simulator::is_handshake(request.frame))) && is_driven()) {
    if (is_control && is_silent()) {
      lose(controller, "the controller was silent, and another one took its place");
    } else if (now < request.received + kTakeOver && (!is_control || simulator.has_commanded())) {
      until = request.received + kTakeOver;
      return true;
    }
  }
  if (settings.is_async || (!settings.speed && !settings.step_by_step)) return false;
  if (!simulator.is_step(request.peer, request.frame)) return false;
  if (settings.step_by_step && steps_allowed == 0) return true;
  if (!settings.speed) return false;
  if (!pacer.is_started()) pacer.start(now);
  until = pacer.due();
  return now < until;
}

void Server::Impl::serve(const Request& request) {
  const std::int64_t steps = simulator.counts().steps;
  const bool had_controller = simulator.has_controller(), had_place = simulator.is_controller(request.peer);
  const double stepped = simulator.step_seconds();
  const Clock::time_point start = Clock::now();
  const std::optional<std::string> reply = simulator.answer(request.peer, request.frame);
  bool is_sent = true;
  if (reply) {
    if (!had_controller) (void)is_readable(socket.get());  // makes ZeroMQ see who has left: then sending fails
    is_sent = wire::send(socket.get(), request.peer, true);
    for (const std::string& part : request.envelope) is_sent = is_sent && wire::send(socket.get(), part, true);
    is_sent = is_sent && wire::send(socket.get(), *reply, false);
  }
  const double service = seconds_since(start);
  times.service.add(service);
  times.own.add(std::max(0.0, service - (simulator.step_seconds() - stepped)));
  if (simulator.counts().steps > steps) {
    if (settings.speed && pacer.is_started()) pacer.step(start);
    if (steps_allowed > 0) --steps_allowed;
  }
  if (!had_place && simulator.is_controller(request.peer)) {
    controller = request.peer;
    controller_heard = request.received;
    log("a controller is there");
  }
  if (had_controller && !simulator.has_controller()) {
    log("the controller ended the session");
    if (settings.controller_left) settings.controller_left();
  }
  if (!is_sent) lose(request.peer);  // it is gone, or does not read what it asked for
}

void Server::Impl::serve_kept() {
  next_due = Clock::time_point::max();
  std::vector<Request> waiting;
  waiting.swap(kept);
  for (Request& request : waiting) {
    if (!connections.is_there(request.peer)) continue;
    Clock::time_point until;
    if (must_wait(request, until)) {
      next_due = std::min(next_due, until);
      kept.push_back(std::move(request));
    } else {
      serve(request);
    }
  }
}

/// Free running: one step when it is due.
void Server::Impl::step_in_time() {
  if (!settings.is_async) return;
  const bool may_step = !settings.step_by_step || steps_allowed != 0;
  if (!simulator.is_running() || !may_step) return pacer.stop();
  const Clock::time_point now = Clock::now();
  if (!pacer.is_started()) pacer.start(now);
  if (now >= pacer.due()) {
    pacer.step(now);
    simulator.step();
    if (steps_allowed > 0) --steps_allowed;
  }
  next_due = std::min(next_due, pacer.due());
}

void Server::Impl::ask_for_steps() {
  const int more = settings.read_steps();
  if (more == kReset) {
    simulator.reset("by the user");
    log("reset");
  } else if (more < 0) {
    steps_allowed = -1;
  } else if (steps_allowed >= 0) {
    steps_allowed += more;
  }
}

void Server::Impl::wait() {
  void* const door = authenticator ? authenticator->socket() : monitor.get();
  const auto is_asked = [&] {
    return is_stopping || is_readable(socket.get()) || is_readable(monitor.get()) ||
           (authenticator && is_readable(door));
  };
  if (spin.wait(is_asked, last_message, next_due)) return;
  const bool asks = settings.step_by_step && settings.steps_fd >= 0 && steps_allowed >= 0;
  std::array<pollfd, 5> sources = {pollfd{stop_fd, POLLIN, 0}, pollfd{fd_of(socket.get()), POLLIN, 0},
                                   pollfd{fd_of(monitor.get()), POLLIN, 0},
                                   pollfd{asks ? settings.steps_fd : -1, POLLIN, 0}, pollfd{fd_of(door), POLLIN, 0}};
  timespec timeout = {};
  const timespec* patience = nullptr;
  if (next_due != Clock::time_point::max()) {
    const auto left = std::chrono::duration_cast<std::chrono::nanoseconds>(next_due - Clock::now()).count();
    if (left <= 0) return;
    timeout = {static_cast<std::time_t>(left / 1000000000), static_cast<long>(left % 1000000000)};
    patience = &timeout;
  }
  (void)::ppoll(sources.data(), sources.size(), patience, nullptr);
  if (asks && (sources[3].revents & (POLLIN | POLLHUP)) != 0) ask_for_steps();
}

void Server::Impl::run() {
  ::prctl(PR_SET_TIMERSLACK, 1UL);  // ns: waits end when they are over
  while (!is_stopping) {
    serve_kept();
    step_in_time();
    look_for_controller();
    if (authenticator) authenticator->answer();
    if (settings.stop_after && simulator.time() >= *settings.stop_after) {
      simulator.end(fmt::format("{} s are over", *settings.stop_after));
      break;
    }
    if (!read_message()) wait();
  }
}

Server::Server(Simulator& simulator, ServerSettings settings)
    : impl_(std::make_unique<Impl>(simulator, std::move(settings))) {}
Server::~Server() = default;
const std::string& Server::endpoint() const { return impl_->endpoint; }
void Server::run() { impl_->run(); }
const ServerTimes& Server::times() const { return impl_->times; }
const Pacer& Server::pacer() const { return impl_->pacer; }

void Server::stop() noexcept {
  impl_->is_stopping = true;
  const std::uint64_t one = 1;
  (void)!::write(impl_->stop_fd, &one, sizeof one);
}

}  // namespace snug::served_cell
