// ApiServer: a page and an interface to work by over HTTP, for who is on this machine and holds the token.
#include "snug/serve/api_server.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include "snug/serve/internal/listener.hpp"

namespace snug::serve {
namespace {

constexpr int kMostWatchers = 16;                             // each holds a thread
constexpr std::size_t kHeaderBytes = std::size_t{64} << 10U;  // of a request, beside its body
constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

internal::ConnectionLimits limits_for(std::size_t largest_body) {
  internal::ConnectionLimits limits;
  limits.request_bytes = largest_body + kHeaderBytes;
  return limits;
}

/// Bytes of the body by the header; nothing when the header is no plain number, or stands there twice.
std::optional<std::size_t> body_size(const httplib::Request& request) {
  constexpr std::size_t kMostDigits = 12;
  const std::size_t count = request.get_header_value_count("Content-Length");
  if (count == 0) return 0;
  const std::string text = request.get_header_value("Content-Length");
  const bool is_number = !text.empty() && text.size() <= kMostDigits &&
                         std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  if (count > 1 || !is_number) return std::nullopt;
  return static_cast<std::size_t>(std::stoull(text));
}

}  // namespace

struct ApiServer::Impl {
  Impl(int port, std::size_t largest_body_bytes, const std::vector<Asset>& assets, Api api_function);
  void add_routes(const std::vector<Asset>& assets);
  [[nodiscard]] bool is_for_us(const httplib::Request& request, httplib::Response& response) const;
  void serve(const httplib::Request& request, httplib::Response& response);
  void serve_stream(ApiAnswer&& answer, httplib::Response& response);

  std::size_t largest_body;
  Api api;
  internal::Listener listener;
};

ApiServer::Impl::Impl(int port, std::size_t largest_body_bytes, const std::vector<Asset>& assets, Api api_function)
    : largest_body(largest_body_bytes),
      api(std::move(api_function)),
      listener({"127.0.0.1", port, {}}, limits_for(largest_body_bytes)) {
  listener.server.set_payload_max_length(largest_body);
  listener.server.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                                       {"X-Frame-Options", "DENY"},
                                       {"Cache-Control", "no-store"},
                                       {"Cross-Origin-Resource-Policy", "same-origin"},
                                       {"Referrer-Policy", "no-referrer"}});
  add_routes(assets);
  listener.bind(TokenUse::Always);
}

/// Refuses what is sent by mistake or by others, before anything of a body is read.
bool ApiServer::Impl::is_for_us(const httplib::Request& request, httplib::Response& response) const {
  const auto refuse = [&](int status) {
    response.status = status;
    return false;
  };
  const std::optional<std::size_t> size = body_size(request);
  if (!size || request.has_header("Transfer-Encoding")) return refuse(400);
  if (*size > largest_body) return refuse(413);
  if (listener.visitors().refuse(request, response) != 0) return false;
  const bool is_read = request.method == "GET" || request.method == "HEAD";
  const bool takes_body = request.method == "POST" || request.method == "PUT";
  if (!is_read && !takes_body && request.method != "DELETE") return refuse(405);
  if (*size > 0 && !takes_body) return refuse(400);
  if (is_read) return true;
  if (request.get_header_value("X-Snug") != "1") return refuse(403);  // other sites' pages cannot send it unasked
  // Forms would be taken apart by the library before anyone asked for that.
  const std::string type = request.get_header_value("Content-Type");
  const bool is_plain = type.starts_with("text/plain") || type.starts_with("application/json");
  return *size == 0 || is_plain || refuse(415);
}

void ApiServer::Impl::add_routes(const std::vector<Asset>& assets) {
  using Answer = httplib::Server::HandlerResponse;
  listener.server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    response.set_header("Content-Security-Policy", kPolicy);
    if (!is_for_us(request, response)) return Answer::Handled;
    if (request.method == "GET" || request.method == "HEAD") return Answer::Unhandled;
    if (body_size(request).value_or(0) > 0) return Answer::Unhandled;
    serve(request, response);  // here, as the library would wait for a body of unknown length
    return Answer::Handled;
  });
  for (const Asset& asset : assets) {
    const auto bytes = std::make_shared<const std::string>(asset.bytes);
    listener.server.Get(asset.path, [bytes, type = asset.type](const httplib::Request&, httplib::Response& response) {
      internal::answer_whole(response, bytes, type);
    });
  }
  const auto handler = [this](const httplib::Request& request, httplib::Response& response) {
    serve(request, response);
  };
  listener.server.Get(R"(/api/.*)", handler);
  listener.server.Post(R"(/api/.*)", handler);
  listener.server.Put(R"(/api/.*)", handler);
}

void ApiServer::Impl::serve(const httplib::Request& request, httplib::Response& response) {
  if (!request.path.starts_with("/api/")) {
    response.status = 404;
    return;
  }
  ApiAnswer answer = api({request.method == "HEAD" ? "GET" : request.method, request.path, request.body});
  response.status = answer.status;
  if (!answer.policy.empty()) {
    response.headers.erase("Content-Security-Policy");
    response.set_header("Content-Security-Policy", answer.policy);
  }
  if (!answer.attachment.empty())
    response.set_header("Content-Disposition", "attachment; filename=\"" + answer.attachment + "\"");
  if (answer.next) {
    serve_stream(std::move(answer), response);
  } else {
    internal::answer_whole(response, std::make_shared<const std::string>(std::move(answer.body)), answer.type);
  }
}

void ApiServer::Impl::serve_stream(ApiAnswer&& answer, httplib::Response& response) {
  if (!internal::take_place(listener.watchers, kMostWatchers, response)) return;
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, next = std::move(answer.next)](std::size_t, httplib::DataSink& sink) {
        if (listener.is_stopping()) return false;
        const std::optional<std::string> piece = next();
        if (!piece) {
          sink.done();
          return true;
        }
        const std::string out = piece->empty() ? ":\n\n" : *piece;  // a comment; fails when the watcher has left
        return !listener.is_stopping() && sink.write(out.data(), out.size());
      },
      [this](bool) { listener.watchers.fetch_sub(1); });
}

ApiServer::ApiServer(int port, std::size_t largest_body, const std::vector<Asset>& assets, Api api)
    : impl_(std::make_unique<Impl>(port, largest_body, assets, std::move(api))) {}

ApiServer::~ApiServer() { stop(); }

int ApiServer::port() const { return impl_->listener.port(); }

std::string ApiServer::address() const { return impl_->listener.address(); }

void ApiServer::run() { impl_->listener.run(); }

void ApiServer::stop() { impl_->listener.stop(); }

}  // namespace snug::serve
