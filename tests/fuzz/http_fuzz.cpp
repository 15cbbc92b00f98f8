// Requests to the server of a live run, as a connection sends them: at most one is answered, and none steers the run
// without the header that other sites cannot send.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <thread>

#include "fuzz.hpp"
#include "snug/serve/server.hpp"

namespace {

using namespace snug;

/// A run that waits, and its server; ended by the end of the process.
struct Running {
  serve::LiveRun live{"fuzz", 0.0};
  serve::Server server{{}, {"<html><!--snug:recordings--></html>", {}, &live}};
  std::thread thread{[this] { server.run(); }};
  ~Running() {
    live.finish("", "");
    server.stop();
    thread.join();
  }
};

struct Answer {
  std::string text;
  bool is_late = false;  ///< the server has not ended it yet: what was asked may still be done after this
};

Answer ask(int port, std::string_view request) {
  const int client = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Answer answer;
  const timeval patience{0, 300'000};  // a stream of events does not end
  ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  if (::connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    (void)!::send(client, request.data(), request.size(), MSG_NOSIGNAL);
    ::shutdown(client, SHUT_WR);
    char buffer[4096];
    ssize_t got = 0;
    while ((got = ::recv(client, buffer, sizeof buffer, 0)) > 0)
      answer.text.append(buffer, static_cast<std::size_t>(got));
    answer.is_late = got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
  }
  ::close(client);
  return answer;
}

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Running running;
  const std::string_view request = fuzz::text_of(data, std::min<std::size_t>(size, 4096));
  static bool may_pause_late = false;  // a command with the header was left before it was answered
  const Answer answer = ask(running.server.port(), request);
  const std::size_t answers = count_of(answer.text, "HTTP/1.1 ") - count_of(answer.text, "HTTP/1.1 100 ");
  SNUG_CHECK(answers <= 1, "one answer to a connection");
  std::string head(request.substr(0, request.find("\r\n\r\n")));
  std::transform(head.begin(), head.end(), head.begin(), [](unsigned char c) { return std::tolower(c); });
  const bool has_header = head.find("\nx-snug") != std::string::npos;
  may_pause_late = may_pause_late || (has_header && answer.is_late && head.starts_with("post "));
  if (running.live.is_paused()) {
    SNUG_CHECK(has_header || may_pause_late, "a run is paused by its own page only");
    running.live.resume();
    may_pause_late = may_pause_late && has_header;
  }
  return 0;
}
