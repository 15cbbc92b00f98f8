// Server: the viewer's page over HTTP, for recordings and for a run that goes on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "snug/report/recordings_page.hpp"
#include "snug/serve/live_run.hpp"

namespace snug::serve {

struct ServerSettings {
  std::string host = "127.0.0.1";  ///< address to listen at; others than loopback let in who knows the address's token
  int port = 0;                    ///< 0: any that is free
  /// By which browsers may ask for it, besides those of this machine: behind a proxy, in a container.
  std::vector<std::string> names = {};
};

/// Who has to know a token: it stands in the address that is printed.
enum class TokenUse { BeyondLoopback, Always };

/// What is shown: recordings, or a run that goes on.
struct Content {
  std::string page;                               ///< that viewer/ builds, without recordings
  std::vector<report::PageRecording> recordings;  ///< none with `live`
  LiveRun* live = nullptr;                        ///< not owned; must outlive the server
  bool has_more_runs = false;                     ///< `live` shows one after the other
};

/// Serves a fixed set of addresses (docs/formats.md, "Over HTTP") from memory. There is no way from a request to a
/// file.
class Server {
 public:
  /// Starts to listen. Throws InputError when the address cannot be had.
  Server(const ServerSettings& settings, Content content);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  [[nodiscard]] int port() const;
  /// "http://127.0.0.1:8080/"; where other machines can reach it "http://192.0.2.7:8080/?token=..."
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
