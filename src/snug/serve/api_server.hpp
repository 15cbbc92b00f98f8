// ApiServer: a page and an interface to work by over HTTP, for who is on this machine and holds the token.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace snug::serve {

struct ApiRequest {
  std::string method;  ///< GET, POST, PUT or DELETE
  std::string path;    ///< decoded; begins with "/api/"
  std::string body;    ///< of POST and PUT; any bytes
};

struct ApiAnswer {
  int status = 200;
  std::string type = "application/json";
  std::string body;
  std::string policy;      ///< Content-Security-Policy in the place of the page's own; empty: that one
  std::string attachment;  ///< the name under which a browser stores it; empty: it shows it
  /// A stream of server-sent events in the place of the body: the next piece, empty when there is none yet; nothing at
  /// its end. Called from one thread; it should wait for at most half a second.
  std::function<std::optional<std::string>()> next = {};
};

/// Called from several threads at a time.
using Api = std::function<ApiAnswer(const ApiRequest&)>;

/// A file of the page.
struct Asset {
  std::string path;  ///< "/" or "/name"
  std::string type;
  std::string bytes;
};

/// Listens at 127.0.0.1 only. Whoever asks must know the token of the address, or have the cookie that it leaves; what
/// changes anything takes a header that pages of other sites cannot send. The page may load from this address only and
/// may not have scripts or styles within it.
class ApiServer {
 public:
  /// `port` 0: any that is free; `largest_body`: bytes. Throws InputError when the port cannot be had.
  ApiServer(int port, std::size_t largest_body, const std::vector<Asset>& assets, Api api);
  ~ApiServer();
  ApiServer(const ApiServer&) = delete;
  ApiServer& operator=(const ApiServer&) = delete;

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8080/?token=..."
  [[nodiscard]] std::string address() const;
  /// Answers requests until stop() is called.
  void run();
  /// From any thread; open connections are closed.
  void stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace snug::serve
