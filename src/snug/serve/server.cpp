// Server: the viewer's page over HTTP, for recordings and for a run that goes on.
#include "snug/serve/server.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "snug/serve/internal/listener.hpp"

namespace snug::serve {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxWatchers = 8;  // each holds a thread

}  // namespace

struct Server::Impl {
  Impl(const ServerSettings& server_settings, Content server_content);
  void add_routes();
  [[nodiscard]] bool is_for_us(const httplib::Request& request, httplib::Response& response) const;
  void command(const httplib::Request& request, httplib::Response& response) const;
  void serve_events(const httplib::Request& request, httplib::Response& response);
  [[nodiscard]] Json recordings_json() const;

  Content content;
  std::shared_ptr<const std::string> page;
  std::vector<std::shared_ptr<const std::string>> forms;  ///< of the recordings
  internal::Listener listener;
};

Server::Impl::Impl(const ServerSettings& server_settings, Content server_content)
    : content(std::move(server_content)), listener(server_settings) {
  page = std::make_shared<const std::string>(report::assemble_page(content.page, {}));
  for (report::PageRecording& recording : content.recordings) {
    forms.push_back(std::make_shared<const std::string>(std::move(recording.bytes)));
  }
  listener.server.set_payload_max_length(0);
  listener.server.set_default_headers(
      {{"X-Content-Type-Options", "nosniff"},
       {"Cache-Control", "no-store"},
       {"Referrer-Policy", "no-referrer"},
       {"Content-Security-Policy", "default-src 'self' 'unsafe-inline' data: blob:; frame-ancestors 'none'"}});
  add_routes();
  listener.bind(TokenUse::BeyondLoopback);
}

Json Server::Impl::recordings_json() const {
  const bool is_live = content.live != nullptr && !content.live->is_over();
  Json list = Json::array();
  for (const report::PageRecording& recording : content.recordings) list.push_back({{"name", recording.name}});
  if (content.live != nullptr && !is_live && content.live->whole_form()) list.push_back({{"name", "live"}});
  Json answer = {{"recordings", std::move(list)}, {"live", is_live}};
  if (content.has_more_runs) answer["more"] = true;
  return answer;
}

/// Refuses what is sent by mistake or by others. Nothing that is served takes a body.
bool Server::Impl::is_for_us(const httplib::Request& request, httplib::Response& response) const {
  const bool is_empty = request.get_header_value("Content-Length").find_first_not_of('0') == std::string::npos;
  if (request.has_header("Transfer-Encoding") || !is_empty) {
    response.status = 413;  // the body is not read: each connection ends after its answer
    return false;
  }
  if (listener.visitors().refuse(request, response) != 0) return false;
  if (request.method == "GET" || request.method == "HEAD" || request.method == "POST") return true;
  response.status = 405;
  response.set_header("Allow", "GET, HEAD, POST");
  return false;
}

void Server::Impl::add_routes() {
  internal::GuardedServer& server = listener.server;
  using Answer = httplib::Server::HandlerResponse;
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    if (!is_for_us(request, response)) return Answer::Handled;
    if (request.method != "POST") return Answer::Unhandled;
    command(request, response);  // here, as the library would wait for a body of unknown length
    return Answer::Handled;
  });
  if (content.live != nullptr) {
    server.Get("/live", [this](const httplib::Request& request, httplib::Response& response) {
      serve_events(request, response);
    });
  }
  server.Get("/", [this](const httplib::Request&, httplib::Response& response) {
    internal::answer_whole(response, page, "text/html; charset=utf-8");
  });
  server.Get("/recordings.json", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(recordings_json().dump(-1, ' ', false, Json::error_handler_t::replace), "application/json");
  });
  server.Get(R"(/recording/(\d))", [this](const httplib::Request& request, httplib::Response& response) {
    const auto index = static_cast<std::size_t>(request.matches[1].str().front() - '0');
    const std::shared_ptr<const std::string> whole = content.live != nullptr ? content.live->whole_form() : nullptr;
    if (index < forms.size()) {
      internal::answer_whole(response, forms[index], "application/octet-stream");
    } else if (index == 0 && whole) {
      internal::answer_whole(response, whole, "application/octet-stream");
    } else {
      response.status = 404;
    }
  });
}

void Server::Impl::command(const httplib::Request& request, httplib::Response& response) const {
  using Command = std::pair<std::string_view, void (LiveRun::*)()>;
  static constexpr std::array<Command, 3> kCommands = {
      {{"/live/pause", &LiveRun::pause}, {"/live/resume", &LiveRun::resume}, {"/live/step", &LiveRun::step}}};
  const auto found = std::find_if(kCommands.begin(), kCommands.end(),
                                  [&](const Command& known) { return known.first == request.path; });
  if (content.live == nullptr || found == kCommands.end()) {
    response.status = 404;
  } else if (request.get_header_value("X-Snug") != "1") {  // other sites' pages cannot send it unasked
    response.status = 403;
  } else {
    (content.live->*found->second)();
    response.status = 204;
  }
}

void Server::Impl::serve_events(const httplib::Request&, httplib::Response& response) {
  if (!internal::take_place(listener.watchers, kMaxWatchers, response)) return;
  const auto place = std::make_shared<LiveRun::Place>();
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, place](std::size_t, httplib::DataSink& sink) {
        if (listener.is_stopping()) return false;
        const std::shared_ptr<const std::string> text = content.live->next(*place, internal::kHeartbeat);
        const std::string nothing = ":\n\n";  // a comment; fails when the watcher has left
        const std::string& out = text ? *text : nothing;
        return !listener.is_stopping() && sink.write(out.data(), out.size());
      },
      [this](bool) { listener.watchers.fetch_sub(1); });
}

Server::Server(const ServerSettings& settings, Content content)
    : impl_(std::make_unique<Impl>(settings, std::move(content))) {}

Server::~Server() { stop(); }

int Server::port() const { return impl_->listener.port(); }

std::string Server::address() const { return impl_->listener.address(); }

void Server::run() { impl_->listener.run(); }

void Server::stop() { impl_->listener.stop(); }

}  // namespace snug::serve
