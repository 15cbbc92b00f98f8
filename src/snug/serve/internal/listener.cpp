// Listener: a guarded server at an address, who may ask it, and how it begins and ends.
#include "snug/serve/internal/listener.hpp"

#include <thread>
#include <utility>

#include "snug/core/input_error.hpp"

namespace snug::serve::internal {

Listener::Listener(ServerSettings settings, const ConnectionLimits& limits)
    : server(limits), settings_(std::move(settings)) {
  server.set_tcp_nodelay(true);
  server.set_socket_options([](socket_t socket) {  // the library's own let two servers share a port
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
}

void Listener::bind(TokenUse token) {
  const bool is_bound = settings_.port == 0 ? (port_ = server.bind_to_any_port(settings_.host)) > 0
                                            : server.bind_to_port(settings_.host, port_ = settings_.port);
  if (!is_bound) {
    throw InputError("command line", "--host, --port", settings_.host + " port " + std::to_string(settings_.port),
                     "an address of this machine and a port that is free");
  }
  visitors_.emplace(server.is_at_loopback(), settings_.names, port_, token);
  server.widen_queue();
}

std::string Listener::address() const {
  const std::string& asked = settings_.host;
  const bool is_any = asked == "0.0.0.0" || asked == "::" || asked == "*";
  const std::string host = is_any ? Visitors::own_address() : asked;
  return "http://" + (host.find(':') == std::string::npos ? host : "[" + host + "]") + ":" + std::to_string(port_) +
         "/" + visitors_->query();
}

void Listener::run() {
  is_in_run_ = true;
  if (!is_stopping_) server.listen_after_bind();
  is_in_run_ = false;
}

void Listener::stop() {
  is_stopping_ = true;
  // The library ignores a stop that comes before its loop runs.
  while (is_in_run_ && !server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  server.stop();
  server.close_connections();
}

void answer_whole(httplib::Response& response, std::shared_ptr<const std::string> bytes, const std::string& type) {
  if (bytes->empty()) {  // nothing to provide: the library would wait for it for ever
    response.set_content("", type);
    return;
  }
  const std::size_t size = bytes->size();
  response.set_content_provider(size, type, [bytes](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
    return sink.write(bytes->data() + offset, length);
  });
}

bool take_place(std::atomic<int>& watchers, int most, httplib::Response& response) {
  if (watchers.fetch_add(1) < most) return true;
  watchers.fetch_sub(1);
  response.status = 503;
  response.set_content("There are too many watchers.\n", "text/plain");
  return false;
}

}  // namespace snug::serve::internal
